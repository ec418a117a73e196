//! Sources of pose, heading and velocities.

use super::checks::{COMPUTED, COMPUTED_DESPITE_NAME, Follows, follows};
use super::choose::{Origin, source};
use super::clock::{Times, settle};
use super::collect::{Collected, OdometrySample, Stream};
use super::columns::ColumnBuilder;
use super::error::ImportError;
use super::fixes::Fixes;
use super::message::{MessageKind, has_twist};
use super::options::{HeadingChoice, ImportOptions, PoseChoice};
use super::track::{Track, wheels};

/// The sources.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plan {
    pub pose: Option<PoseChoice>,
    pub heading: HeadingChoice,
    /// Whether velocities are taken from odometry.
    pub velocities: bool,
}

/// An odometry with the source of its pose and the reason for that judgement.
struct Odometry<'a> {
    topic: &'a str,
    has_twist: bool,
    origin: Origin,
    reason: String,
}

/// Judges an odometry by its name and by the relation of its speed to the wheels. Only the clocks of these two count here,
/// because the use of other topics is not decided yet.
fn judge<'a>(
    all: &Collected,
    odometry: &'a Stream<OdometrySample>,
    options: &ImportOptions,
    notes: &mut Vec<String>,
) -> Result<Odometry<'a>, ImportError> {
    let times = [Times::of(&all.joints), Times::of(odometry)];
    let (clock, _) = settle(options.clock, &times);
    // Their notes are made when they are used.
    let mut unused = ColumnBuilder::default();
    let joints = Track::of_joints(all.joints.clone(), clock, &mut unused.notes);
    let [left, right] = wheels(&joints, &all.wheels, options.invert, &mut unused)?;
    let speeds = odometry.map(|sample| sample.velocity[0]);
    let v_x = Track::of(speeds, clock, &mut unused.notes);
    let by_name = source(&odometry.topic);
    let computed = match by_name {
        Origin::Independent => COMPUTED_DESPITE_NAME,
        Origin::Unknown | Origin::Wheels => COMPUTED,
    };
    let found = follows(&left, &right, &v_x.samples, computed);
    if found == Follows::Opposite {
        notes.push(format!(
            "the wheels turn backwards where {} goes forwards: import with --invert both",
            v_x.topic
        ));
    }
    let (origin, reason) = match found {
        Follows::Exactly(radius) => (
            Origin::Wheels,
            format!(
                "whose v_x is {radius:.4} m times the mean wheel speed throughout, as computed from it"
            ),
        ),
        Follows::Opposite | Follows::Loosely => (by_name, "by its name".into()),
    };
    Ok(Odometry {
        topic: &odometry.topic.name,
        has_twist: has_twist(&odometry.topic.message_type),
        origin,
        reason,
    })
}

impl Plan {
    /// Chooses the sources and notes the reasons.
    ///
    /// # Errors
    /// No wheel speed, or a requested pose that is not available.
    pub fn of(
        all: &Collected,
        options: &ImportOptions,
        notes: &mut Vec<String>,
    ) -> Result<Self, ImportError> {
        let odometry = all.odometry.as_ref();
        let odometry = odometry.map(|odometry| judge(all, odometry, options, notes));
        let odometry = odometry.transpose()?;
        let fixes = all.fix.as_ref().and_then(|fix| Fixes::of(fix, notes));
        let sources = Sources { odometry, fixes };
        let pose = sources.pose(options.pose, notes)?;
        Ok(Self {
            pose,
            velocities: sources.velocities(pose, notes),
            heading: options.heading.unwrap_or(match pose {
                Some(PoseChoice::Odometry) => HeadingChoice::Odometry,
                _ => HeadingChoice::Without,
            }),
        })
    }

    /// Whether odometry is used.
    pub fn has_odometry(&self) -> bool {
        self.velocities
            || self.pose == Some(PoseChoice::Odometry)
            || self.heading == HeadingChoice::Odometry
    }
}

/// The available sources of a pose.
struct Sources<'a> {
    odometry: Option<Odometry<'a>>,
    fixes: Option<Fixes<'a>>,
}

impl Sources<'_> {
    /// The source of the pose: odometry, unless it is wheel odometry, or of unknown source while fixes are precise.
    fn pose(
        &self,
        requested: Option<PoseChoice>,
        notes: &mut Vec<String>,
    ) -> Result<Option<PoseChoice>, ImportError> {
        let missing = |option: &str, kind: MessageKind| ImportError::Missing {
            reason: format!(
                "{option} needs valid messages of {}",
                kind.message_types().join(" or ")
            ),
            remedy: "ugv import FILE --list shows what the file has".into(),
        };
        let pose = match (requested, &self.odometry, &self.fixes) {
            (Some(PoseChoice::Odometry), None, _) => {
                return Err(missing("--pose odometry", MessageKind::Odometry));
            }
            (Some(PoseChoice::Fix), _, None) => {
                return Err(missing("--pose fix", MessageKind::Fix));
            }
            (Some(requested), ..) => Some(requested),
            (None, None, None) => {
                notes.push("no pose: there is neither odometry nor a valid fix".into());
                None
            }
            (None, None, Some(_)) => Some(PoseChoice::Fix),
            (None, Some(_), None) => Some(PoseChoice::Odometry),
            (None, Some(odometry), Some(fixes)) => {
                let (pose, note) = better(odometry, fixes);
                notes.push(note);
                Some(pose)
            }
        };
        if let (Some(PoseChoice::Odometry), Some(odometry)) = (pose, &self.odometry) {
            let (topic, reason) = (odometry.topic, &odometry.reason);
            match odometry.origin {
                Origin::Wheels => notes.push(format!(
                    "warning: {topic} is wheel odometry {reason}: its pose and velocities follow from \
                     the wheel speeds and are no ground truth for slip"
                )),
                Origin::Unknown => notes.push(format!(
                    "warning: the name of {topic} does not show the source of its pose; if it is wheel \
                     odometry, it is no ground truth for slip"
                )),
                Origin::Independent => {}
            }
        }
        Ok(pose)
    }

    /// Whether the velocities of odometry are used.
    fn velocities(&self, pose: Option<PoseChoice>, notes: &mut Vec<String>) -> bool {
        let Some(Odometry {
            topic,
            origin,
            has_twist: true,
            ..
        }) = &self.odometry
        else {
            return false;
        };
        if pose == Some(PoseChoice::Odometry) {
            return true;
        }
        let precise = self.fixes.as_ref().is_some_and(|fixes| fixes.precise);
        match origin {
            Origin::Wheels => {
                notes.push(format!(
                    "velocities of {topic} left out: they follow from the wheel speeds"
                ));
                false
            }
            Origin::Unknown if precise => {
                notes.push(format!(
                    "velocities of {topic} left out: its name does not show their source, and the pose is \
                     better"
                ));
                false
            }
            Origin::Unknown => {
                notes.push(format!(
                    "warning: the name of {topic} does not show the source of its velocities; if it is \
                     wheel odometry, they are no ground truth for slip"
                ));
                true
            }
            Origin::Independent => true,
        }
    }
}

/// The better pose of two, and why.
fn better(
    Odometry {
        topic,
        origin,
        reason,
        ..
    }: &Odometry,
    fixes: &Fixes,
) -> (PoseChoice, String) {
    let fix = fixes.topic;
    match origin {
        Origin::Wheels => (
            PoseChoice::Fix,
            format!(
                "pose from {fix}, not from {topic}, wheel odometry {reason} (--pose odometry takes it)"
            ),
        ),
        Origin::Unknown if fixes.precise => (
            PoseChoice::Fix,
            format!(
                "warning: pose from {fix}, with a stated deviation of less than 0.1 m, not from {topic}, \
                 whose name does not show the source of its pose (--pose odometry takes it)"
            ),
        ),
        Origin::Unknown => (
            PoseChoice::Odometry,
            format!("warning: pose from {topic} (--pose fix takes it from {fix})"),
        ),
        Origin::Independent => (
            PoseChoice::Odometry,
            format!("pose from {topic} (--pose fix takes it from {fix})"),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::Clock;
    use crate::import::attitude::Yaw;
    use crate::import::collect::{FixSample, JointSample, StampedSample, WheelSample};
    use crate::import::container::Connection;
    use crate::import::convert::convert;
    use crate::import::message::Load;
    use crate::import::side::WheelJoints;
    use crate::import::survey::Topic;

    const STEP: i64 = 100_000_000;

    /// Twenty seconds of a topic, logged as measured.
    fn stream<T>(kind: MessageKind, name: &str, value: impl Fn(f64) -> T) -> Stream<T> {
        let channel = Connection {
            topic: name.into(),
            message_type: kind.message_types()[0].into(),
            encoding: "cdr".into(),
        };
        let sample = |k: i64| StampedSample {
            stamp: k * STEP,
            logged: k * STEP,
            value: value(k as f64 * 0.1),
        };
        Stream {
            topic: Topic::new(&channel, 0),
            joined: Vec::new(),
            child_frame: String::new(),
            samples: (1..200).map(sample).collect(),
        }
    }

    fn wheel_speed(time: f64) -> f64 {
        4.0 + time.sin()
    }

    /// Odometry whose speed is that of the wheels plus a varying share, and fixes of this deviation.
    fn collected(odometry: &str, slip: f64, deviation: Option<f64>) -> Collected {
        let joints = |time| -> WheelSample {
            let joint = JointSample {
                position: f64::NAN,
                velocity: wheel_speed(time),
                load: f64::NAN,
            };
            Box::new([joint; 2])
        };
        let speed = |time: f64| 0.15 * (wheel_speed(time) + slip * (0.7 * time).cos());
        Collected {
            joints: stream(MessageKind::Joints, "/joints", joints),
            wheels: WheelJoints {
                left: vec!["l".into()],
                right: vec!["r".into()],
            },
            odometry: Some(stream(MessageKind::Odometry, odometry, |time| {
                OdometrySample {
                    position: [time, 0.0],
                    yaw: Yaw::Of(0.0),
                    velocity: [speed(time), 0.01],
                    yaw_rate: 0.01,
                }
            })),
            imu: None,
            fix: Some(stream(MessageKind::Fix, "/fix", |_| FixSample {
                status: 0,
                place: [48.0, 11.0, 500.0],
                deviation,
            })),
            twist: None,
            load: Load::Effort,
            steps: Vec::new(),
        }
    }

    fn plan(all: &Collected, options: &ImportOptions) -> (Plan, Vec<String>) {
        let mut notes = Vec::new();
        let plan = Plan::of(all, options, &mut notes).unwrap();
        (plan, notes)
    }

    #[test]
    fn precise_fixes_come_before_odometry_of_unknown_origin() {
        let any = ImportOptions::default();
        for (name, deviation, pose, velocities, warnings) in [
            ("/odom", Some(0.02), PoseChoice::Fix, false, 1),
            ("/odom", Some(1.5), PoseChoice::Odometry, true, 2),
            ("/odom", None, PoseChoice::Odometry, true, 2),
            ("/ins/odom", Some(0.02), PoseChoice::Odometry, true, 0),
            ("/wheel/odom", Some(1.5), PoseChoice::Fix, false, 0),
        ] {
            let (plan, notes) = plan(&collected(name, 0.5, deviation), &any);
            assert_eq!(
                (plan.pose, plan.velocities),
                (Some(pose), velocities),
                "{name}: {notes:?}"
            );
            let warned = notes.iter().filter(|note| note.starts_with("warning: "));
            assert_eq!(warned.count(), warnings, "{name}: {notes:?}");
        }
        // A request goes first, and doubts about it are noted.
        let requested = ImportOptions {
            pose: Some(PoseChoice::Fix),
            ..ImportOptions::default()
        };
        let (plan, notes) = plan(&collected("/odom", 0.5, Some(1.5)), &requested);
        assert_eq!((plan.pose, plan.velocities), (Some(PoseChoice::Fix), true));
        assert!(
            notes[0].starts_with("warning: the name of /odom"),
            "{notes:?}"
        );
    }

    #[test]
    fn a_name_of_an_independent_pose_requires_better_evidence_against_it() {
        let any = ImportOptions::default();
        for (name, slip, pose) in [
            ("/odom", 0.0, PoseChoice::Fix),
            ("/odom", 0.002, PoseChoice::Fix),
            ("/ins/odom", 0.0, PoseChoice::Fix),
            ("/ins/odom", 0.002, PoseChoice::Odometry),
        ] {
            let (plan, notes) = plan(&collected(name, slip, Some(1.5)), &any);
            assert_eq!(plan.pose, Some(pose), "{name} {slip}: {notes:?}");
        }
    }

    #[test]
    fn unused_topics_do_not_affect_the_clock() {
        let without_stamps = |name: &str| {
            let mut all = collected(name, 0.5, Some(1.5));
            for sample in &mut all.fix.as_mut().unwrap().samples {
                sample.stamp = 0;
            }
            convert(all, &ImportOptions::default()).unwrap()
        };
        let converted = without_stamps("/ins/odom");
        assert_eq!(converted.clock, Clock::Header, "{:?}", converted.notes);
        // The times of fixes count if they are used.
        let converted = without_stamps("/wheel/odom");
        assert_eq!(converted.clock, Clock::Log, "{:?}", converted.notes);
        let names: Vec<&str> = converted.columns.iter().map(|column| column.name).collect();
        assert_eq!(names, ["omega_left", "omega_right", "x", "y"]);
    }
}

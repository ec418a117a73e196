//! Which topics serve, and as what.

use super::ImportError;
use super::checks::{COMPUTED, COMPUTED_DESPITE_NAME, Follows, follows};
use super::choose::{Origin, origin};
use super::clock::{Times, settle};
use super::collect::{Collected, OdometrySample, Sample, Stream};
use super::columns::Columns;
use super::fixes::Fixes;
use super::message::MessageKind;
use super::options::{Heading, Options, Pose};
use super::track::{Track, wheels};

/// What serves as what.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plan {
    pub pose: Option<Pose>,
    pub heading: Heading,
    /// Whether the velocities are from odometry.
    pub velocities: bool,
}

/// What is known of an odometry's origin, with the reason in words.
struct Verdict {
    origin: Origin,
    reason: String,
}

/// Judges an odometry by its name and by how its speed follows the wheels. Both have a clock of their own for that:
/// whether other topics serve is not known before.
fn judge(
    all: &Collected,
    odometry: &Stream<OdometrySample>,
    options: &Options,
    notes: &mut Vec<String>,
) -> Result<Verdict, ImportError> {
    let times = [Times::of(&all.joints), Times::of(odometry)];
    let (clock, _) = settle(options.clock, &times);
    // What there is to be said of these is said when they serve.
    let mut unsaid = Columns::default();
    let joints = Track::of_joints(all.joints.clone(), clock, &mut unsaid.notes);
    let [left, right] = wheels(&joints, &all.wheels, options.invert, &mut unsaid)?;
    let speeds = odometry.samples.iter().map(|sample| Sample {
        stamp: sample.stamp,
        logged: sample.logged,
        value: sample.value.velocity[0],
    });
    let speeds = Stream {
        kind: odometry.kind,
        topic: odometry.topic.clone(),
        child_frame: String::new(),
        samples: speeds.collect(),
    };
    let v_x = Track::of(speeds, clock, &mut unsaid.notes);
    let by_name = origin(&v_x.topic);
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
    Ok(match found {
        Follows::Exactly(radius) => Verdict {
            origin: Origin::Wheels,
            reason: format!(
                "whose v_x is {radius:.4} m times the mean wheel speed throughout, as computed from it"
            ),
        },
        Follows::Opposite | Follows::Loosely => Verdict {
            origin: by_name,
            reason: "by its name".into(),
        },
    })
}

impl Plan {
    /// What serves as what, and why.
    ///
    /// # Errors
    /// No wheel speed, or a pose that was asked for and cannot be had.
    pub fn of(
        all: &Collected,
        options: &Options,
        notes: &mut Vec<String>,
    ) -> Result<Self, ImportError> {
        let odometry = match &all.odometry {
            Some(odometry) => Some(Odometry {
                topic: &odometry.topic.name,
                verdict: judge(all, odometry, options, notes)?,
            }),
            None => None,
        };
        let fixes = all.fix.as_ref().and_then(|fix| Fixes::of(fix, notes));
        let sources = Sources { odometry, fixes };
        let pose = sources.pose(options.pose, notes)?;
        Ok(Self {
            pose,
            velocities: sources.velocities(pose, notes),
            heading: options.heading.unwrap_or(match pose {
                Some(Pose::Odometry) => Heading::Odometry,
                _ => Heading::Without,
            }),
        })
    }

    /// Whether odometry serves as anything.
    pub fn has_odometry(&self) -> bool {
        self.velocities || self.pose == Some(Pose::Odometry) || self.heading == Heading::Odometry
    }
}

struct Odometry<'a> {
    topic: &'a str,
    verdict: Verdict,
}

/// Where a pose may come from.
struct Sources<'a> {
    odometry: Option<Odometry<'a>>,
    fixes: Option<Fixes<'a>>,
}

impl Sources<'_> {
    /// Where the pose comes from: odometry unless it is of wheels, or of unknown origin beside precise fixes.
    fn pose(
        &self,
        asked: Option<Pose>,
        notes: &mut Vec<String>,
    ) -> Result<Option<Pose>, ImportError> {
        let missing = |option: &str, kind: MessageKind| ImportError::Missing {
            reason: format!("{option} needs valid messages of {}", kind.message_type()),
            remedy: "ugv import FILE --list shows what the file has".into(),
        };
        let pose = match (asked, &self.odometry, &self.fixes) {
            (Some(Pose::Odometry), None, _) => {
                return Err(missing("--pose odometry", MessageKind::Odometry));
            }
            (Some(Pose::Fix), _, None) => return Err(missing("--pose fix", MessageKind::Fix)),
            (Some(asked), ..) => Some(asked),
            (None, None, None) => {
                notes.push("no pose: there is neither odometry nor a valid fix".into());
                None
            }
            (None, None, Some(_)) => Some(Pose::Fix),
            (None, Some(_), None) => Some(Pose::Odometry),
            (None, Some(odometry), Some(fixes)) => {
                let (pose, note) = better(odometry, fixes);
                notes.push(note);
                Some(pose)
            }
        };
        if let (Some(Pose::Odometry), Some(Odometry { topic, verdict })) = (pose, &self.odometry) {
            match verdict.origin {
                Origin::Wheels => notes.push(format!(
                    "warning: {topic} is wheel odometry {}: its pose and velocities follow from the \
                     wheel speeds and are no ground truth for slip",
                    verdict.reason
                )),
                Origin::Unknown => notes.push(format!(
                    "warning: the name of {topic} does not tell what its pose is from; if it is wheel \
                     odometry, it is no ground truth for slip"
                )),
                Origin::Independent => {}
            }
        }
        Ok(pose)
    }

    /// Whether the velocities of odometry are worth to be taken.
    fn velocities(&self, pose: Option<Pose>, notes: &mut Vec<String>) -> bool {
        let Some(Odometry { topic, verdict }) = &self.odometry else {
            return false;
        };
        if pose == Some(Pose::Odometry) {
            return true;
        }
        let precise = self.fixes.as_ref().is_some_and(|fixes| fixes.precise);
        match verdict.origin {
            Origin::Wheels => {
                notes.push(format!(
                    "velocities of {topic} left out: they follow from the wheel speeds"
                ));
                false
            }
            Origin::Unknown if precise => {
                notes.push(format!(
                    "velocities of {topic} left out: its name does not tell what they are from, and the \
                     pose is better"
                ));
                false
            }
            Origin::Unknown => {
                notes.push(format!(
                    "warning: the name of {topic} does not tell what its velocities are from; if it is \
                     wheel odometry, they are no ground truth for slip"
                ));
                true
            }
            Origin::Independent => true,
        }
    }
}

/// The better pose of two, and why.
fn better(Odometry { topic, verdict }: &Odometry, fixes: &Fixes) -> (Pose, String) {
    let fix = fixes.topic;
    match verdict.origin {
        Origin::Wheels => (
            Pose::Fix,
            format!(
                "pose from {fix}, not from {topic}, wheel odometry {} (--pose odometry takes it)",
                verdict.reason
            ),
        ),
        Origin::Unknown if fixes.precise => (
            Pose::Fix,
            format!(
                "warning: pose from {fix}, whose fixes are good to less than 0.1 m as they say, not from \
                 {topic}, whose name does not tell what its pose is from (--pose odometry takes it)"
            ),
        ),
        Origin::Unknown => (
            Pose::Odometry,
            format!("warning: pose from {topic} (--pose fix takes it from {fix})"),
        ),
        Origin::Independent => (
            Pose::Odometry,
            format!("pose from {topic} (--pose fix takes it from {fix})"),
        ),
    }
}

#[cfg(test)]
mod tests;

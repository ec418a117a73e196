//! Which sensor gives which column of the recording.

use super::ImportError;
use super::checks::{Follows, follows, mirrored};
use super::choose::{Origin, origin};
use super::clock::{Clock, Times, ordered, settle};
use super::collect::{Collected, FixSample, ImuSample, OdometrySample, Stream, WheelSample};
use super::columns::{Column, Columns};
use super::message::Kind;
use super::options::{Heading, Options, Pose};
use super::side::WheelJoints;
use super::wheels::{Series, Source, WheelSpeeds, wheel_speeds};

/// The columns with all that is to be said about them.
pub(super) struct Converted {
    pub columns: Vec<Column>,
    pub clock: Clock,
    pub notes: Vec<String>,
}

/// A topic's samples by time.
struct Track<T> {
    topic: String,
    samples: Vec<(i64, T)>,
}

/// Makes columns of the samples.
///
/// # Errors
/// No wheel speed, or a column that was asked for and cannot be had.
pub(super) fn convert(all: Collected, options: &Options) -> Result<Converted, ImportError> {
    let mut times = vec![Times::of(&all.joints)];
    times.extend(all.odometry.as_ref().map(Times::of));
    times.extend(all.imu.as_ref().map(Times::of));
    times.extend(all.fix.as_ref().map(Times::of));
    let (clock, notes) = settle(options.clock, &times);
    let mut columns = Columns {
        notes,
        ..Columns::default()
    };
    // A robot's arm and its wheels may tell of the same moment in two messages, as each side may.
    let joints = track_with(all.joints, clock, &mut columns, |first, other| {
        let pairs = first.iter_mut().zip(other);
        pairs.fold(false, |taken, (a, b)| a.take(b) | taken)
    });
    let odometry = all
        .odometry
        .map(|stream| track(stream, clock, &mut columns));
    let imu = all.imu.map(|stream| track(stream, clock, &mut columns));
    let fix = all.fix.map(|stream| track(stream, clock, &mut columns));

    let speeds = wheels(&joints, &all.wheels, options.invert, &mut columns)?;
    let origin = odometry
        .as_ref()
        .map(|odometry| judge(odometry, &speeds, &mut columns));
    let has_fix = fix
        .as_ref()
        .is_some_and(|fix| columns.fixes(&fix.topic, &fix.samples));
    let sources = Sources {
        odometry: odometry.as_ref().zip(origin.as_ref()),
        imu: imu.as_ref(),
        fix: fix.as_ref().filter(|_| has_fix),
    };
    let pose = sources.pose(options.pose, &mut columns)?;
    if pose != Some(Pose::Fix) {
        columns
            .columns
            .retain(|column| !matches!(column.name, "x" | "y"));
    }
    sources.write(pose, options.imu_z_down, &mut columns);
    sources.heading(pose, options.heading, &mut columns)?;
    overlap(&mut columns);
    let (columns, notes) = columns.sorted();
    Ok(Converted {
        columns,
        clock,
        notes,
    })
}

fn track<T>(stream: Stream<T>, clock: Clock, columns: &mut Columns) -> Track<T> {
    track_with(stream, clock, columns, |_, _| false)
}

fn track_with<T>(
    stream: Stream<T>,
    clock: Clock,
    columns: &mut Columns,
    fills: impl Fn(&mut T, &T) -> bool,
) -> Track<T> {
    let topic = stream.topic.name.clone();
    let (samples, note) = ordered(stream, clock, fills);
    columns.notes.extend(note);
    Track { topic, samples }
}

/// Adds the wheel speeds, and returns them.
fn wheels(
    joints: &Track<WheelSample>,
    names: &WheelJoints,
    invert: [bool; 2],
    columns: &mut Columns,
) -> Result<[Series; 2], ImportError> {
    let topic = &joints.topic;
    let speeds = wheel_speeds(&joints.samples, names.left.len());
    let WheelSpeeds {
        left,
        right,
        source,
        dead_velocity,
        still,
    } = speeds.ok_or_else(|| ImportError::Joints {
        topic: topic.clone(),
        reason: "no message has the velocities, and no two the positions, of all wheels of a side"
            .into(),
        found: names.left.iter().chain(&names.right).cloned().collect(),
    })?;
    if !still.is_empty() {
        let all: Vec<&String> = names.left.iter().chain(&names.right).collect();
        let names: Vec<&str> = still.iter().map(|joint| all[*joint].as_str()).collect();
        columns.notes.push(format!(
            "warning: {topic}: {} stays exactly at zero while others of its side turn, as joints do that nobody \
             measures; left out of the mean",
            names.join(", ")
        ));
    }
    let how = match source {
        Source::Velocity => "velocity",
        Source::Position { .. } => "velocity from differences of position",
    };
    if let Source::Position { wrapped } = source {
        let why = if dead_velocity {
            "stays at zero while the positions change"
        } else {
            "is not there"
        };
        let wrapped = if wrapped {
            ", whose turns were counted on"
        } else {
            ""
        };
        columns.notes.push(format!(
            "{topic}: the joints' velocity {why}; wheel speeds are differences of positions{wrapped}, \
             at the times in the middle"
        ));
    }
    if mirrored(&left, &right) && invert[0] == invert[1] {
        columns.notes.push(
            "left and right wheels turn against each other nearly all the time: if the vehicle did not \
             pivot all the way, one side is mirrored; import with --invert right (or left)"
                .into(),
        );
    }
    let sides = [
        ("omega_left", left, &names.left, invert[0]),
        ("omega_right", right, &names.right, invert[1]),
    ];
    Ok(sides.map(|(name, mut series, joints, invert)| {
        if invert {
            for (_, speed) in &mut series {
                *speed = -*speed;
            }
        }
        let sign = if invert { ", negated" } else { "" };
        let mean = if joints.len() > 1 { "mean of " } else { "" };
        let conversion = format!("{how}{sign}, {mean}{}", joints.join(", "));
        columns.push(name, topic, &conversion, series.clone());
        series
    }))
}

/// What is known of an odometry's origin, with the reason in words.
struct Verdict {
    origin: Origin,
    reason: String,
}

/// Judges an odometry by its name and by how its speed follows the wheels.
fn judge(
    odometry: &Track<OdometrySample>,
    [left, right]: &[Series; 2],
    columns: &mut Columns,
) -> Verdict {
    let samples = odometry.samples.iter();
    let v_x: Series = samples
        .map(|(time, sample)| (*time, sample.velocity[0]))
        .collect();
    let by_name = origin(&odometry.topic);
    match follows(left, right, &v_x) {
        Follows::Exactly(radius) => Verdict {
            origin: Origin::Wheels,
            reason: format!(
                "whose v_x is {radius:.4} m times the mean wheel speed throughout, as computed from it"
            ),
        },
        Follows::Opposite => {
            columns.notes.push(format!(
                "the wheels turn backwards where {} goes forwards: import with --invert both",
                odometry.topic
            ));
            Verdict {
                origin: by_name,
                reason: "by its name".into(),
            }
        }
        Follows::Loosely => Verdict {
            origin: by_name,
            reason: "by its name".into(),
        },
    }
}

/// What there is besides wheel speeds.
struct Sources<'a> {
    odometry: Option<(&'a Track<OdometrySample>, &'a Verdict)>,
    imu: Option<&'a Track<ImuSample>>,
    /// With a valid fix.
    fix: Option<&'a Track<FixSample>>,
}

impl Sources<'_> {
    /// Where the pose comes from: odometry unless it is of wheels and there are fixes.
    fn pose(
        &self,
        asked: Option<Pose>,
        columns: &mut Columns,
    ) -> Result<Option<Pose>, ImportError> {
        let missing = |option: &str, kind: Kind| ImportError::Missing {
            reason: format!("{option} needs valid messages of {}", kind.message_type()),
            remedy: "ugv import FILE --list shows what the file has".into(),
        };
        let notes = &mut columns.notes;
        let pose = match (asked, self.odometry, self.fix) {
            (Some(Pose::Odometry), None, _) => {
                return Err(missing("--pose odometry", Kind::Odometry));
            }
            (Some(Pose::Fix), _, None) => return Err(missing("--pose fix", Kind::Fix)),
            (Some(asked), ..) => Some(asked),
            (None, None, None) => {
                notes.push("no pose: there is neither odometry nor a valid fix".into());
                None
            }
            (None, None, Some(_)) => Some(Pose::Fix),
            (None, Some(_), None) => Some(Pose::Odometry),
            (None, Some((odometry, verdict)), Some(fix)) => {
                if verdict.origin == Origin::Wheels {
                    notes.push(format!(
                        "pose from {}, not from {}, wheel odometry {} (--pose odometry takes it)",
                        fix.topic, odometry.topic, verdict.reason
                    ));
                    Some(Pose::Fix)
                } else {
                    notes.push(format!(
                        "pose from {} (--pose fix takes it from {})",
                        odometry.topic, fix.topic
                    ));
                    Some(Pose::Odometry)
                }
            }
        };
        if let (Some(Pose::Odometry), Some((odometry, verdict))) = (pose, self.odometry) {
            let topic = &odometry.topic;
            match verdict.origin {
                Origin::Wheels => notes.push(format!(
                    "warning: {topic} is wheel odometry {}: its pose and velocities follow from the \
                     wheel speeds and are no ground truth for slip",
                    verdict.reason
                )),
                Origin::Unknown => notes.push(format!(
                    "the name of {topic} does not tell what its pose is from; if it is wheel odometry, \
                     it is no ground truth for slip"
                )),
                Origin::Independent => {}
            }
        }
        Ok(pose)
    }

    /// Adds pose, velocities, yaw rate and accelerations.
    fn write(&self, pose: Option<Pose>, imu_z_down: bool, columns: &mut Columns) {
        if let Some(imu) = self.imu {
            columns.imu(&imu.topic, &imu.samples, imu_z_down);
        }
        let Some((odometry, verdict)) = self.odometry else {
            return;
        };
        if pose == Some(Pose::Odometry) {
            columns.position(&odometry.topic, &odometry.samples);
        } else if verdict.origin == Origin::Wheels {
            columns.notes.push(format!(
                "velocities of {} left out: they follow from the wheel speeds",
                odometry.topic
            ));
            return;
        }
        let has_yaw_rate = columns
            .columns
            .iter()
            .any(|column| column.name == "yaw_rate");
        columns.twist(&odometry.topic, &odometry.samples, !has_yaw_rate);
    }

    /// Adds the heading: where the pose is from odometry, from there.
    fn heading(
        &self,
        pose: Option<Pose>,
        asked: Option<Heading>,
        columns: &mut Columns,
    ) -> Result<(), ImportError> {
        let heading = asked.unwrap_or(match pose {
            Some(Pose::Odometry) => Heading::Odometry,
            _ => Heading::Without,
        });
        let (option, found) = match heading {
            Heading::Without => {
                if asked.is_none() && pose == Some(Pose::Fix) {
                    let note = "no heading: fixes have none (--heading imu or odometry takes it from \
                                there)";
                    columns.notes.push(note.into());
                }
                return Ok(());
            }
            Heading::Odometry => {
                let found = self.odometry.is_some_and(|(odometry, _)| {
                    let samples = odometry.samples.iter();
                    let yaws = samples.map(|(time, sample)| (*time, Some(sample.yaw)));
                    columns.heading(&odometry.topic, yaws)
                });
                ("--heading odometry", found)
            }
            Heading::Imu => {
                let found = self.imu.is_some_and(|imu| {
                    let samples = imu.samples.iter();
                    columns.heading(
                        &imu.topic,
                        samples.map(|(time, sample)| (*time, sample.yaw)),
                    )
                });
                ("--heading imu", found)
            }
        };
        if !found && asked.is_some() {
            return Err(ImportError::Missing {
                reason: format!("{option} needs messages with an attitude"),
                remedy: "ugv import FILE --list shows what the file has".into(),
            });
        }
        let strange = match pose {
            Some(Pose::Odometry) => heading == Heading::Imu,
            Some(Pose::Fix) => heading == Heading::Odometry,
            None => false,
        };
        if strange {
            let note = "heading and position come from different topics: zero of the heading may not be \
                        the x axis";
            columns.notes.push(note.into());
        }
        Ok(())
    }
}

/// Says which columns have no sample while there are wheel speeds.
fn overlap(columns: &mut Columns) {
    let span = |column: &Column| {
        let times = (column.samples.first(), column.samples.last());
        times
            .0
            .zip(times.1)
            .map(|((first, _), (last, _))| [*first, *last])
    };
    let Some([start, end]) = columns.columns.first().and_then(span) else {
        return;
    };
    let beside =
        |column: &&Column| span(column).is_some_and(|[first, last]| last < start || first > end);
    let names: Vec<&str> = columns
        .columns
        .iter()
        .filter(beside)
        .map(|c| c.name)
        .collect();
    if !names.is_empty() {
        columns.notes.push(format!(
            "warning: no sample of {} lies within the time of the wheel speeds; compare the clocks \
             (--time log)",
            names.join(", ")
        ));
    }
}

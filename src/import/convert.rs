//! Conversion of samples to columns.

use super::choose::{Origin, origin};
use super::clock::{Clock, Times, settle};
use super::collect::{Collected, ImuSample, OdometrySample};
use super::columns::{Column, ColumnBuilder};
use super::error::ImportError;
use super::mounting::Mounting;
use super::options::{HeadingChoice, ImportOptions, PoseChoice};
use super::plan::Plan;
use super::track::{Track, wheels};
use crate::recording::Channel;

/// The columns with notes.
pub(super) struct Converted {
    pub columns: Vec<Column>,
    pub clock: Clock,
    pub notes: Vec<String>,
}

/// Makes columns of the samples.
///
/// # Errors
/// No wheel speed, or a requested column that is not available.
pub(super) fn convert(
    mut all: Collected,
    options: &ImportOptions,
) -> Result<Converted, ImportError> {
    let mut columns = ColumnBuilder::default();
    let plan = Plan::of(&all, options, &mut columns.notes)?;
    // Unused topics do not affect the clock.
    all.odometry = all.odometry.filter(|_| plan.has_odometry());
    all.fix = all.fix.filter(|_| plan.pose == Some(PoseChoice::Fix));
    all.twist = all.twist.filter(|_| !plan.velocities);
    let mut times = vec![Times::of(&all.joints)];
    times.extend(all.odometry.as_ref().map(Times::of));
    times.extend(all.imu.as_ref().map(Times::of));
    times.extend(all.fix.as_ref().map(Times::of));
    times.extend(all.twist.as_ref().map(Times::of));
    let (clock, notes) = settle(options.clock, &times);
    columns.notes.extend(notes);
    let joints = Track::of_joints(all.joints, clock, &mut columns.notes);
    let odometry = all
        .odometry
        .map(|stream| Track::of(stream, clock, &mut columns.notes));
    let imu = all
        .imu
        .map(|stream| Track::of(stream, clock, &mut columns.notes));
    let fix = all
        .fix
        .map(|stream| Track::of(stream, clock, &mut columns.notes));

    let twist = all
        .twist
        .map(|stream| Track::of(stream, clock, &mut columns.notes));

    let speeds = wheels(&joints, &all.wheels, options.invert, &mut columns)?;
    columns.loads(
        &joints.topic,
        all.load,
        &joints.samples,
        all.wheels.left.len(),
    );
    if let Some(fix) = &fix {
        columns.fixes(&fix.topic, &fix.samples);
    }
    if let Some(imu) = &imu {
        let mounting = Mounting::of(&imu.samples, &speeds);
        columns.imu(&imu.topic, &imu.samples, mounting, options.imu_z_down);
    }
    if let Some(odometry) = &odometry {
        write(odometry, plan, &mut columns);
    }
    if let Some(twist) = &twist {
        write_twist(twist, &mut columns);
    }
    write_heading(
        plan,
        odometry.as_ref(),
        imu.as_ref(),
        options.heading.is_some(),
        &mut columns,
    )?;
    note_missing_overlap(&mut columns);
    let (columns, notes) = columns.sorted();
    Ok(Converted {
        columns,
        clock,
        notes,
    })
}

/// Adds pose and velocities.
fn write(odometry: &Track<OdometrySample>, plan: Plan, columns: &mut ColumnBuilder) {
    if plan.pose == Some(PoseChoice::Odometry) {
        columns.position(&odometry.topic, &odometry.samples);
    }
    if plan.velocities {
        let has_yaw_rate = has(columns, Channel::YawRate);
        columns.twist(&odometry.topic, &odometry.samples, !has_yaw_rate);
    }
}

fn has(columns: &ColumnBuilder, channel: Channel) -> bool {
    let mut channels = columns.columns.iter().filter_map(|column| column.channel);
    channels.any(|known| known == channel)
}

/// Adds the velocities of a topic that has nothing else.
fn write_twist(twist: &Track<OdometrySample>, columns: &mut ColumnBuilder) {
    if origin(&twist.topic) != Origin::Independent {
        columns.notes.push(format!(
            "warning: the name of {} does not show the source of its velocities; if it is wheel odometry, they are no \
             ground truth for slip (--topics twist=none leaves them out)",
            twist.topic
        ));
    }
    let has_yaw_rate = has(columns, Channel::YawRate);
    columns.twist(&twist.topic, &twist.samples, !has_yaw_rate);
}

/// Adds the heading.
fn write_heading(
    plan: Plan,
    odometry: Option<&Track<OdometrySample>>,
    imu: Option<&Track<ImuSample>>,
    is_requested: bool,
    columns: &mut ColumnBuilder,
) -> Result<(), ImportError> {
    let (option, found) = match plan.heading {
        HeadingChoice::Without => {
            if !is_requested && plan.pose == Some(PoseChoice::Fix) {
                let note = "no heading: fixes have none (--heading imu or odometry takes it from \
                            there)";
                columns.notes.push(note.into());
            }
            return Ok(());
        }
        HeadingChoice::Odometry => {
            let found = odometry.is_some_and(|odometry| {
                let samples = odometry.samples.iter();
                let yaws = samples.map(|(time, sample)| (*time, Some(sample.yaw)));
                columns.heading(&odometry.topic, is_requested, yaws)
            });
            ("--heading odometry", found)
        }
        HeadingChoice::Imu => {
            let found = imu.is_some_and(|imu| {
                let samples = imu.samples.iter();
                columns.heading(
                    &imu.topic,
                    is_requested,
                    samples.map(|(time, sample)| (*time, sample.yaw)),
                )
            });
            ("--heading imu", found)
        }
    };
    if !found && is_requested {
        return Err(ImportError::Missing {
            reason: format!("{option} needs messages with an attitude"),
            remedy: "ugv import FILE --list shows what the file has".into(),
        });
    }
    let strange = match plan.pose {
        Some(PoseChoice::Odometry) => plan.heading == HeadingChoice::Imu,
        Some(PoseChoice::Fix) => plan.heading == HeadingChoice::Odometry,
        None => false,
    };
    if strange {
        let note = "heading and position come from different topics: zero of the heading may not be \
                    the x axis";
        columns.notes.push(note.into());
    }
    Ok(())
}

/// Notes the columns without a sample during the wheel speeds.
fn note_missing_overlap(columns: &mut ColumnBuilder) {
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
        .map(|column| column.name)
        .collect();
    if !names.is_empty() {
        columns.notes.push(format!(
            "warning: no sample of {} lies within the time of the wheel speeds; compare the clocks \
             (--time log)",
            names.join(", ")
        ));
    }
}

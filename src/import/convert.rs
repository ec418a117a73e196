//! Which sensor gives which column of the recording.

use super::ImportError;
use super::clock::{Clock, Times, settle};
use super::collect::{Collected, ImuSample, OdometrySample};
use super::columns::{Column, Columns};
use super::mounting::Mounting;
use super::options::{Heading, Options, Pose};
use super::plan::Plan;
use super::track::{Track, wheels};

/// The columns with all that is to be said about them.
pub(super) struct Converted {
    pub columns: Vec<Column>,
    pub clock: Clock,
    pub notes: Vec<String>,
}

/// Makes columns of the samples.
///
/// # Errors
/// No wheel speed, or a column that was asked for and cannot be had.
pub(super) fn convert(mut all: Collected, options: &Options) -> Result<Converted, ImportError> {
    let mut columns = Columns::default();
    let plan = Plan::of(&all, options, &mut columns.notes)?;
    // What serves as nothing has no say in the clock.
    all.odometry = all.odometry.filter(|_| plan.has_odometry());
    all.fix = all.fix.filter(|_| plan.pose == Some(Pose::Fix));
    let mut times = vec![Times::of(&all.joints)];
    times.extend(all.odometry.as_ref().map(Times::of));
    times.extend(all.imu.as_ref().map(Times::of));
    times.extend(all.fix.as_ref().map(Times::of));
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

    let speeds = wheels(&joints, &all.wheels, options.invert, &mut columns)?;
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
    write_heading(
        plan,
        odometry.as_ref(),
        imu.as_ref(),
        options.heading.is_some(),
        &mut columns,
    )?;
    overlap(&mut columns);
    let (columns, notes) = columns.sorted();
    Ok(Converted {
        columns,
        clock,
        notes,
    })
}

/// Adds pose and velocities.
fn write(odometry: &Track<OdometrySample>, plan: Plan, columns: &mut Columns) {
    if plan.pose == Some(Pose::Odometry) {
        columns.position(&odometry.topic, &odometry.samples);
    }
    if plan.velocities {
        let mut names = columns.columns.iter().map(|column| column.name);
        let has_yaw_rate = names.any(|name| name == "yaw_rate");
        columns.twist(&odometry.topic, &odometry.samples, !has_yaw_rate);
    }
}

/// Adds the heading: where the pose is from odometry, from there.
fn write_heading(
    plan: Plan,
    odometry: Option<&Track<OdometrySample>>,
    imu: Option<&Track<ImuSample>>,
    is_asked: bool,
    columns: &mut Columns,
) -> Result<(), ImportError> {
    let (option, found) = match plan.heading {
        Heading::Without => {
            if !is_asked && plan.pose == Some(Pose::Fix) {
                let note = "no heading: fixes have none (--heading imu or odometry takes it from \
                            there)";
                columns.notes.push(note.into());
            }
            return Ok(());
        }
        Heading::Odometry => {
            let found = odometry.is_some_and(|odometry| {
                let samples = odometry.samples.iter();
                let yaws = samples.map(|(time, sample)| (*time, Some(sample.yaw)));
                columns.heading(&odometry.topic, is_asked, yaws)
            });
            ("--heading odometry", found)
        }
        Heading::Imu => {
            let found = imu.is_some_and(|imu| {
                let samples = imu.samples.iter();
                columns.heading(
                    &imu.topic,
                    is_asked,
                    samples.map(|(time, sample)| (*time, sample.yaw)),
                )
            });
            ("--heading imu", found)
        }
    };
    if !found && is_asked {
        return Err(ImportError::Missing {
            reason: format!("{option} needs messages with an attitude"),
            remedy: "ugv import FILE --list shows what the file has".into(),
        });
    }
    let strange = match plan.pose {
        Some(Pose::Odometry) => plan.heading == Heading::Imu,
        Some(Pose::Fix) => plan.heading == Heading::Odometry,
        None => false,
    };
    if strange {
        let note = "heading and position come from different topics: zero of the heading may not be \
                    the x axis";
        columns.notes.push(note.into());
    }
    Ok(())
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

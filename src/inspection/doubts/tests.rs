//! Drives by the project's own model, spoiled in one way each.

use super::*;
use crate::recording::{About, Note, NoteKind, Run};
use crate::simulation::{Simulation, WheelSpeeds};
use crate::terrain::Terrain;
use crate::vehicle::{Specification, VehicleModel};

/// A robot of 50 kg on four wheels.
fn robot() -> Vehicle {
    Vehicle {
        mass: 50.0,
        yaw_inertia: 3.5,
        wheel_radius: 0.165,
        wheel_width: 0.11,
        row_positions: vec![0.256, -0.256],
        half_track: 0.285,
        com_offset: 0.0,
        com_height: 0.13,
    }
}

/// Rows of time, wheel speeds, x, y, heading, yaw rate.
type Rows = Vec<[f64; 7]>;

/// A minute of several speeds with turns both ways on a soil, with the noise of sensors times a factor.
fn drive(soil: &str, vehicle: &Vehicle, noise: f64) -> Rows {
    driven(soil, vehicle, noise, wheels(vehicle.wheel_radius))
}

/// Wheel speeds of a varied drive.
fn wheels(radius: f64) -> impl Fn(f64) -> [f64; 2] {
    move |time| {
        let ramp = (time / 2.0).min(1.0);
        let ahead = ramp * (0.8 + 0.45 * (0.4 * time).sin()) / radius;
        let turn = ramp * 0.45 * (0.5 * time).sin() * (0.17 * time).cos() / radius;
        [ahead - turn, ahead + turn]
    }
}

/// A minute at 20 Hz with wheel speeds over time.
fn driven(soil: &str, vehicle: &Vehicle, noise: f64, wheels: impl Fn(f64) -> [f64; 2]) -> Rows {
    let terrain = Terrain::preset(soil).unwrap();
    let model = VehicleModel::new(vehicle.clone(), terrain).unwrap();
    driven_by(model, noise, wheels)
}

fn driven_by(model: VehicleModel, noise: f64, wheels: impl Fn(f64) -> [f64; 2]) -> Rows {
    let mut simulation = Simulation::new(model);
    let mut random = fastrand::Rng::with_seed(7);
    let mut normal = |size: f64| {
        let sum: f64 = (0..12).map(|_| random.f64()).sum();
        noise * size * (sum - 6.0)
    };
    let mut rows = Rows::new();
    for k in 0..1200 {
        let time = 0.05 * f64::from(k);
        let ([left, right], next) = (wheels(time), wheels(time + 0.05));
        let state = simulation.state();
        rows.push([
            time,
            left + normal(0.03),
            right + normal(0.03),
            state.x + normal(0.01),
            state.y + normal(0.01),
            state.heading + normal(0.005),
            state.yaw_rate + normal(0.01),
        ]);
        let speeds = |[left, right]: [f64; 2]| WheelSpeeds { left, right };
        let rates = [(next[0] - left) / 0.05, (next[1] - right) / 0.05];
        simulation.set_wheel_speeds(speeds([left, right])).unwrap();
        simulation.set_wheel_accelerations(speeds(rates)).unwrap();
        simulation.step(0.05).unwrap();
    }
    rows
}

const CHANNELS: [Channel; 6] = [
    Channel::OmegaLeft,
    Channel::OmegaRight,
    Channel::X,
    Channel::Y,
    Channel::Heading,
    Channel::YawRate,
];

/// The rows as a recording of these channels of this vehicle.
fn recording(rows: &Rows, channels: &[Channel], vehicle: &Vehicle) -> Recording {
    let run = channels.iter().fold(Run::new(""), |run, channel| {
        let column = 1 + CHANNELS.iter().position(|one| one == channel).unwrap();
        run.with(
            *channel,
            rows.iter().map(|row| (row[0], row[column])).collect(),
        )
    });
    Recording {
        name: "drive".into(),
        runs: vec![run],
        about: About {
            vehicle: Some(vehicle.clone()),
            ..About::default()
        },
        notes: Vec::new(),
    }
}

/// The rows, each changed.
fn with(rows: &Rows, change: impl Fn(&mut [f64; 7])) -> Rows {
    let mut rows = rows.clone();
    rows.iter_mut().for_each(change);
    rows
}

/// The doubts about rows of the robot.
fn of(rows: &Rows) -> Vec<Doubt> {
    doubts(&recording(rows, &CHANNELS, &robot()), None)
}

fn probable(doubts: &[Doubt]) -> Vec<DoubtKind> {
    let probable = doubts.iter().filter(|doubt| doubt.probability >= PROBABLE);
    probable.map(|doubt| doubt.kind).collect()
}

/// The pose that the wheels' odometry makes of rows.
fn odometry(rows: &Rows) -> Rows {
    let mut rows = rows.clone();
    let vehicle = robot();
    for k in 1..rows.len() {
        let [before, now] = [rows[k - 1], rows[k]];
        let mean = |side: usize| 0.5 * (before[side] + now[side]) * vehicle.wheel_radius;
        let (left, right, interval) = (mean(1), mean(2), now[0] - before[0]);
        let turn = interval * (right - left) / (2.0 * vehicle.half_track);
        let (sin, cos) = (before[5] + 0.5 * turn).sin_cos();
        let step = 0.5 * interval * (left + right);
        rows[k][3] = before[3] + step * cos;
        rows[k][4] = before[4] + step * sin;
        rows[k][5] = before[5] + turn;
    }
    rows
}

#[test]
fn clean_drives_are_not_doubted() {
    for soil in Terrain::PRESETS {
        for noise in [0.0, 1.0] {
            let found = of(&drive(soil, &robot(), noise));
            assert!(probable(&found).is_empty(), "{soil} {noise}: {found:#?}");
        }
    }
}

#[test]
fn factors_on_the_wheel_speeds_are_doubted_on_firm_and_on_slipping_soil() {
    for soil in ["dry_clay", "sandy_loam"] {
        let rows = drive(soil, &robot(), 1.0);
        for (factor, expected) in [(2.0, true), (0.5, true), (0.165, true), (1.05, false)] {
            let spoiled = with(&rows, |row| {
                row[1] *= factor;
                row[2] *= factor;
            });
            let found = of(&spoiled);
            let kinds = probable(&found);
            let is_doubted = kinds.first() == Some(&DoubtKind::RollingRatio);
            assert_eq!(is_doubted, expected, "{soil} {factor}: {found:#?}");
            assert_eq!(kinds.is_empty(), !expected, "{soil} {factor}: {found:#?}");
        }
    }
}

#[test]
fn a_side_with_another_factor_is_doubted() {
    for soil in Terrain::PRESETS {
        let rows = drive(soil, &robot(), 1.0);
        for (column, factor, expected) in [
            (1, 2.0, true),
            (2, 0.5, true),
            (2, 9.55, true),
            (1, 1.2, false),
        ] {
            let found = of(&with(&rows, |row| row[column] *= factor));
            let of_sides = found
                .iter()
                .filter(|doubt| doubt.evidence.contains("by the turns"));
            let doubted = of_sides.count() == 1;
            assert_eq!(doubted, expected, "{soil} {column} {factor}: {found:#?}");
        }
    }
}

#[test]
fn sensors_that_stand_still_in_a_drive_are_doubted() {
    let rows = drive("sandy_loam", &robot(), 1.0);
    let dead = |columns: &[usize], from: f64, to: f64| {
        let spoiled = with(&rows, |row| {
            if (from..to).contains(&row[0]) {
                columns.iter().for_each(|column| row[*column] = 0.0);
            }
        });
        let found = of(&spoiled);
        let standing = found.iter().find(|doubt| {
            doubt.kind == DoubtKind::Frozen && doubt.channels.contains(&CHANNELS[columns[0] - 1])
        });
        standing.is_some_and(|doubt| doubt.probability >= PROBABLE)
    };
    for column in [1, 2, 6] {
        assert!(dead(&[column], 0.0, 60.0), "{column}");
        assert!(dead(&[column], 20.0, 30.0), "{column}");
    }
    let dead_wheels = with(&rows, |row| (row[1], row[2]) = (0.0, 0.0));
    let dead_wheels = recording(&dead_wheels, &CHANNELS, &robot());
    assert_eq!(fitness(&dead_wheels, &[]).0, Fitness::Unfit);
    assert!(dead(&[3, 4], 0.0, 60.0));
    // Too short to tell.
    assert!(!dead(&[1], 20.0, 20.5));
    // At rest, and about a locked side.
    let pivoting = |left: f64| {
        let rows = driven("dry_clay", &robot(), 1.0, move |time| {
            let on = f64::from(u8::from((5.0..40.0).contains(&time)));
            [left * on, 3.0 * on]
        });
        let exact = with(&rows, |row| {
            row[1] = if left == 0.0 { 0.0 } else { row[1] };
            row[6] = if row[0] < 5.0 { 0.0 } else { row[6] };
        });
        let found = of(&exact);
        !found.iter().any(|doubt| doubt.kind == DoubtKind::Frozen)
    };
    assert!(pivoting(0.0));
    assert!(pivoting(-3.0));
}

#[test]
fn speeds_of_wheels_behind_a_gear_are_neither_rest_nor_without_sign() {
    let slow = with(&drive("sandy_loam", &robot(), 1.0), |row| {
        row[1] /= 38.3;
        row[2] /= 38.3;
    });
    assert_eq!(probable(&of(&slow)), [DoubtKind::RollingRatio]);
}

#[test]
fn the_number_of_threads_does_not_change_a_probability() {
    let rows = with(&drive("sandy_loam", &robot(), 1.0), |row| {
        row[1] *= 1.4;
        row[2] *= 1.4;
    });
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| of(&rows))
    };
    let alone = on(1);
    assert!(!alone.is_empty());
    assert_eq!(on(3), alone);
}

#[test]
fn without_a_pose_the_gyro_shows_a_factor() {
    let rows = drive("sandy_loam", &robot(), 1.0);
    let rims = with(&rows, |row| {
        row[1] *= 0.165;
        row[2] *= 0.165;
    });
    let channels = [Channel::OmegaLeft, Channel::OmegaRight, Channel::YawRate];
    let found = doubts(&recording(&rims, &channels, &robot()), None);
    assert_eq!(probable(&found), [DoubtKind::RollingRatio], "{found:#?}");
    // The soil is open, so that the unit is a guess and other factors are named beside it.
    let remedy = &found[0].remedy;
    let said = ["6.06 times", "on other soils", "m/s of the rim"];
    assert!(said.iter().all(|text| remedy.contains(text)), "{remedy}");
    let good = doubts(&recording(&rows, &channels, &robot()), None);
    assert!(probable(&good).is_empty(), "{good:#?}");
}

#[test]
fn without_a_vehicle_no_factor_is_claimed() {
    let rows = with(&drive("sandy_loam", &robot(), 1.0), |row| {
        row[1] *= 2.0;
        row[2] *= 2.0;
    });
    let mut unknown = recording(&rows, &CHANNELS, &robot());
    unknown.about.vehicle = None;
    assert!(probable(&doubts(&unknown, None)).is_empty());
    assert_eq!(
        probable(&doubts(&unknown, Some(&robot()))),
        [DoubtKind::RollingRatio]
    );
}

#[test]
fn a_pose_from_the_wheels_is_recognised() {
    for soil in ["dry_clay", "sandy_loam"] {
        let found = of(&odometry(&drive(soil, &robot(), 1.0)));
        assert_eq!(probable(&found)[0], DoubtKind::OwnOdometry, "{found:#?}");
        assert_eq!(found[0].channels.len(), 3);
    }
    // Position alone: the heading is of a gyro.
    let rows = drive("sandy_loam", &robot(), 1.0);
    let copied = odometry(&rows);
    let mixed: Rows = rows
        .iter()
        .zip(&copied)
        .map(|(row, copy)| [row[0], row[1], row[2], row[3], row[4], copy[5], row[6]])
        .collect();
    let found = of(&mixed);
    assert!(
        probable(&found).contains(&DoubtKind::OwnOdometry),
        "{found:#?}"
    );
}

#[test]
fn a_frozen_channel_is_left_out() {
    let rows = drive("sandy_loam", &robot(), 1.0);
    for (column, channel) in [(1, Channel::OmegaLeft), (6, Channel::YawRate)] {
        let held = rows[400][column];
        let frozen = with(&rows, |row| {
            if (20.0..=32.0).contains(&row[0]) {
                row[column] = held;
            }
        });
        let given = recording(&frozen, &CHANNELS, &robot());
        let found = doubts(&given, None);
        let doubt = found.iter().find(|doubt| doubt.kind == DoubtKind::Frozen);
        let doubt = doubt.unwrap_or_else(|| panic!("{found:#?}"));
        assert_eq!(doubt.channels, [channel]);
        let span = doubt.span.unwrap();
        assert!((span.start - 20.0).abs() < 0.1 && (span.end - 32.0).abs() < 0.1);
        assert_eq!(probable(&found), [DoubtKind::Frozen], "{found:#?}");
        let rest = without(&given, &found);
        let samples = |one: &Recording| one.runs[0].series(channel).unwrap().len();
        assert_eq!(samples(&given) - samples(&rest), 241);
        let (fitness, why) = fitness(&given, &found);
        assert_eq!(fitness, Fitness::WithDoubts, "{why}");
    }
    // Standing still, and a stretch too short to matter.
    let at_rest = with(&rows, |row| {
        if (20.0..=32.0).contains(&row[0]) {
            row[1..3].fill(0.0);
            row[6] = 0.0;
        }
    });
    assert!(frozen_kinds(&at_rest).is_empty());
    let short = with(&rows, |row| {
        if (20.0..=20.8).contains(&row[0]) {
            row[1] = 3.0;
        }
    });
    assert!(frozen_kinds(&short).is_empty());
    // A channel that always repeats its values is slow, not frozen.
    let mut held = rows.clone();
    for k in 0..held.len() {
        held[k][6] = rows[k / 40 * 40][6];
    }
    assert!(frozen_kinds(&held).is_empty());
}

#[test]
fn soil_that_differs_between_the_sides_is_no_other_gear() {
    let robot = robot();
    for soil in Terrain::PRESETS {
        for ratio in [0.45, 0.7, 1.7, 2.2] {
            let mut given = Specification::plain(robot.clone(), Terrain::preset(soil).unwrap());
            given.effects = given.effects.with("left_right_soil.ratio", ratio).unwrap();
            let model = VehicleModel::from_specification(&given).unwrap();
            let found = of(&driven_by(model, 1.0, wheels(robot.wheel_radius)));
            let of_sides = found
                .iter()
                .filter(|doubt| doubt.evidence.contains("by the turns"));
            assert_eq!(of_sides.count(), 0, "{soil} {ratio}: {found:#?}");
        }
    }
}

#[test]
fn without_noise_a_constant_wheel_speed_has_to_contradict_the_turns() {
    // Wheels that are steered in steps, on the left less often.
    let steps = |time: f64| {
        let left = 4.0 + 2.0 * (time / 12.0).floor().rem_euclid(2.0);
        [left, left + (0.6 * time).sin()]
    };
    let rows = driven("sandy_loam", &robot(), 0.0, steps);
    assert!(frozen_kinds(&rows).is_empty(), "{:#?}", frozen_kinds(&rows));
    let rows = drive("sandy_loam", &robot(), 0.0);
    assert!(frozen_kinds(&rows).is_empty());
    // Encoders that are read every tenth of a second.
    let mut slow = rows.clone();
    for k in 0..slow.len() {
        (slow[k][1], slow[k][2]) = (rows[k / 2 * 2][1], rows[k / 2 * 2][2]);
    }
    assert!(frozen_kinds(&slow).is_empty());
    for rows in [rows, slow] {
        let held = rows[400][2];
        let frozen = with(&rows, |row| {
            if (20.0..=32.0).contains(&row[0]) {
                row[2] = held;
            }
        });
        let found = frozen_kinds(&frozen);
        assert_eq!(found.len(), 1, "{found:#?}");
        assert_eq!(found[0].channels, [Channel::OmegaRight]);
    }
}

#[test]
fn sensors_that_stand_still_in_several_runs_are_one_doubt() {
    let rows = with(&drive("dry_clay", &robot(), 1.0), |row| row[6] = 0.0);
    let mut given = recording(&rows, &CHANNELS, &robot());
    given.runs.push(given.runs[0].clone());
    let found = doubts(&given, None);
    let of_gyro: Vec<&Doubt> = found
        .iter()
        .filter(|doubt| doubt.channels == [Channel::YawRate])
        .collect();
    assert_eq!(of_gyro.len(), 1, "{found:#?}");
    assert!(of_gyro[0].evidence.ends_with("; and so in 1 more run"));
}

fn frozen_kinds(rows: &Rows) -> Vec<Doubt> {
    constant::frozen(&recording(rows, &CHANNELS, &robot()))
}

#[test]
fn a_heading_that_turns_by_another_factor_than_the_gyro_is_doubted() {
    let rows = drive("dry_clay", &robot(), 1.0);
    for (factor, expected) in [(1.05, false), (1.3, true), (0.7, true)] {
        let scaled = with(&rows, |row| row[6] *= factor);
        let found = of(&scaled);
        let is_doubted = probable(&found).contains(&DoubtKind::HeadingFactor);
        assert_eq!(is_doubted, expected, "{factor}: {found:#?}");
    }
}

#[test]
fn signs_are_doubted() {
    let rows = drive("dry_clay", &robot(), 1.0);
    let gyro = [Channel::OmegaLeft, Channel::OmegaRight, Channel::YawRate];
    for (column, channel) in [(1, Channel::OmegaLeft), (2, Channel::OmegaRight)] {
        let mirrored = with(&rows, |row| row[column] = -row[column]);
        for channels in [&gyro[..], &CHANNELS] {
            let found = doubts(&recording(&mirrored, channels, &robot()), None);
            assert_eq!(probable(&found), [DoubtKind::MirroredSide], "{found:#?}");
            assert_eq!(found[0].channels, [channel]);
        }
    }
    // A drive that pivots for half of its time.
    let mut given = recording(&rows, &CHANNELS, &robot());
    let speed: Series = rows
        .iter()
        .map(|row| (row[0], 0.9 * 0.165 * row[1].abs()))
        .collect();
    let back = with(&rows, |row| {
        if (20.0..40.0).contains(&row[0]) {
            (row[1], row[2]) = (-row[1], -row[2]);
        }
    });
    let reversed = recording(&back, &CHANNELS[..2], &robot());
    given.runs[0] = reversed.runs[0].clone().with(Channel::VX, speed);
    let found = doubts(&given, None);
    assert!(
        probable(&found).contains(&DoubtKind::Unsigned),
        "{found:#?}"
    );
}

#[test]
fn values_that_are_cut_off_coarse_or_jump_are_doubted() {
    let rows = drive("sandy_loam", &robot(), 1.0);
    let cut = with(&rows, |row| row[6] = row[6].clamp(-0.2, 0.2));
    let kinds = |rows: &Rows| probable(&of(rows));
    assert!(
        kinds(&cut).contains(&DoubtKind::Saturated),
        "{:?}",
        of(&cut)
    );
    let coarse = with(&rows, |row| row[1] = (row[1] / 1.5).round() * 1.5);
    assert!(
        kinds(&coarse).contains(&DoubtKind::Quantised),
        "{:?}",
        of(&coarse)
    );
    let fine = with(&rows, |row| row[1] = (row[1] / 0.1).round() * 0.1);
    assert!(kinds(&fine).is_empty(), "{:?}", of(&fine));
    let jump = with(&rows, |row| {
        if row[0] > 30.0 {
            row[3] += 2.5;
        }
    });
    let found = of(&jump);
    assert_eq!(probable(&found), [DoubtKind::Jump], "{found:#?}");
    assert!((found[0].span.unwrap().start - 30.0).abs() < 0.1);
    // A sample that lies apart is an outlier.
    let apart = with(&rows, |row| {
        if (row[0] - 30.0).abs() < 0.01 {
            row[3] += 2.5;
            row[5] += 1.0;
        }
    });
    assert_ne!(apart, rows);
    assert!(of(&apart).is_empty(), "{:?}", of(&apart));
}

#[test]
fn commands_are_no_measurements() {
    let rows = drive("sandy_loam", &robot(), 1.0);
    let mut commanded = rows.clone();
    for k in 0..rows.len() {
        commanded[k][1..3].copy_from_slice(&rows[k / 60 * 60][1..3]);
    }
    // No stretch of them is called frozen.
    assert_eq!(probable(&of(&commanded)), [DoubtKind::Commanded]);
    assert!(commands::doubt(&recording(&rows, &CHANNELS, &robot())).is_none());
}

#[test]
fn missing_values_that_were_written_as_zero_are_left_out() {
    let rows = drive("sandy_loam", &robot(), 1.0);
    let spoiled = |places: &[usize], column: usize| {
        let mut spoiled = rows.clone();
        places.iter().for_each(|k| spoiled[*k][column] = 0.0);
        let given = recording(&spoiled, &CHANNELS, &robot());
        let found = doubts(&given, None);
        let rest = without(&given, &found);
        let left = rest.runs[0].channels().map(|(_, series)| series.len());
        (
            probable(&found),
            CHANNELS.len() * rows.len() - left.sum::<usize>(),
        )
    };
    for column in [1, 2] {
        let (kinds, left_out) = spoiled(&[200, 201, 430, 800], column);
        assert_eq!(kinds, [DoubtKind::Dropout]);
        assert_eq!(left_out, 4);
    }
    // A yaw rate that passes zero, and a stop.
    assert_eq!(spoiled(&[], 6), (Vec::new(), 0));
    let stop: Vec<usize> = (400..440).collect();
    assert!(!spoiled(&stop, 1).0.contains(&DoubtKind::Dropout));
}

#[test]
fn a_position_in_another_unit_is_doubted_and_nothing_else() {
    for soil in ["dry_clay", "sandy_loam"] {
        let rows = drive(soil, &robot(), 1.0);
        for (unit, factor, expected) in [
            ("mm", 1000.0, true),
            ("cm", 100.0, true),
            ("ft", 3.281, true),
            ("km", 0.001, true),
            ("m", 1.0, false),
        ] {
            let scaled = with(&rows, |row| {
                row[3] *= factor;
                row[4] *= factor;
            });
            let found = of(&scaled);
            let unit = format!("x_{unit}");
            let is_named = found
                .first()
                .is_some_and(|doubt| doubt.remedy.contains(&unit));
            assert_eq!(is_named, expected, "{soil} {factor}: {found:#?}");
            assert_eq!(probable(&found).len(), usize::from(expected), "{found:#?}");
        }
    }
}

#[test]
fn clocks_that_differ_by_seconds_are_doubted() {
    let rows = drive("sandy_loam", &robot(), 1.0);
    for (late, expected) in [(0, false), (8, false), (40, true), (-60, true)] {
        let mut shifted = rows.clone();
        for (k, row) in shifted.iter_mut().enumerate() {
            let from = (k as i32 - late).clamp(0, rows.len() as i32 - 1) as usize;
            row[3..6].copy_from_slice(&rows[from][3..6]);
        }
        let found = of(&shifted);
        let clock = found.iter().find(|doubt| doubt.kind == DoubtKind::Clock);
        let is_doubted = clock.is_some_and(|doubt| doubt.probability >= PROBABLE);
        assert_eq!(is_doubted, expected, "{late}: {found:#?}");
        if let Some(doubt) = clock.filter(|_| expected) {
            // The vehicle follows its wheels a little late.
            let said = doubt.remedy.split(' ').nth(1).unwrap();
            let off = said.parse::<f64>().unwrap() - 0.05 * f64::from(late);
            assert!((0.0..0.25).contains(&off), "{}", doubt.remedy);
        }
    }
}

#[test]
fn a_heading_that_jumps_is_doubted() {
    let rows = drive("sandy_loam", &robot(), 1.0);
    for (angle, expected) in [(0.3, false), (1.0, true), (-1.2, true)] {
        let jump = with(&rows, |row| {
            if row[0] > 30.0 {
                row[5] += angle;
            }
        });
        let found = of(&jump);
        let is_doubted = probable(&found).contains(&DoubtKind::Jump);
        assert_eq!(is_doubted, expected, "{angle}: {found:#?}");
    }
}

#[test]
fn too_short_a_recording_is_unfit() {
    let rows = drive("sandy_loam", &robot(), 1.0);
    for (count, expected) in [
        (1, Fitness::Unfit),
        (150, Fitness::Unfit),
        (600, Fitness::Fit),
    ] {
        let given = recording(&rows[..count].to_vec(), &CHANNELS, &robot());
        let (fitness, why) = fitness(&given, &doubts(&given, None));
        assert_eq!(fitness, expected, "{count}: {why}");
    }
}

#[test]
fn warnings_of_reader_and_importer_stay_doubts() {
    let mut given = recording(&drive("dry_clay", &robot(), 1.0), &CHANNELS, &robot());
    given.about.import_warnings = vec!["/odom is wheel odometry by its name".into()];
    given.notes = vec![Note {
        kind: NoteKind::Suspicion,
        channel: Some(Channel::Heading),
        count: 5,
        line: 2,
        text: "may be degrees".into(),
    }];
    let found = doubts(&given, None);
    let texts: Vec<&str> = found.iter().map(|one| &one.evidence[..]).collect();
    assert!(texts[0].contains("/odom is wheel odometry"), "{texts:?}");
    assert!(texts[1].contains("may be degrees"), "{texts:?}");
    assert_eq!(probable(&found), [DoubtKind::Source]);
}

#[test]
fn a_recording_without_motion_is_unfit() {
    let rows = drive("dry_clay", &robot(), 1.0);
    let given = recording(&rows, &CHANNELS[..2], &robot());
    let (fitness, why) = fitness(&given, &doubts(&given, None));
    assert_eq!(fitness, Fitness::Unfit);
    assert!(why.contains("no motion"), "{why}");
}

#[test]
fn corrections_of_the_reader_are_mentioned() {
    let mut given = recording(&drive("dry_clay", &robot(), 1.0), &CHANNELS, &robot());
    let clean = fitness(&given, &[]);
    assert_eq!(clean.0, Fitness::Fit);
    given.notes = vec![Note {
        kind: NoteKind::Sign,
        channel: Some(Channel::OmegaRight),
        count: 1200,
        line: 2,
        text: "its sign turned round".into(),
    }];
    let corrected = fitness(&given, &[]);
    assert_eq!(corrected.0, Fitness::Fit);
    assert_eq!(corrected.1, clean.1 + " after the corrections below");
}

#[test]
fn a_steady_bend_to_one_side_is_no_copy() {
    let bend = |time: f64| {
        let turn = 0.3 * (time / 28.0).min(1.0);
        [0.7 - turn, 0.7 + turn].map(|rim| (time / 2.0).min(1.0) * rim / robot().wheel_radius)
    };
    for soil in Terrain::PRESETS {
        let rows = driven(soil, &robot(), 0.0, bend);
        let found = of(&rows);
        assert!(probable(&found).is_empty(), "{soil}: {found:#?}");
    }
}

//! Models judged by recordings whose truth is known.

use std::f64::consts::PI;
use std::sync::Arc;
use ugv_terrain::identification::{
    HeadingSource, IdentificationError, Kinematics, KinematicsForm, Latencies, Latency,
    MotionModel, PoseError, PredictionWindow, Signals, WindowOptions, WindowSet, cut,
    heading_noise, split,
};
use ugv_terrain::recording::{Channel, Recording, Run, Series};
use ugv_terrain::simulation::Simulation;
use ugv_terrain::terrain::Terrain;
use ugv_terrain::vehicle::{Vehicle, VehicleModel};

/// Step of the truth [s].
const STEP: f64 = 0.01;

/// Wheel speeds of a lively drive [rad/s].
fn wheels(time: f64) -> [f64; 2] {
    let ahead = 4.0 + 1.5 * (0.31 * time).sin();
    let turn = 1.2 * (0.83 * time).sin() + 0.8 * (1.37 * time + 1.0).sin();
    [ahead - turn, ahead + turn]
}

/// What a world does: time, x, y, heading, v_x, v_y, yaw rate every [`STEP`].
type Truth = Vec<[f64; 7]>;

/// A vehicle that follows its wheels as kinematics say.
fn kinematic_world(kinematics: Kinematics, seconds: f64) -> Truth {
    let mut truth = Truth::new();
    let (mut x, mut y, mut heading) = (1.0, -2.0, 0.4);
    for k in 0..=(seconds / STEP) as usize {
        let time = k as f64 * STEP;
        let velocity = |time: f64| {
            let [left, right] = wheels(time);
            let yaw_rate = kinematics.wheel_radius * (right - left) / kinematics.track;
            let v_x = kinematics.wheel_radius * (left + right) / 2.0;
            [v_x, -kinematics.icr_x * yaw_rate, yaw_rate]
        };
        let [v_x, v_y, yaw_rate] = velocity(time);
        truth.push([time, x, y, heading, v_x, v_y, yaw_rate]);
        let [v_x, v_y, yaw_rate] = velocity(time + 0.5 * STEP);
        let (sin, cos) = (heading + 0.5 * STEP * yaw_rate).sin_cos();
        x += STEP * (v_x * cos - v_y * sin);
        y += STEP * (v_x * sin + v_y * cos);
        heading += STEP * yaw_rate;
    }
    truth
}

fn sand() -> Arc<VehicleModel> {
    let terrain = Terrain::preset("dry_sand").unwrap();
    Arc::new(VehicleModel::new(Vehicle::tran2007(), terrain).unwrap())
}

/// A vehicle on sand.
fn soil_world(seconds: f64) -> Truth {
    let mut simulation = Simulation::new(sand());
    let mut truth = Truth::new();
    for k in 0..=(seconds / STEP) as usize {
        let time = k as f64 * STEP;
        let mut row = [time; 7];
        row[1..].copy_from_slice(&simulation.state().to_array());
        truth.push(row);
        let (now, next) = (wheels(time), wheels(time + STEP));
        simulation.set_wheel_speeds(now.into()).unwrap();
        let rates = [0, 1].map(|side| (next[side] - now[side]) / STEP);
        simulation.set_wheel_accelerations(rates.into()).unwrap();
        simulation.step(STEP).unwrap();
    }
    truth
}

/// Sensors that look at a world.
#[derive(Clone, Copy)]
struct Sensors {
    pose_latency: f64,
    wheel_latency: f64,
    gyro: bool,
    /// What the gyro adds [rad/s].
    gyro_bias: f64,
    /// Size of the errors of x and y [m].
    position_noise: f64,
}

const PERFECT: Sensors = Sensors {
    pose_latency: 0.0,
    wheel_latency: 0.0,
    gyro: true,
    gyro_bias: 0.0,
    position_noise: 0.0,
};

/// A run as sensors record it: pose at 10 Hz, wheels and gyro at 20 Hz.
fn record(label: &str, truth: &Truth, sensors: Sensors) -> Run {
    let sample = |every: usize, latency: f64, value: &dyn Fn(&[f64; 7]) -> f64| -> Series {
        let rows = truth.iter().step_by(every);
        let late = rows.map(|row| (row[0] + latency, value(row)));
        let end = truth[truth.len() - 1][0];
        late.filter(|(time, _)| *time <= end).collect()
    };
    // Errors that look irregular, and are the same every time.
    let noise = |time: f64, phase: f64| sensors.position_noise * (7919.0 * time + phase).sin();
    let pose = sensors.pose_latency;
    let wheel = sensors.wheel_latency;
    let run = Run::new(label)
        .with(
            Channel::OmegaLeft,
            sample(5, wheel, &|row| wheels(row[0])[0]),
        )
        .with(
            Channel::OmegaRight,
            sample(5, wheel, &|row| wheels(row[0])[1]),
        )
        .with(
            Channel::X,
            sample(10, pose, &|row| row[1] + noise(row[0], 0.0)),
        )
        .with(
            Channel::Y,
            sample(10, pose, &|row| row[2] + noise(row[0], 2.0)),
        )
        .with(Channel::Heading, sample(10, pose, &|row| row[3]));
    if sensors.gyro {
        run.with(
            Channel::YawRate,
            sample(5, 0.0, &|row| row[6] + sensors.gyro_bias),
        )
    } else {
        run
    }
}

fn recording(runs: Vec<Run>) -> Recording {
    Recording {
        name: "drive".into(),
        runs,
        ..Recording::default()
    }
}

/// Signals with their latencies removed, and the windows.
fn prepare(recording: &Recording, how: &WindowOptions) -> (Vec<Signals>, WindowSet) {
    let mut runs = Signals::of(recording).unwrap();
    let latencies = Latencies::estimate(&runs);
    for run in &mut runs {
        run.remove(&latencies);
    }
    let set = cut("drive", &runs, how).unwrap();
    (runs, set)
}

fn errors(predictor: &MotionModel, windows: &[PredictionWindow]) -> Vec<PoseError> {
    let error = |window| PoseError::new(window, predictor.predict(window).unwrap());
    windows.iter().map(error).collect()
}

fn worst(errors: &[PoseError]) -> (f64, f64) {
    errors
        .iter()
        .fold((0.0, 0.0), |(position, heading), error| {
            (error.position.max(position), error.heading.max(heading))
        })
}

const NOMINAL: Kinematics = Kinematics {
    wheel_radius: 0.25,
    track: 1.22,
    icr_x: 0.0,
};

#[test]
fn two_parameters_are_recovered_through_noise() {
    let world = Kinematics {
        wheel_radius: 0.229,
        track: 2.05,
        icr_x: 0.0,
    };
    let noisy = Sensors {
        position_noise: 0.03,
        ..PERFECT
    };
    let drive = recording(vec![record("", &kinematic_world(world, 120.0), noisy)]);
    let (runs, set) = prepare(&drive, &WindowOptions::default());
    let halves = split(&runs, &set.windows);
    let fitted: Vec<&PredictionWindow> = halves.fitted.iter().map(|k| &set.windows[*k]).collect();
    let fit = Kinematics::fit(KinematicsForm::TwoParameter, &fitted, &NOMINAL).unwrap();
    for (name, estimate, truth, tolerance) in [
        ("radius", fit.wheel_radius, world.wheel_radius, 0.001),
        ("track", fit.track, world.track, 0.02),
    ] {
        assert!(
            (estimate.value - truth).abs() < tolerance,
            "{name}: {estimate:?}"
        );
        // Three times the interval's reach: 90 % intervals miss now and then.
        let reach = 1.5 * estimate.width();
        assert!(
            (estimate.value - truth).abs() < reach,
            "{name}: {estimate:?}"
        );
        assert!(reach < 20.0 * tolerance, "{name}: {estimate:?}");
    }
    assert_eq!(fit.icr_x, None);
    let judged: Vec<PredictionWindow> = halves
        .judged
        .iter()
        .map(|k| set.windows[*k].clone())
        .collect();
    // Noise of start and end, and the interpolation of the pose.
    let (position, heading) = worst(&errors(&MotionModel::Kinematics(fit.kinematics), &judged));
    assert!(position < 0.12 && heading < 0.02, "{position} {heading}");
    let (position, heading) = worst(&errors(&MotionModel::Kinematics(NOMINAL), &judged));
    assert!(position > 0.5 && heading > 0.3, "{position} {heading}");
}

#[test]
fn third_parameter_is_recovered() {
    let world = Kinematics {
        wheel_radius: 0.24,
        track: 1.7,
        icr_x: 0.31,
    };
    let drive = recording(vec![record("", &kinematic_world(world, 60.0), PERFECT)]);
    let (_, set) = prepare(&drive, &WindowOptions::default());
    let windows: Vec<&PredictionWindow> = set.windows.iter().collect();
    let fit = Kinematics::fit(KinematicsForm::ThreeParameter, &windows, &NOMINAL).unwrap();
    assert!((fit.icr_x.unwrap().value - 0.31).abs() < 0.01, "{fit:?}");
    assert!((fit.track.value - 1.7).abs() < 0.01, "{fit:?}");
    // Without the third parameter an error remains.
    let two = Kinematics::fit(KinematicsForm::TwoParameter, &windows, &NOMINAL).unwrap();
    let error = |k| worst(&errors(&MotionModel::Kinematics(k), &set.windows)).0;
    assert!(error(fit.kinematics) < 0.02 && error(two.kinematics) > 0.1);
}

#[test]
fn straight_drives_leave_the_track_open_and_few_windows_everything() {
    let world = kinematic_world(NOMINAL, 40.0);
    let drive = recording(vec![record("", &world, PERFECT)]);
    let (_, set) = prepare(&drive, &WindowOptions::default());
    let few: Vec<&PredictionWindow> = set.windows.iter().take(3).collect();
    assert_eq!(
        Kinematics::fit(KinematicsForm::TwoParameter, &few, &NOMINAL),
        None
    );

    let straight: Vec<PredictionWindow> = set
        .windows
        .iter()
        .map(|window| {
            let mut window = window.clone();
            window.wheels.omega_right = window.wheels.omega_left.clone();
            window
        })
        .collect();
    let straight: Vec<&PredictionWindow> = straight.iter().collect();
    assert_eq!(
        Kinematics::fit(KinematicsForm::TwoParameter, &straight, &NOMINAL),
        None
    );
}

#[test]
fn latencies_are_recovered() {
    let truth = kinematic_world(NOMINAL, 90.0);
    for (pose_latency, wheel_latency) in [(0.35, 0.12), (0.0, 0.0), (0.8, 0.2)] {
        for (gyro, gyro_bias) in [(true, 0.0), (true, 0.3), (true, -0.3), (false, 0.0)] {
            let sensors = Sensors {
                pose_latency,
                wheel_latency,
                gyro,
                gyro_bias,
                ..PERFECT
            };
            let drive = recording(vec![record("", &truth, sensors)]);
            let found = Latencies::estimate(&Signals::of(&drive).unwrap());
            let Latency::Estimated(pose) = found.pose else {
                panic!("{found:?}");
            };
            // Without a gyro the wheels are the clock. Twice the search's step.
            let expected = pose_latency - if gyro { 0.0 } else { wheel_latency };
            assert!((pose.value - expected).abs() < 0.021, "{pose:?} {expected}");
            match found.wheels {
                Latency::Estimated(wheels) => {
                    assert!((wheels.value - wheel_latency).abs() < 0.021, "{wheels:?}");
                }
                other => assert!(!gyro && other == Latency::Reference, "{other:?}"),
            }
        }
    }
}

#[test]
fn latency_of_a_straight_drive_is_unknown() {
    let late = Sensors {
        pose_latency: 0.4,
        ..PERFECT
    };
    let mut truth = kinematic_world(NOMINAL, 30.0);
    for row in &mut truth {
        // A gyro that only hums.
        (row[3], row[6]) = (0.1, 0.003 * (977.0 * row[0]).sin());
    }
    let drive = recording(vec![record("", &truth, late)]);
    let found = Latencies::estimate(&Signals::of(&drive).unwrap());
    assert_eq!((found.pose, found.pose.value()), (Latency::Unknown, 0.0));
}

#[test]
fn soil_model_predicts_its_own_world() {
    let sensors = Sensors {
        pose_latency: 0.3,
        wheel_latency: 0.1,
        ..PERFECT
    };
    let drive = recording(vec![record("", &soil_world(40.0), sensors)]);
    let (_, mut set) = prepare(&drive, &WindowOptions::default());
    // The truth starts with a jump from rest, which no fit to positions can follow.
    set.windows.retain(|window| window.start > 0.4);
    let (position, heading) = worst(&errors(&MotionModel::Soil(sand()), &set.windows));
    // The vehicle's own response lets the wheels seem 0.05 s later than they are, at 1 m/s.
    assert!(position < 0.1 && heading < 0.05, "{position} {heading}");
    let no_slip = Kinematics::no_slip(&Vehicle::tran2007());
    let (position, heading) = worst(&errors(&MotionModel::Kinematics(no_slip), &set.windows));
    assert!(position > 0.5 && heading > 0.3, "{position} {heading}");
}

#[test]
fn windows_start_with_the_velocities_of_the_truth() {
    let truth = soil_world(40.0);
    let noisy = Sensors {
        position_noise: 0.02,
        ..PERFECT
    };
    // Accelerations change within the fit's reach; noise adds 0.02 m/s.
    for (sensors, tolerance) in [(PERFECT, 0.05), (noisy, 0.1)] {
        let drive = recording(vec![record("", &truth, sensors)]);
        let runs = Signals::of(&drive).unwrap();
        let set = cut("drive", &runs, &WindowOptions::default()).unwrap();
        for window in set.windows.iter().filter(|window| window.start > 1.0) {
            let row = truth[(window.start / STEP).round() as usize];
            let state = window.state.to_array();
            for k in 3..6 {
                let error = (state[k] - row[k + 1]).abs();
                assert!(error < tolerance, "{k} at {}: {error}", window.start);
            }
        }
    }
}

#[test]
fn windows_are_spaced_and_leave_out_rest_and_gaps() {
    let mut truth = kinematic_world(NOMINAL, 30.0);
    let how = WindowOptions {
        horizon: 3.0,
        spacing: 1.0,
        ..WindowOptions::default()
    };
    let drive = recording(vec![record("", &truth, PERFECT)]);
    let whole = cut("drive", &Signals::of(&drive).unwrap(), &how).unwrap();
    let starts: Vec<f64> = whole
        .windows
        .iter()
        .map(|window| window.start.round())
        .collect();
    assert_eq!(starts, (0..27).map(f64::from).collect::<Vec<_>>());
    assert!(
        whole
            .windows
            .iter()
            .all(|w| (w.horizon() - 3.0).abs() < 1e-9)
    );
    assert_eq!((whole.rejected.standing, whole.rejected.gaps), (0, 0));

    // Without poses from 10 to 12 s no window may start or end there.
    let outside = |series: &Series| -> Series {
        series
            .samples()
            .filter(|(time, _)| !(10.05..11.95).contains(time))
            .collect()
    };
    let run = &drive.runs[0];
    let gap = [Channel::X, Channel::Y, Channel::Heading]
        .into_iter()
        .fold(run.clone(), |gap, channel| {
            gap.with(channel, outside(run.series(channel).unwrap()))
        });
    let set = cut("drive", &Signals::of(&recording(vec![gap])).unwrap(), &how).unwrap();
    // Starts or ends at 10, 11 s; rounding decides about 10 s itself.
    assert!((3..=6).contains(&set.rejected.gaps), "{:?}", set.rejected);
    assert_eq!(set.windows.len() + set.rejected.gaps, 27);

    // Standing from 15 s on.
    let still = |series: &Series| -> Series {
        series
            .samples()
            .map(|(t, v)| (t, if t < 15.0 { v } else { 0.0 }))
            .collect()
    };
    let rest = [Channel::OmegaLeft, Channel::OmegaRight]
        .into_iter()
        .fold(run.clone(), |rest, channel| {
            rest.with(channel, still(run.series(channel).unwrap()))
        });
    let set = cut("drive", &Signals::of(&recording(vec![rest])).unwrap(), &how).unwrap();
    assert_eq!(set.rejected.standing, 12);

    truth.truncate(200);
    let short = recording(vec![record("", &truth, PERFECT)]);
    let error = cut("drive", &Signals::of(&short).unwrap(), &how).unwrap_err();
    let IdentificationError::TooShort { longest, .. } = error else {
        panic!("{error}");
    };
    assert!((longest - 1.9).abs() < 0.051, "{longest}");
}

#[test]
fn recordings_without_pose_and_settings_out_of_range_are_refused() {
    let run = record("", &kinematic_world(NOMINAL, 10.0), PERFECT);
    let blind = run.clone().with(Channel::X, Series::default());
    let error = Signals::of(&recording(vec![blind])).unwrap_err();
    assert!(error.to_string().contains("no sample of x:"), "{error}");
    let runs = Signals::of(&recording(vec![run])).unwrap();
    for (horizon, spacing) in [(0.0, 1.0), (f64::NAN, 1.0), (5.0, -1.0), (1e9, 1.0)] {
        let how = WindowOptions {
            horizon,
            spacing,
            ..WindowOptions::default()
        };
        let error = cut("drive", &runs, &how).unwrap_err();
        assert!(
            matches!(error, IdentificationError::Setting { .. }),
            "{error}"
        );
    }
}

#[test]
fn halves_of_a_run_do_not_overlap() {
    let how = WindowOptions::default();
    let drive = recording(vec![record("", &kinematic_world(NOMINAL, 40.0), PERFECT)]);
    let (runs, set) = prepare(&drive, &how);
    let halves = split(&runs, &set.windows);
    let last = &set.windows[*halves.fitted.last().unwrap()];
    let first = &set.windows[halves.judged[0]];
    assert!(last.start + last.horizon() <= first.start);
    assert!(
        halves.fitted.len().abs_diff(halves.judged.len()) <= 1,
        "{halves:?}"
    );

    let short = recording(vec![record("", &kinematic_world(NOMINAL, 9.0), PERFECT)]);
    let (runs, set) = prepare(&short, &how);
    let halves = split(&runs, &set.windows);
    assert_eq!(
        (halves.fitted.len(), halves.judged.len()),
        (0, set.windows.len())
    );
}

#[test]
fn every_second_run_is_judged_in_the_order_of_labels() {
    let truth = kinematic_world(NOMINAL, 6.0);
    let labels = ["10", "2", "4", "1", "3"];
    let drive = recording(labels.map(|label| record(label, &truth, PERFECT)).into());
    let (runs, set) = prepare(&drive, &WindowOptions::default());
    let halves = split(&runs, &set.windows);
    let label = |k: &usize| runs[set.windows[*k].run].label.as_str();
    let mut judged: Vec<&str> = halves.judged.iter().map(label).collect();
    judged.dedup();
    // 1 2 3 4 10: the second and the fourth, in the order of the file.
    assert_eq!(judged, ["2", "4"]);
    assert_eq!(halves.fitted.len() + halves.judged.len(), set.windows.len());
}

#[test]
fn which_run_is_judged_does_not_depend_on_the_windows() {
    let run = |(label, seconds)| record(label, &kinematic_world(NOMINAL, seconds), PERFECT);
    let drive = recording([("1", 4.0), ("2", 20.0), ("3", 20.0)].map(run).into());
    let judged = |horizon: f64| -> Vec<usize> {
        let how = WindowOptions {
            horizon,
            ..WindowOptions::default()
        };
        let (runs, set) = prepare(&drive, &how);
        let mut judged: Vec<usize> = split(&runs, &set.windows)
            .judged
            .iter()
            .map(|k| set.windows[*k].run)
            .collect();
        judged.dedup();
        judged
    };
    // The first run is too short for a window of 5 s.
    assert_eq!((judged(5.0), judged(3.0)), (vec![1], vec![1]));
    // Beside a run that hardly moves, the only drive is parted.
    let drive = recording([("1", 2.0), ("2", 40.0)].map(run).into());
    let (runs, set) = prepare(&drive, &WindowOptions::default());
    let halves = split(&runs, &set.windows);
    assert!(halves.fitted.len() > 10 && halves.judged.len() > 10);
}

#[test]
fn what_is_lost_within_a_window_is_not_judged() {
    let whole = record("", &kinematic_world(NOMINAL, 40.0), PERFECT);
    let without = |channel: Channel| {
        let series = whole.series(channel).unwrap().samples();
        let kept = series.filter(|(time, _)| !(20.0..23.0).contains(time));
        recording(vec![whole.clone().with(channel, kept.collect())])
    };
    let windows = |drive: &Recording, heading| {
        let how = WindowOptions {
            heading,
            ..WindowOptions::default()
        };
        let (_, set) = prepare(drive, &how);
        let over = |window: &&PredictionWindow| window.start < 22.9 && window.start + 5.0 > 20.1;
        (
            set.windows.iter().filter(over).count(),
            set.rejected.gaps > 0,
        )
    };
    for side in [Channel::OmegaLeft, Channel::OmegaRight] {
        assert_eq!(windows(&without(side), HeadingSource::Pose), (0, true));
    }
    let gyro = without(Channel::YawRate);
    assert_eq!(windows(&gyro, HeadingSource::Gyro), (0, true));
    assert!(windows(&gyro, HeadingSource::Pose).0 > 10);
}

#[test]
fn a_clock_that_is_set_does_not_keep_the_cut_busy() {
    let whole = record("", &kinematic_world(NOMINAL, 60.0), PERFECT);
    let set = |time: f64| if time > 30.0 { time + 1.7e9 } else { time };
    let run = whole
        .channels()
        .fold(Run::new(""), |run, (channel, series)| {
            let samples = series.samples().map(|(time, value)| (set(time), value));
            run.with(channel, samples.collect())
        });
    let (_, set) = prepare(&recording(vec![run]), &WindowOptions::default());
    assert!(
        (90..105).contains(&set.windows.len()),
        "{}",
        set.windows.len()
    );
}

#[test]
fn a_gyro_is_judged_without_its_bias() {
    let biased = Sensors {
        gyro_bias: 0.15,
        ..PERFECT
    };
    let drive = recording(vec![record("", &kinematic_world(NOMINAL, 60.0), biased)]);
    let mut runs = Signals::of(&drive).unwrap();
    assert!(heading_noise(&runs).unwrap() < 0.01);
    let latencies = Latencies::estimate(&runs);
    assert!((latencies.gyro_bias - 0.15).abs() < 0.005, "{latencies:?}");
    runs.iter_mut().for_each(|run| run.remove(&latencies));
    let how = WindowOptions {
        heading: HeadingSource::Gyro,
        ..WindowOptions::default()
    };
    let set = cut("drive", &runs, &how).unwrap();
    let (position, heading) = worst(&errors(&MotionModel::Kinematics(NOMINAL), &set.windows));
    assert!(position < 0.1 && heading < 0.03, "{position} {heading}");
}

#[test]
fn a_latency_beyond_the_search_is_unknown() {
    let truth = kinematic_world(NOMINAL, 90.0);
    for (pose_latency, wheel_latency) in [(1.6, 0.1), (0.2, 0.7)] {
        let sensors = Sensors {
            pose_latency,
            wheel_latency,
            ..PERFECT
        };
        let drive = recording(vec![record("", &truth, sensors)]);
        let found = Latencies::estimate(&Signals::of(&drive).unwrap());
        let known = [found.pose, found.wheels].map(|one| one != Latency::Unknown);
        assert_eq!(
            known,
            [pose_latency < 1.0, wheel_latency < 0.5],
            "{found:?}"
        );
    }
}

#[test]
fn gyro_replaces_a_poor_heading() {
    let mut run = record("", &kinematic_world(NOMINAL, 60.0), PERFECT);
    let heading = run.series(Channel::Heading).unwrap();
    let poor = heading
        .samples()
        .map(|(t, value)| (t, value + 0.3 * (7919.0 * t).sin()))
        .collect();
    let good = heading.clone();
    run = run.with(Channel::Heading, poor);
    let runs = Signals::of(&recording(vec![run])).unwrap();
    assert!(heading_noise(&runs).unwrap() > 0.2);
    let truth = MotionModel::Kinematics(NOMINAL);
    let by = |heading| {
        let how = WindowOptions {
            heading,
            ..WindowOptions::default()
        };
        let set = cut("drive", &runs, &how).unwrap();
        worst(&errors(&truth, &set.windows))
    };
    let (pose, gyro) = (by(HeadingSource::Pose), by(HeadingSource::Gyro));
    // What is left of 0.3 rad in the median of 20 samples.
    assert!(gyro.1 < 0.01 && pose.1 > 0.2, "{pose:?} {gyro:?}");
    let tied = runs[0].tied_heading(30.0).unwrap();
    assert!((tied - good.at(30.0).unwrap()).abs() < 0.15);
}

#[test]
fn errors_of_the_heading_are_angles() {
    let drive = recording(vec![record("", &kinematic_world(NOMINAL, 6.0), PERFECT)]);
    let (_, set) = prepare(&drive, &WindowOptions::default());
    let window = &set.windows[0];
    let [x, y, heading] = window.end;
    let error = PoseError::new(window, [x + 3.0, y - 4.0, heading + 2.0 * PI - 0.1]);
    assert!((error.position - 5.0).abs() < 1e-9 && (error.heading - 0.1).abs() < 1e-9);
}

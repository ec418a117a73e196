//! What random starts say, and what the data leave open.

use super::synthetic::{QUIET, fitted, nominal, plain, record};
use ugv_terrain::fit::Options;
use ugv_terrain::fit::identifiability::Limit;
use ugv_terrain::fit::sensor::SensorParameter;

#[test]
fn random_starts_agree_on_an_easy_case() {
    let truth = nominal("sandy_loam");
    let options = Options {
        starts: 20,
        ..Options::default()
    };
    let recording = [record(&truth, 20.0, &QUIET)];
    let free = ["friction_angle", "shear_modulus"];
    let fit = fitted(&truth, &free, &recording, &options).unwrap();
    let starts = fit.starts.unwrap();
    assert_eq!((starts.tried, starts.better), (20, None));
    // Soils on which the vehicle does not get away are part of the prior.
    assert!(
        starts.agreed + starts.failed >= 19,
        "{starts:?}",
        starts = (starts.agreed, starts.failed, starts.others)
    );
    assert!(starts.agreed >= 15);
}

#[test]
fn moduli_that_one_wheel_width_cannot_tell_apart_are_named() {
    let truth = nominal("sandy_loam");
    let recording = [record(&truth, 20.0, &QUIET)];
    let free = ["cohesive_modulus", "frictional_modulus", "friction_angle"];
    let fit = fitted(&truth, &free, &recording, &plain()).unwrap();
    let untold = fit.limits.iter().any(|limit| match limit {
        Limit::Untold { parameter, .. } => parameter == "cohesive_modulus",
        Limit::Together { parameters, .. } => parameters[0] == "cohesive_modulus",
        _ => false,
    });
    assert!(untold, "{:?}", fit.limits);
    let combinations = |limit: &Limit| {
        matches!(
            limit,
            Limit::Combinations {
                told: 0..=2,
                all: 3,
                ..
            }
        )
    };
    assert!(fit.limits.iter().any(combinations), "{:?}", fit.limits);
}

#[test]
fn without_a_gyro_the_pose_is_the_clock() {
    let truth = nominal("sandy_loam");
    let mut recording = record(&truth, 20.0, &QUIET);
    let run = recording.runs.remove(0);
    recording.runs = vec![run.with(ugv_terrain::recording::Channel::YawRate, Default::default())];
    let fit = fitted(&truth, &["friction_angle"], &[recording], &plain()).unwrap();
    let sensors: Vec<_> = fit.estimates[1..]
        .iter()
        .map(|e| e.parameter.name.clone())
        .collect();
    assert_eq!(
        sensors,
        [format!("drive.{}", SensorParameter::WheelLatency.name())]
    );
}

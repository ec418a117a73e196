//! Recordings that tell nothing.

use super::synthetic::{QUIET, fitted, nominal, plain, record};
use ugv_terrain::fit::FitError;
use ugv_terrain::recording::{Channel, Recording, Run, Series};

fn refusal(recording: Recording) -> FitError {
    fitted(
        &nominal("sandy_loam"),
        &["cohesion"],
        &[recording],
        &plain(),
    )
    .unwrap_err()
}

fn with(recording: &Recording, keep: &[Channel], value: impl Fn(f64) -> f64) -> Recording {
    let run = &recording.runs[0];
    let kept = run.channels().filter(|(channel, _)| keep.contains(channel));
    let run = kept.fold(Run::new(""), |out, (channel, series)| {
        let samples = series.samples().map(|(time, v)| (time, value(v)));
        out.with(channel, samples.collect::<Series>())
    });
    Recording {
        runs: vec![run],
        ..recording.clone()
    }
}

#[test]
fn nothing_measured_is_refused() {
    let recording = record(&nominal("sandy_loam"), 10.0, &QUIET);
    let wheels = with(
        &recording,
        &[Channel::OmegaLeft, Channel::OmegaRight],
        |v| v,
    );
    let error = refusal(wheels);
    assert_eq!(
        error,
        FitError::NothingMeasured {
            recording: "drive".into()
        }
    );
}

#[test]
fn rest_is_refused() {
    let recording = record(&nominal("sandy_loam"), 10.0, &QUIET);
    assert_eq!(
        refusal(with(&recording, &Channel::ALL, |_| 0.0)),
        FitError::AtRest
    );
}

#[test]
fn two_seconds_are_refused() {
    let recording = record(&nominal("sandy_loam"), 2.0, &QUIET);
    assert!(matches!(refusal(recording), FitError::TooShort { .. }));
}

//! What the wheels did between two samples of their speeds.
//!
//! An encoder counts: what it tells is the mean over the time between two samples, and straight lines between such means
//! cut the corners. At 20 Hz a light vehicle that is steered hard errs by 17 standard deviations of a good gyro
//! over a minute, which looks like a force for some seconds. Other sensors tell the speed at a time. Both are tried.

use crate::diagnosis::hypothesis::Given;
use crate::diagnosis::hypothesis::likelihood::{Tuned, tune, tune_with_noise};
use crate::fit::problem::Weighing;
use std::sync::Arc;

/// The re-tuned model with the wheel speeds as means where the recordings are likelier so, and by how much.
#[must_use]
pub fn reconstructed<'a>(given: &Given<'a>, tuned: Tuned, by: &mut Weighing) -> (Given<'a>, Tuned) {
    let counted = counted(given);
    let Ok(fitted) = tune(&counted, &tuned.knobs, &tuned.solution, by) else {
        return (given.clone(), tuned);
    };
    let likelier = tuned.surprise - fitted.surprise;
    if likelier <= 0.0 {
        return (given.clone(), tuned);
    }
    let mut own = by.clone();
    let Ok(fitted) = tune_with_noise(&counted, &fitted.knobs, &fitted.solution, &mut own) else {
        return (given.clone(), tuned);
    };
    *by = own;
    let counted = Given {
        counted: Some(likelier),
        ..counted
    };
    (counted, fitted)
}

/// The same recordings, their wheel speeds taken as means.
fn counted<'a>(given: &Given<'a>) -> Given<'a> {
    let mut counted = given.clone();
    let mut last = None;
    for segment in &mut counted.segments {
        let run = (segment.recording, segment.run);
        let drive = match last {
            Some((before, drive)) if before == run => drive,
            _ => Arc::new(segment.drive.as_ref().clone().counted()),
        };
        segment.drive = Arc::clone(&drive);
        last = Some((run, drive));
    }
    counted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Options;
    use crate::diagnosis::hypothesis::prepare::prepare;
    use crate::diagnosis::manoeuvre::rehearsal::tests::driven;
    use crate::recording::{Channel, Recording, Series};
    use crate::terrain::Terrain;
    use crate::vehicle::{Specification, Vehicle};

    /// Seconds between two samples of the encoders.
    const INTERVAL: f64 = 0.3;

    /// The same drive with wheel speeds so many times a second, at that time or as means around it.
    fn told(recording: &Recording, means: bool) -> Recording {
        let mut told = recording.clone();
        for run in &mut told.runs {
            for channel in [Channel::OmegaLeft, Channel::OmegaRight] {
                let fine = run.series(channel).unwrap().clone();
                let end = fine.end().unwrap();
                let at = |time: f64| fine.at(time.clamp(0.0, end)).unwrap();
                let mean = |time: f64| {
                    let within =
                        (0..50).map(|k| time + INTERVAL * ((f64::from(k) + 0.5) / 50.0 - 0.5));
                    within.map(at).sum::<f64>() / 50.0
                };
                let times = (0..=(end / INTERVAL) as u32).map(|k| INTERVAL * f64::from(k));
                let sample = |time: f64| (time, if means { mean(time) } else { at(time) });
                *run = run
                    .clone()
                    .with(channel, times.map(sample).collect::<Series>());
            }
        }
        told
    }

    #[test]
    fn wheel_speeds_are_means_where_they_were_counted() {
        let soil = Terrain::preset("sandy_loam").unwrap();
        let model = Specification::plain(Vehicle::tran2007(), soil);
        let whole = driven(&model, "slalom");
        let likelier = |recording: Recording| {
            let recordings = [recording];
            let mut given = Given::new(&model, &recordings);
            let (_, mut by) = prepare(&mut given, &Options::default()).unwrap();
            let tuned = tune_with_noise(&given, &[], &given.begin(), &mut by).unwrap();
            let (found, again) = reconstructed(&given, tuned.clone(), &mut by);
            assert_eq!(
                found.counted.is_some(),
                found.segments[0].drive != given.segments[0].drive
            );
            (found.counted, again.misfit)
        };
        let (as_it_was, _) = likelier(whole.clone());
        assert!(as_it_was.is_none());
        let (counted, misfit) = likelier(told(&whole, true));
        assert!(counted.unwrap() > 20.0);
        let (sampled, more) = likelier(told(&whole, false));
        assert!(sampled.is_none() && more > misfit);
    }
}

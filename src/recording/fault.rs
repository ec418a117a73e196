//! Faults that make samples invalid as a time series.

use super::channel::Channel;
use super::run::Recording;
use super::series::Series;
use crate::display::number;
use std::collections::BTreeSet;
use thiserror::Error;

/// An invalid series in a recording. The readers never produce one, but a program that builds a recording may.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{recording}, run {run}, {channel}: {fault}")]
pub struct RecordingFault {
    /// Name of the recording.
    pub recording: String,
    /// Index of the run.
    pub run: usize,
    /// The channel.
    pub channel: Channel,
    /// The fault.
    pub fault: SeriesFault,
}

/// A fault of a series.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum SeriesFault {
    /// The numbers of times and values differ.
    #[error("{times} times for {values} values")]
    Lengths {
        /// Number of times.
        times: usize,
        /// Number of values.
        values: usize,
    },
    /// A time \[s\] that is not finite or does not increase.
    #[error("{} s is no time after the one before", number(*.0))]
    Time(f64),
    /// A value that is not finite.
    #[error("{value} at {} s is not finite", number(*.time))]
    Value {
        /// Its time \[s\].
        time: f64,
        /// The value.
        value: f64,
    },
}

impl Series {
    /// Checks that this is a time series.
    ///
    /// # Errors
    /// Unequal numbers of times and values, times that do not increase strictly, numbers that are not finite.
    pub fn check(&self) -> Result<(), SeriesFault> {
        let (times, values) = (self.time.len(), self.value.len());
        if times != values {
            return Err(SeriesFault::Lengths { times, values });
        }
        let mut before = f64::NEG_INFINITY;
        for (time, value) in self.samples() {
            if !(time.is_finite() && time > before) {
                return Err(SeriesFault::Time(time));
            }
            if !value.is_finite() {
                return Err(SeriesFault::Value { time, value });
            }
            before = time;
        }
        Ok(())
    }
}

impl Recording {
    /// Checks every channel; fits and diagnoses call this first.
    ///
    /// # Errors
    /// The first channel that is no time series.
    pub fn check(&self) -> Result<(), RecordingFault> {
        for (run, data) in self.runs.iter().enumerate() {
            for (channel, series) in data.channels() {
                series.check().map_err(|fault| RecordingFault {
                    recording: self.name.clone(),
                    run,
                    channel,
                    fault,
                })?;
            }
        }
        Ok(())
    }
}

/// Two recordings with the same name, so that messages about them would be ambiguous.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("two recordings are called {name}")]
pub struct SameName {
    /// The name.
    pub name: String,
}

/// Checks that names differ; a recording that is given twice would count twice.
///
/// # Errors
/// The first name that repeats.
pub fn different_names<'a>(names: impl IntoIterator<Item = &'a str>) -> Result<(), SameName> {
    let mut known = BTreeSet::new();
    for name in names {
        if !known.insert(name) {
            return Err(SameName { name: name.into() });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Run;

    #[test]
    fn repeated_names_are_refused() {
        assert_eq!(different_names(["a", "b"]), Ok(()));
        let error = different_names(["a", "b", "a"]).unwrap_err();
        assert_eq!(error.to_string(), "two recordings are called a");
    }

    #[test]
    fn unordered_and_lost_samples_are_refused() {
        let series = |time: &[f64], value: &[f64]| Series {
            time: time.to_vec(),
            value: value.to_vec(),
        };
        let fault = |series: Series| series.check().unwrap_err();
        assert_eq!(series(&[0.0, 1.0], &[5.0, 5.0]).check(), Ok(()));
        for again in [1.0, 0.5] {
            let found = fault(series(&[0.0, 1.0, again], &[0.0; 3]));
            assert_eq!(found, SeriesFault::Time(again));
        }
        let lost = fault(series(&[0.0, 1.0], &[0.0]));
        assert_eq!(lost.to_string(), "2 times for 1 values");
        let value = f64::INFINITY;
        let found = fault(series(&[2.0], &[value]));
        assert_eq!(found, SeriesFault::Value { time: 2.0, value });
        let run = Run::new("").with(Channel::X, series(&[1.0, 0.0], &[0.0; 2]));
        let recording = Recording {
            name: "drive".into(),
            runs: vec![Run::default(), run],
            ..Recording::default()
        };
        let found = recording.check().unwrap_err().to_string();
        assert_eq!(
            found,
            "drive, run 1, x: 0 s is no time after the one before"
        );
    }
}

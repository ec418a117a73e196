//! What makes samples no series in time.

use super::{Channel, Recording, Series};
use crate::display::number;
use std::collections::BTreeSet;
use std::fmt;

/// Samples that no reader lets pass: those of a program's own making may be so.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingFault {
    /// Name of the recording.
    pub recording: String,
    /// Place of the run.
    pub run: usize,
    /// The channel.
    pub channel: Channel,
    /// What is wrong with it.
    pub fault: SeriesFault,
}

/// What is wrong with a series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SeriesFault {
    /// Not as many values as times.
    Lengths {
        /// Number of times.
        times: usize,
        /// Number of values.
        values: usize,
    },
    /// A time \[s\] that is not after the one before, or none at all.
    Time(f64),
    /// A value that is not finite, at this time \[s\].
    Value {
        /// When.
        time: f64,
        /// The value.
        value: f64,
    },
}

impl fmt::Display for RecordingFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            recording,
            run,
            channel,
            fault,
        } = self;
        write!(f, "{recording}, run {run}, {}: {fault}", channel.name())
    }
}

impl fmt::Display for SeriesFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lengths { times, values } => write!(f, "{times} times for {values} values"),
            Self::Time(time) => write!(f, "{} s is no time after the one before", number(*time)),
            Self::Value { time, value } => {
                write!(f, "{value} at {} s is not finite", number(*time))
            }
        }
    }
}

impl std::error::Error for RecordingFault {}
impl std::error::Error for SeriesFault {}

impl Series {
    /// Refuses what is no series in time.
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
    /// Refuses what no reader lets pass; fits and diagnoses ask for it first.
    ///
    /// # Errors
    /// The first channel that is no series in time.
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

/// Two recordings of one name: what is said of one of them names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SameName {
    /// The name.
    pub name: String,
}

impl fmt::Display for SameName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "two recordings are called {}", self.name)
    }
}

impl std::error::Error for SameName {}

/// Refuses recordings of one name, a recording that is given twice among them: it would count twice.
///
/// # Errors
/// The first name that comes again.
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
    fn names_that_come_again_are_told() {
        assert_eq!(different_names(["a", "b"]), Ok(()));
        let error = different_names(["a", "b", "a"]).unwrap_err();
        assert_eq!(error.to_string(), "two recordings are called a");
    }

    #[test]
    fn samples_out_of_order_or_lost_are_told() {
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

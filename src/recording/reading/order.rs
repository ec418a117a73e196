//! Times that repeat or run backwards.

use crate::recording::csv::{Samples, malformed};
use crate::recording::{Channel, CsvError};

/// Refuses times of a channel that do not increase.
pub fn check(samples: &Samples) -> Result<(), CsvError> {
    for run in &samples.runs {
        for channel in Channel::ALL {
            let backward = run.channels[channel.index()]
                .windows(2)
                .find(|pair| pair[1].time <= pair[0].time);
            if let Some(pair) = backward {
                let expected = format!("a time later than {} s", pair[0].time);
                let found = format!("{}", pair[1].time);
                return Err(malformed(samples.time_cell(pair[1].line), found, expected));
            }
        }
    }
    Ok(())
}

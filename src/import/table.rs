//! The recording as CSV.

use super::columns::Column;
use csv::{Terminator, WriterBuilder};
use std::io::{self, Write};

/// Writes a row for every time at which any column has a sample, and returns their number.
/// Times count from `start` \[ns\]; the other cells of a row stay empty.
pub(super) fn write(columns: &[Column], start: i64, to: impl Write) -> io::Result<u64> {
    let mut writer = WriterBuilder::new()
        .terminator(Terminator::Any(b'\n'))
        .from_writer(to);
    writer.write_field("time")?;
    for column in columns {
        writer.write_field(column.name)?;
    }
    writer.write_record(None::<&[u8]>)?;
    let mut places = vec![0; columns.len()];
    let mut rows = 0;
    loop {
        let next = columns
            .iter()
            .zip(&places)
            .map(|(column, place)| column.samples.get(*place));
        let Some(now) = next.flatten().map(|(time, _)| *time).min() else {
            break;
        };
        writer.write_field(seconds(now - start))?;
        for (column, place) in columns.iter().zip(&mut places) {
            match column.samples.get(*place) {
                Some((time, value)) if *time == now => {
                    // Writes -0 as 0.
                    writer.write_field(format!("{:?}", value + 0.0))?;
                    *place += 1;
                }
                _ => writer.write_field("")?,
            }
        }
        writer.write_record(None::<&[u8]>)?;
        rows += 1;
    }
    writer.flush()?;
    Ok(rows)
}

/// Nanoseconds as seconds, to the last digit.
pub(super) fn seconds(nanoseconds: i64) -> String {
    let sign = if nanoseconds < 0 { "-" } else { "" };
    let (whole, rest) = (
        nanoseconds.unsigned_abs() / 1_000_000_000,
        nanoseconds.unsigned_abs() % 1_000_000_000,
    );
    let digits = format!("{sign}{whole}.{rest:09}");
    digits
        .trim_end_matches('0')
        .trim_end_matches('.')
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Channel;

    fn column(channel: Channel, samples: &[(i64, f64)]) -> Column {
        Column {
            channel: Some(channel),
            name: channel.name(),
            unit: channel.unit(),
            topic: String::new(),
            conversion: String::new(),
            samples: samples.to_vec(),
        }
    }

    #[test]
    fn rows_are_the_union_of_times() {
        let columns = [
            column(Channel::OmegaLeft, &[(1_000, 0.1), (2_000, -0.0)]),
            column(
                Channel::X,
                &[(1_500, 1e-9), (2_000, 3.0), (1_000_001_000, 4.0)],
            ),
        ];
        let mut text = Vec::new();
        assert_eq!(write(&columns, 1_000, &mut text).unwrap(), 4);
        let expected = "time,omega_left,x\n0,0.1,\n0.0000005,,1e-9\n0.000001,0.0,3.0\n1,,4.0\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }

    #[test]
    fn seconds_keep_every_nanosecond() {
        assert_eq!(seconds(0), "0");
        assert_eq!(seconds(10_000_000_000), "10");
        assert_eq!(seconds(1_700_000_000_123_456_789), "1700000000.123456789");
        assert_eq!(seconds(-1_500_000_000), "-1.5");
    }
}

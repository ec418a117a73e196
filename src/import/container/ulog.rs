//! The log of PX4: ULog (docs.px4.io/main/en/dev_log/ulog_file_format.html), records of a size, a type and data. Formats
//! name the fields of messages, subscriptions give a topic its number, and messages have that number.
//!
//! The crate `px4-ulog` 0.6.1 expands every field of every format in memory before the first message: a file of 12 kB
//! takes 2.3 GB. Its errors have no place in the file. So it is not used.

use super::input::{
    BLOCK, CUT, Connection, Ending, Input, LONGEST_NAME, ReadProgress, Stop, Visit, broken,
};
use crate::display::shortened;
use crate::import::error::ImportError;
use crate::import::px4;
use std::collections::HashMap;
use std::rc::Rc;

pub(super) const MAGIC: &[u8] = b"ULog\x01\x12\x35";
/// Length of the file's header, and of a record's \[bytes\].
const HEADER: usize = 16;
const RECORD_HEADER: usize = 3;
/// Latest valid time, of 2116 \[ns\]; differences of times stay within 64 bits.
const LATEST: u64 = i64::MAX as u64 / 2;

/// Record types that are read.
mod op {
    pub const FLAGS: u8 = b'B';
    pub const FORMAT: u8 = b'F';
    pub const SUBSCRIPTION: u8 = b'A';
    pub const UNSUBSCRIPTION: u8 = b'R';
    pub const MESSAGE: u8 = b'D';
    pub const ALL: [u8; 5] = [FLAGS, FORMAT, SUBSCRIPTION, UNSUBSCRIPTION, MESSAGE];
}

/// Visits every message. That of a topic that the import knows consists of its time of measurement \[ns\] and the fields of
/// its layout, 64 bits each; that of another topic is empty.
pub(super) fn read(
    mut input: Input,
    progress: &mut ReadProgress,
    visit: &mut Visit,
) -> Result<Ending, ImportError> {
    let mut log = Log::default();
    let mut reported = 0;
    loop {
        let offset = input.place;
        match log.next(&mut input, visit) {
            Ok(true) => {}
            Ok(false) => return Ok(Ending::Whole),
            Err(Stop::Refused(error)) => return Err(error),
            Err(Stop::Broken(reason)) => {
                let place = format!("at byte {offset}");
                return Ok(Ending::Broken { place, reason });
            }
        }
        if input.place >= reported + BLOCK as u64 {
            reported = input.place;
            progress(input.place, input.length);
        }
    }
}

/// What was defined so far.
#[derive(Default)]
struct Log {
    formats: HashMap<String, Rc<Format>>,
    topics: HashMap<u16, Subscription>,
    /// Where data that were appended later begin, such as those of a crash. The record before may be cut off.
    appended: Vec<u64>,
    /// Time of the last message \[ns\].
    time: u64,
    /// Memory that every record reuses.
    data: Vec<u8>,
    fields: Vec<u8>,
}

struct Subscription {
    connection: Connection,
    format: Rc<Format>,
}

impl Log {
    /// Reads a record; false at the end of the file.
    fn next(&mut self, input: &mut Input, visit: &mut Visit) -> Result<bool, Stop> {
        if input.place == 0 {
            let mut header = [0; HEADER];
            return match input.read(&mut header)? {
                HEADER => Ok(true),
                _ => broken("the file ends in its header"),
            };
        }
        let end = self.appended.first().copied().unwrap_or(input.length);
        let remaining = end.saturating_sub(input.place);
        if remaining == 0 {
            let is_end = self.appended.is_empty();
            self.appended.drain(..1.min(self.appended.len()));
            return Ok(!is_end);
        }
        let mut header = [0; RECORD_HEADER];
        if remaining < RECORD_HEADER as u64 {
            return self.cut(input, remaining);
        }
        if input.read(&mut header)? < RECORD_HEADER {
            return broken(CUT);
        }
        let (size, op) = (u16::from_le_bytes([header[0], header[1]]), header[2]);
        // Later versions may have other types, all of them letters.
        if !op.is_ascii_uppercase() {
            return broken(format!("a record has the type {op:#04x}, which is none"));
        }
        let remaining = remaining - RECORD_HEADER as u64;
        if u64::from(size) > remaining {
            return self.cut(input, remaining);
        }
        if !op::ALL.contains(&op) {
            input.skip(u32::from(size))?;
            return Ok(true);
        }
        let mut data = std::mem::take(&mut self.data);
        data.resize(usize::from(size), 0);
        let length = input.read(&mut data)?;
        let taken = if length < data.len() {
            broken(CUT)
        } else {
            self.take(op, &data, input, visit)
        };
        self.data = data;
        taken.map(|()| true)
    }

    /// Passes over a record that was cut off, if others were appended behind it.
    fn cut(&self, input: &mut Input, remaining: u64) -> Result<bool, Stop> {
        if self.appended.is_empty() {
            return broken(CUT);
        }
        // No more than the size of a record.
        input.skip(remaining as u32)?;
        Ok(true)
    }

    fn take(&mut self, op: u8, data: &[u8], input: &Input, visit: &mut Visit) -> Result<(), Stop> {
        match op {
            op::FLAGS => self.flags(data, input),
            op::FORMAT => {
                let parsed = std::str::from_utf8(data).ok().and_then(|text| {
                    let (name, fields) = text.split_once(':')?;
                    let is_name = !name.is_empty() && name.len() <= LONGEST_NAME;
                    Some((name, Format::parse(name, fields).filter(|_| is_name)?))
                });
                let Some((name, format)) = parsed else {
                    return broken("a format does not parse");
                };
                self.formats.insert(name.into(), Rc::new(format));
                Ok(())
            }
            op::SUBSCRIPTION => self.subscribe(data),
            op::UNSUBSCRIPTION => {
                if let Some((number, _)) = number(data) {
                    self.topics.remove(&number);
                }
                Ok(())
            }
            _ => self.message(data, visit),
        }
    }

    fn flags(&mut self, data: &[u8], input: &Input) -> Result<(), Stop> {
        let Some((incompatible, offsets)) = data.get(8..16).zip(data.get(16..40)) else {
            return broken("its flags are too short");
        };
        // The first bit stands for appended data.
        if incompatible[0] > 1 || incompatible[1..].iter().any(|flag| *flag != 0) {
            return broken("its flags demand what this version of ULog does not have");
        }
        let offsets = offsets.chunks_exact(8).map(integer);
        self.appended = offsets
            .filter(|offset| *offset > input.place && *offset < input.length)
            .collect();
        if incompatible[0] == 0 {
            self.appended.clear();
        }
        if !self.appended.is_sorted() {
            return broken("its appended data are out of order");
        }
        Ok(())
    }

    fn subscribe(&mut self, data: &[u8]) -> Result<(), Stop> {
        let parsed = data.split_first().and_then(|(instance, rest)| {
            let (id, name) = number(rest)?;
            let name = std::str::from_utf8(name).ok()?;
            (name.len() <= LONGEST_NAME).then_some((*instance, id, name))
        });
        let Some((instance, id, name)) = parsed else {
            return broken("a subscription does not parse");
        };
        let Some(format) = self.formats.get(name) else {
            return broken(format!("the topic {} has no format", shortened(name)));
        };
        let topic = match instance {
            0 => name.to_owned(),
            other => format!("{name}/{other}"),
        };
        let connection = Connection {
            topic,
            message_type: px4::layout(name).map_or(name, |layout| layout.name).into(),
            encoding: "ulog".into(),
        };
        let format = Rc::clone(format);
        self.topics.insert(id, Subscription { connection, format });
        Ok(())
    }

    fn message(&mut self, data: &[u8], visit: &mut Visit) -> Result<(), Stop> {
        let topic = number(data).and_then(|(id, _)| self.topics.get(&id));
        let Some(Subscription { connection, format }) = topic else {
            return broken("a message belongs to no topic");
        };
        if let Some([min, max]) = format.length
            && !(min..=max).contains(&data.len())
        {
            let name = shortened(&connection.topic);
            let length = data.len();
            return broken(format!(
                "a message of {name} has {length} bytes, its format {max}"
            ));
        }
        let time = |place: Option<usize>| {
            let micros = integer(data.get(place?..)?.get(..8)?);
            Some(micros.saturating_mul(1000).min(LATEST))
        };
        self.time = time(format.logged).unwrap_or(self.time);
        let measured = time(format.measured).filter(|time| *time != 0);
        self.fields.clear();
        if !format.fields.is_empty() {
            let measured = measured.unwrap_or(self.time);
            self.fields.extend(measured.to_le_bytes());
        }
        for field in &format.fields {
            let value = match field {
                None => f64::NAN,
                Some((place, number)) => {
                    match data.get(*place..).and_then(|rest| number.read(rest)) {
                        Some(value) => value,
                        None => return broken("a message ends before its fields do"),
                    }
                }
            };
            self.fields.extend(value.to_le_bytes());
        }
        visit(connection, self.time as i64, &self.fields)?;
        Ok(())
    }
}

/// The 16 bits at the start, and what follows.
fn number(data: &[u8]) -> Option<(u16, &[u8])> {
    let (number, rest) = data.split_first_chunk()?;
    Some((u16::from_le_bytes(*number), rest))
}

/// Up to eight bytes, the least significant first.
fn integer(bytes: &[u8]) -> u64 {
    let bytes = bytes.iter().rev();
    bytes.fold(0, |value, byte| value << 8 | u64::from(*byte))
}

/// A basic type.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Number {
    Unsigned(usize),
    Signed(usize),
    Float,
    Double,
}

impl Number {
    fn of_name(name: &str) -> Option<Self> {
        Some(match name {
            "uint8_t" | "bool" | "char" => Self::Unsigned(1),
            "uint16_t" => Self::Unsigned(2),
            "uint32_t" => Self::Unsigned(4),
            "uint64_t" => Self::Unsigned(8),
            "int8_t" => Self::Signed(1),
            "int16_t" => Self::Signed(2),
            "int32_t" => Self::Signed(4),
            "int64_t" => Self::Signed(8),
            "float" => Self::Float,
            "double" => Self::Double,
            _ => return None,
        })
    }

    /// Its length \[bytes\].
    fn length(self) -> usize {
        match self {
            Self::Unsigned(length) | Self::Signed(length) => length,
            Self::Float => 4,
            Self::Double => 8,
        }
    }

    fn read(self, bytes: &[u8]) -> Option<f64> {
        let value = integer(bytes.get(..self.length())?);
        Some(match self {
            Self::Unsigned(_) => value as f64,
            Self::Signed(length) => {
                let unused = 64 - 8 * length as u32;
                ((value << unused) as i64 >> unused) as f64
            }
            Self::Float => f32::from_bits(value as u32).into(),
            Self::Double => f64::from_bits(value),
        })
    }
}

/// Where a message has what is read. Counted from its start, which is the number of its topic.
#[derive(Debug, Default, PartialEq)]
struct Format {
    /// Time of logging, and time of measurement.
    logged: Option<usize>,
    measured: Option<usize>,
    /// The fields of the layout; `None` for missing ones.
    fields: Vec<Option<(usize, Number)>>,
    /// Its length without and with padding at the end \[bytes\]; `None` if it has nested formats.
    length: Option<[usize; 2]>,
}

impl Format {
    /// Of the fields `type name;` or `type[length] name;`. Fields behind a nested format are not found.
    fn parse(name: &str, fields: &str) -> Option<Self> {
        let wanted = px4::layout(name).map_or(&[][..], |layout| layout.fields);
        let mut format = Self {
            fields: vec![None; wanted.len()],
            ..Self::default()
        };
        let mut place = size_of::<u16>();
        for field in fields.split(';').filter(|field| !field.is_empty()) {
            let (kind, name) = field.split_once(' ')?;
            let (kind, count) = match kind.split_once('[') {
                Some((kind, count)) => (kind, count.strip_suffix(']')?.parse::<u16>().ok()?),
                None => (kind, 1),
            };
            let Some(number) = Number::of_name(kind) else {
                format.length = None;
                return Some(format);
            };
            let time = match name {
                "timestamp" => Some(&mut format.logged),
                "timestamp_sample" => Some(&mut format.measured),
                _ => None,
            };
            if let Some(time) = time
                && number == Number::Unsigned(8)
            {
                *time = Some(place);
            }
            for (wanted, found) in wanted.iter().zip(&mut format.fields) {
                let (wanted, index) = element(wanted);
                if wanted == name && index < usize::from(count) {
                    *found = Some((place + index * number.length(), number));
                }
            }
            let before = place;
            place += usize::from(count) * number.length();
            // The last one may be left out.
            let min = if name.starts_with("_padding") {
                before
            } else {
                place
            };
            format.length = Some([min, place]);
        }
        Some(format)
    }
}

/// The field and the place within it: `q[1]`, or 0 for `x`.
fn element(field: &str) -> (&str, usize) {
    let split = field.split_once('[');
    let index = split.and_then(|(_, index)| index.strip_suffix(']')?.parse().ok());
    (split.map_or(field, |(name, _)| name), index.unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_parsed() {
        let text =
            "uint64_t timestamp;uint64_t timestamp_sample;float[3] xyz;uint8_t[4] _padding0;";
        let format = Format::parse("vehicle_angular_velocity", text).unwrap();
        let float = |place| Some((place, Number::Float));
        let expected = Format {
            logged: Some(2),
            measured: Some(10),
            fields: vec![float(18), float(22), float(26)],
            length: Some([30, 34]),
        };
        assert_eq!(format, expected);
        // Behind a nested format no place is known.
        let nested = Format::parse(
            "vehicle_angular_velocity",
            "uint64_t timestamp;part p;float[3] xyz;",
        );
        let nested = nested.unwrap();
        assert_eq!((nested.logged, nested.length), (Some(2), None));
        assert_eq!(nested.fields, [None; 3]);
        for wrong in ["float", "float[ x", "float[-1] x", "float[70000] x"] {
            assert_eq!(Format::parse("a", wrong), None, "{wrong}");
        }
    }

    #[test]
    fn numbers_of_every_type_are_read() {
        let minus_two = (-2_i64).to_le_bytes();
        for (name, bytes, expected) in [
            ("int8_t", &minus_two[..], -2.0),
            ("int16_t", &minus_two[..], -2.0),
            ("int32_t", &minus_two[..], -2.0),
            ("int64_t", &minus_two[..], -2.0),
            ("uint16_t", &minus_two[..], 65534.0),
            ("bool", &[1][..], 1.0),
            ("float", &1.5_f32.to_le_bytes()[..], 1.5),
            ("double", &0.1_f64.to_le_bytes()[..], 0.1),
        ] {
            let number = Number::of_name(name).unwrap();
            assert_eq!(number.read(bytes), Some(expected), "{name}");
            assert_eq!(number.read(&bytes[..number.length() - 1]), None, "{name}");
        }
    }
}

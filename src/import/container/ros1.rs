//! The bag of ROS 1, version 2.0 (wiki.ros.org/Bags/Format/2.0): records of a header, whose fields are `name=value`, and
//! data. Chunks contain topics ("connections") and messages; tables of contents stand between and after them.
//!
//! The crate `rosbag` maps the file into memory and panics if a bag is truncated or was never closed, so it is not used.

use super::input::{
    CUT, Connection, Ending, Input, LONGEST_NAME, ReadProgress, Stop, Visit, broken,
};
use crate::display::shortened;
use crate::import::error::ImportError;
use std::collections::HashMap;
use std::io::{self, Read};

pub(super) const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

/// Record types that are read; the others are tables of contents.
mod op {
    pub const MESSAGE: u8 = 0x02;
    pub const BAG_HEADER: u8 = 0x03;
    pub const CHUNK: u8 = 0x05;
    pub const CONNECTION: u8 = 0x07;
    pub const ALL: [u8; 4] = [MESSAGE, BAG_HEADER, CHUNK, CONNECTION];
}

/// Visits every message.
pub(super) fn read(
    mut input: Input,
    progress: &mut ReadProgress,
    visit: &mut Visit,
) -> Result<Ending, ImportError> {
    input.skip(MAGIC.len() as u32)?;
    let mut bag = Bag::default();
    let mut record = Buffers::default();
    // Tables of contents follow the messages.
    while bag.index.is_none_or(|index| input.place < index) {
        let offset = input.place;
        match bag.next(&mut input, &mut record, visit) {
            Ok(()) => progress(input.place, input.length),
            Err(Stop::Refused(error)) => return Err(error),
            Err(Stop::Broken(reason)) => {
                let place = format!("near byte {offset}");
                return Ok(Ending::Broken { place, reason });
            }
        }
    }
    Ok(Ending::Whole)
}

/// Memory that every record reuses.
#[derive(Default)]
struct Buffers {
    header: Vec<u8>,
    data: Vec<u8>,
    unpacked: Vec<u8>,
}

/// The topics so far.
#[derive(Default)]
struct Bag {
    channels: HashMap<u32, Connection>,
    /// Start of the tables of contents; `u64::MAX` in a bag that was never closed.
    index: Option<u64>,
}

impl Bag {
    /// Reads a record.
    fn next(
        &mut self,
        input: &mut Input,
        buffers: &mut Buffers,
        visit: &mut Visit,
    ) -> Result<(), Stop> {
        if input.remaining() == 0 && self.index == Some(u64::MAX) {
            return broken("the bag was never closed: its table of contents is missing");
        }
        let length = length(input)?;
        fill(input, &mut buffers.header, length)?;
        let fields = Fields(&buffers.header);
        let op = fields.op()?;
        let length = self::length(input)?;
        if !op::ALL.contains(&op) {
            return Ok(input.skip(length)?);
        }
        fill(input, &mut buffers.data, length)?;
        match op {
            op::BAG_HEADER => {
                let index = fields.u64("index_pos")?;
                self.index = Some(if index == 0 { u64::MAX } else { index });
                Ok(())
            }
            op::CHUNK => {
                let mut rest = unpack(
                    &fields,
                    input.largest(),
                    &buffers.data,
                    &mut buffers.unpacked,
                )?;
                while !rest.is_empty() {
                    let header = cut(&mut rest)?;
                    let data = cut(&mut rest)?;
                    self.take(&Fields(header), data, visit)?;
                }
                Ok(())
            }
            _ => self.take(&fields, &buffers.data, visit),
        }
    }

    /// Registers a topic, or visits a message.
    fn take(&mut self, fields: &Fields, data: &[u8], visit: &mut Visit) -> Result<(), Stop> {
        match fields.op()? {
            op::CONNECTION => {
                let channel = Connection {
                    topic: fields.text("topic")?,
                    message_type: Fields(data).text("type")?,
                    encoding: "ros1".into(),
                };
                self.channels.insert(fields.u32("conn")?, channel);
            }
            op::MESSAGE => {
                let Some(channel) = self.channels.get(&fields.u32("conn")?) else {
                    return broken("a message belongs to no topic");
                };
                // Seconds, then nanoseconds.
                let time = fields.u64("time")?;
                let (seconds, nanoseconds) = (time & 0xffff_ffff, time >> 32);
                let time = seconds * 1_000_000_000 + nanoseconds;
                visit(channel, time as i64, data)?;
            }
            _ => {}
        }
        Ok(())
    }
}

fn length(input: &mut Input) -> Result<u32, Stop> {
    let mut bytes = [0; 4];
    if input.read(&mut bytes)? < bytes.len() {
        return broken(CUT);
    }
    let length = u32::from_le_bytes(bytes);
    // The length of a damaged record is arbitrary.
    if u64::from(length) > input.remaining() {
        return broken(CUT);
    }
    Ok(length)
}

fn fill(input: &mut Input, buffer: &mut Vec<u8>, length: u32) -> Result<(), Stop> {
    buffer.resize(length as usize, 0);
    if input.read(buffer)? < buffer.len() {
        return broken(CUT);
    }
    Ok(())
}

/// The next bytes of a chunk, after their length.
fn cut<'a>(rest: &mut &'a [u8]) -> Result<&'a [u8], Stop> {
    let split = rest.split_first_chunk().and_then(|(length, behind)| {
        let length = u32::from_le_bytes(*length) as usize;
        behind.split_at_checked(length)
    });
    let Some((bytes, behind)) = split else {
        return broken("a chunk ends in the middle of a record");
    };
    *rest = behind;
    Ok(bytes)
}

/// The content of a chunk.
fn unpack<'a>(
    fields: &Fields,
    largest: u64,
    packed: &'a [u8],
    unpacked: &'a mut Vec<u8>,
) -> Result<&'a [u8], Stop> {
    let size = u64::from(fields.u32("size")?);
    if size > largest {
        return broken(format!(
            "a chunk that unpacks to {size} bytes is larger than any recorder writes in such a file"
        ));
    }
    let compression = fields.text("compression")?;
    // One more byte reveals a chunk that is longer than stated.
    let mut all = |from: &mut dyn Read| -> io::Result<usize> {
        unpacked.clear();
        from.take(size + 1).read_to_end(unpacked)
    };
    let done = match compression.as_str() {
        "none" => return Ok(packed),
        "bz2" => all(&mut bzip2::read::BzDecoder::new(packed)),
        "lz4" => lz4::Decoder::new(packed).and_then(|mut decoder| all(&mut decoder)),
        other => {
            let other = shortened(other);
            return broken(format!("chunks compressed with `{other}` cannot be read"));
        }
    };
    match done {
        Ok(length) if length as u64 == size => Ok(unpacked),
        Ok(_) => broken(format!("a chunk does not unpack to its {size} bytes")),
        Err(error) => broken(format!("a chunk does not unpack: {error}")),
    }
}

/// The header of a record: fields `name=value`, each after its length.
struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn get(&self, name: &str) -> Result<&'a [u8], Stop> {
        let mut rest = self.0;
        while !rest.is_empty() {
            let field = cut(&mut rest)?;
            let value = field.strip_prefix(name.as_bytes());
            if let Some(value) = value.and_then(|value| value.strip_prefix(b"=")) {
                return Ok(value);
            }
        }
        broken(format!("a record lacks its field `{name}`"))
    }

    fn number<const N: usize>(&self, name: &str) -> Result<[u8; N], Stop> {
        let value = self.get(name)?.try_into();
        value.or_else(|_| broken(format!("the field `{name}` of a record is no number")))
    }

    fn op(&self) -> Result<u8, Stop> {
        self.number("op").map(|[op]| op)
    }

    fn u32(&self, name: &str) -> Result<u32, Stop> {
        self.number(name).map(u32::from_le_bytes)
    }

    fn u64(&self, name: &str) -> Result<u64, Stop> {
        self.number(name).map(u64::from_le_bytes)
    }

    fn text(&self, name: &str) -> Result<String, Stop> {
        let value = self.get(name)?;
        if value.len() > LONGEST_NAME {
            return broken(format!(
                "the field `{name}` of a record has {} bytes",
                value.len()
            ));
        }
        Ok(String::from_utf8_lossy(value).into_owned())
    }
}

//! MCAP, by the format's crate.

use super::input::{BLOCK, Connection, Ending, Input, LONGEST_NAME, ReadProgress, Visit};
use crate::import::error::ImportError;
use mcap::McapError;
use mcap::records::op;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::HashMap;

/// Latest valid log time, of 2116 \[ns\]; differences of times stay within 64 bits.
const LATEST: u64 = i64::MAX as u64 / 2;

/// Visits every message; the summary at the end is not needed.
pub(super) fn read(
    mut input: Input,
    progress: &mut ReadProgress,
    visit: &mut Visit,
) -> Result<Ending, ImportError> {
    // A chunk is checked before its messages are visited.
    let options = LinearReaderOptions::default()
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(input.largest() as usize);
    let mut reader = LinearReader::new_with_options(options);
    let mut channels = Channels::default();
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(wanted)) => {
                // Limited by the file: the length of a damaged record is arbitrary.
                let wanted = (wanted.max(BLOCK) as u64).min(input.remaining()) as usize;
                let bytes = input.read(reader.insert(wanted))?;
                reader.notify_read(bytes);
                progress(input.place, input.length);
            }
            // Only tables of contents follow.
            Ok(LinearReadEvent::Record {
                opcode: op::DATA_END,
                ..
            }) => return Ok(Ending::Whole),
            Ok(LinearReadEvent::Record { opcode, data }) => match channels.take(opcode, data) {
                Ok(Some((channel, log_time, data))) => visit(channel, log_time, data)?,
                Ok(None) => {}
                Err(reason) => return Ok(broken(&input, reason)),
            },
            Err(error) => return Ok(broken(&input, describe(&error))),
        }
    }
    Ok(Ending::Whole)
}

fn broken(input: &Input, reason: String) -> Ending {
    Ending::Broken {
        place: format!("near byte {}", input.place),
        reason,
    }
}

fn describe(error: &McapError) -> String {
    match error {
        McapError::UnexpectedEof => "the file ends in the middle".into(),
        McapError::Parse(_) => UNREADABLE.into(),
        McapError::Io(source) => format!("a chunk does not unpack: {source}"),
        other => other.to_string(),
    }
}

const UNREADABLE: &str = "a record does not parse";

/// The topics so far.
#[derive(Default)]
struct Channels {
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Connection>,
}

type Message<'c, 'd> = (&'c Connection, i64, &'d [u8]);

impl Channels {
    /// Registers a topic, or returns a message.
    fn take<'d>(&mut self, opcode: u8, data: &'d [u8]) -> Result<Option<Message<'_, 'd>>, String> {
        self.read(opcode, Fields(data))
            .ok_or_else(|| UNREADABLE.to_owned())?
            .map(|(id, time, data)| {
                let channel = self.channels.get(&id);
                let channel = channel.ok_or("a message belongs to no topic")?;
                Ok((channel, time.min(LATEST) as i64, data))
            })
            .transpose()
    }

    /// As [`Channels::take`], with the id of the message's channel; `None` if the record is damaged.
    fn read<'d>(
        &mut self,
        opcode: u8,
        mut fields: Fields<'d>,
    ) -> Option<Option<(u16, u64, &'d [u8])>> {
        match opcode {
            // No record has this code, but space that a crash left unwritten has.
            0 => return None,
            op::SCHEMA => {
                let (id, name) = (fields.u16()?, fields.text()?);
                self.schemas.insert(id, name);
            }
            op::CHANNEL => {
                let (id, schema) = (fields.u16()?, fields.u16()?);
                let known = Connection {
                    topic: fields.text()?,
                    message_type: self.schemas.get(&schema).cloned().unwrap_or_default(),
                    encoding: fields.text()?,
                };
                self.channels.insert(id, known);
            }
            op::MESSAGE => {
                let (id, _sequence) = (fields.u16()?, fields.u32()?);
                let (log_time, _publish_time) = (fields.u64()?, fields.u64()?);
                return Some(Some((id, log_time, fields.0)));
            }
            _ => {}
        }
        Some(None)
    }
}

/// The unread part of a record. The format's crate allocates the stated length of a text before it checks the length, and
/// a damaged length is arbitrary.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn number<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (number, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*number)
    }

    fn u16(&mut self) -> Option<u16> {
        self.number().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.number().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.number().map(u64::from_le_bytes)
    }

    fn text(&mut self) -> Option<String> {
        let length = self.u32().map(|length| length as usize);
        let length = length.filter(|length| *length <= LONGEST_NAME)?;
        let (text, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        String::from_utf8(text.to_vec()).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A schema with id 1, its channel with id 2, and a message.
    const RECORDS: [(u8, &[u8]); 3] = [
        (op::SCHEMA, b"\x01\0\x04\0\0\0type\0\0\0\0\0\0\0\0"),
        (
            op::CHANNEL,
            b"\x02\0\x01\0\x05\0\0\0topic\x03\0\0\0cdr\0\0\0\0",
        ),
        (
            op::MESSAGE,
            b"\x02\0\x07\0\0\0\x09\0\0\0\0\0\0\0\x08\0\0\0\0\0\0\0data",
        ),
    ];

    #[test]
    fn records_are_parsed() {
        let mut channels = Channels::default();
        for (opcode, data) in &RECORDS[..2] {
            assert_eq!(channels.take(*opcode, data), Ok(None));
        }
        let channel = Connection {
            topic: "topic".into(),
            message_type: "type".into(),
            encoding: "cdr".into(),
        };
        let message = channels.take(RECORDS[2].0, RECORDS[2].1);
        assert_eq!(message, Ok(Some((&channel, 9, &b"data"[..]))));
        let mut empty = Channels::default();
        let nowhere = empty.take(RECORDS[2].0, RECORDS[2].1);
        assert!(nowhere.unwrap_err().contains("no topic"));
    }

    fn refused(opcode: u8, data: &[u8]) -> bool {
        Channels::default().take(opcode, data) == Err(UNREADABLE.to_owned())
    }

    #[test]
    fn truncated_records_and_wrong_lengths_take_no_memory() {
        for (opcode, data) in RECORDS {
            for length in 0..8 {
                assert!(refused(opcode, &data[..length]), "{opcode} {length}");
            }
        }
        for (opcode, place) in [(op::SCHEMA, 2), (op::CHANNEL, 4)] {
            let (_, data) = RECORDS.iter().find(|(other, _)| *other == opcode).unwrap();
            let mut damaged = data.to_vec();
            damaged[place..place + 4].fill(0xff);
            let used = allocation_counter::measure(|| assert!(refused(opcode, &damaged)));
            assert!(used.bytes_max < 10_000, "{used:?}");
        }
    }
}

//! MCAP, through the format's own crate.

use super::{BLOCK, Channel, Ending, Input, Progress, Visit};
use crate::import::ImportError;
use mcap::McapError;
use mcap::parse_record;
use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::HashMap;

/// A record or chunk larger than this is a damaged length, not a message \[bytes\].
const LARGEST_RECORD: usize = 1 << 30;

/// Log times later than this, of 2116, are damage; differences of times stay within 64 bits \[ns\].
const LATEST: u64 = i64::MAX as u64 / 2;

/// Shows every message; the summary at the end is not needed.
pub(super) fn read(
    mut input: Input,
    progress: &mut Progress,
    visit: &mut Visit,
) -> Result<Ending, ImportError> {
    // A chunk is checked before its messages are shown.
    let options = LinearReaderOptions::default()
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(LARGEST_RECORD);
    let mut reader = LinearReader::new_with_options(options);
    let mut channels = Channels::default();
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(wanted)) => {
                // No more than there is: the length of a damaged record may be anything.
                let wanted = (wanted.max(BLOCK) as u64).min(input.left()) as usize;
                let bytes = input.read(reader.insert(wanted))?;
                reader.notify_read(bytes);
                progress(input.place, input.length);
            }
            // What follows are the tables of contents.
            Ok(LinearReadEvent::Record {
                opcode: op::DATA_END,
                ..
            }) => return Ok(Ending::Whole),
            Ok(LinearReadEvent::Record { opcode, data }) => match channels.take(opcode, data) {
                Ok(Some((channel, log_time, data))) => visit(channel, log_time, &data)?,
                Ok(None) => {}
                Err(error) => return Ok(broken(&input, &error)),
            },
            Err(error) => return Ok(broken(&input, &error)),
        }
    }
    Ok(Ending::Whole)
}

fn broken(input: &Input, error: &McapError) -> Ending {
    let reason = match error {
        McapError::UnexpectedEof => "the file ends in the middle".into(),
        McapError::Parse(_) => "a record does not parse".into(),
        McapError::Io(source) => format!("a chunk does not unpack: {source}"),
        other => other.to_string(),
    };
    Ending::Broken {
        offset: input.place,
        reason,
    }
}

/// What the file has said so far about its topics.
#[derive(Default)]
struct Channels {
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Channel>,
}

type Shown<'c, 'd> = (&'c Channel, i64, std::borrow::Cow<'d, [u8]>);

impl Channels {
    /// Learns from a record, or returns it if it is a message.
    fn take<'d>(&mut self, opcode: u8, data: &'d [u8]) -> Result<Option<Shown<'_, 'd>>, McapError> {
        match parse_record(opcode, data)? {
            Record::Schema { header, .. } => {
                self.schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) => {
                let message_type = self.schemas.get(&channel.schema_id);
                let known = Channel {
                    topic: channel.topic,
                    message_type: message_type.cloned().unwrap_or_default(),
                    encoding: channel.message_encoding,
                };
                self.channels.insert(channel.id, known);
            }
            Record::Message { header, data } => {
                let id = header.channel_id;
                let channel = self.channels.get(&id);
                let channel = channel.ok_or(McapError::UnknownChannel(header.sequence, id))?;
                let time = header.log_time.min(LATEST) as i64;
                return Ok(Some((channel, time, data)));
            }
            _ => {}
        }
        Ok(None)
    }
}

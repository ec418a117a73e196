//! Numbers and texts of serialised messages.
//!
//! ROS 1 packs them little-endian without gaps. ROS 2 uses CDR (OMG DDSI-RTPS 10.2, XCDR version 1): a header of four bytes
//! states the byte order, and every number is aligned to its size from the end of that header.

use std::borrow::Cow;
use std::io::Read;
use thiserror::Error;

/// Serialisation of messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoding {
    /// ROS 1.
    Ros1,
    /// ROS 2.
    Cdr,
    /// PX4: the time of measurement and the fields of a layout, as the reader of its logs hands them over.
    Ulog,
}

impl Encoding {
    /// From its name in MCAP files, and that of PX4.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        match name {
            "ros1" => Some(Self::Ros1),
            "cdr" => Some(Self::Cdr),
            "ulog" => Some(Self::Ulog),
            _ => None,
        }
    }
}

/// Why a message cannot be decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum DecodeError {
    /// It ends before its definition.
    #[error("its {bytes} bytes end before the definition does")]
    TooShort {
        /// Its length \[bytes\].
        bytes: usize,
    },
    /// It is longer than its definition.
    #[error("of its {bytes} bytes the definition covers {expected}")]
    TooLong {
        /// Its length \[bytes\].
        bytes: usize,
        /// Length of the definition \[bytes\].
        expected: usize,
    },
    /// CDR other than plain XCDR version 1.
    #[error("{}", Self::representation(*.identifier))]
    Representation {
        /// The identifier in its header.
        identifier: [u8; 2],
    },
}

impl DecodeError {
    fn representation([high, low]: [u8; 2]) -> String {
        if [high, low] == ZSTD_START {
            "it is compressed with zstd by itself, and does not unpack".into()
        } else {
            format!("its CDR representation {high:#04x}{low:02x} is none of 0x0000 and 0x0001")
        }
    }
}

/// First bytes of messages that are compressed one by one.
const ZSTD_START: [u8; 2] = [0x28, 0xb5];
/// Largest message that is unpacked, and the logarithm of the largest window of its compression \[bytes\].
const LARGEST: u64 = 16 << 20;
const WINDOW_LOG: u32 = 24;

/// A message that may be compressed by itself (`ros2 bag record --compression-mode message`). `buffer` holds the content.
/// One that does not unpack stays as it is, and does not decode.
pub(super) fn unpacked<'a>(data: &'a [u8], buffer: &'a mut Vec<u8>) -> &'a [u8] {
    if !data.starts_with(&ZSTD_START) {
        return data;
    }
    buffer.clear();
    let read = zstd::stream::read::Decoder::with_buffer(data).and_then(|mut decoder| {
        decoder.window_log_max(WINDOW_LOG)?;
        decoder.take(LARGEST + 1).read_to_end(buffer)
    });
    match read {
        Ok(length) if length as u64 <= LARGEST => buffer,
        _ => data,
    }
}

/// CDR rounds a message up to this many bytes.
const CDR_PADDING: usize = 8;

/// A place in a message.
pub(super) struct Wire<'a> {
    bytes: &'a [u8],
    place: usize,
    encoding: Encoding,
    big_endian: bool,
}

impl<'a> Wire<'a> {
    pub fn new(encoding: Encoding, bytes: &'a [u8]) -> Result<Self, DecodeError> {
        let mut wire = Self {
            bytes,
            place: 0,
            encoding,
            big_endian: false,
        };
        if encoding == Encoding::Cdr {
            let [high, low, _, _] = wire.array()?;
            if high != 0 || low > 1 {
                let identifier = [high, low];
                return Err(DecodeError::Representation { identifier });
            }
            wire.big_endian = low == 0;
            // Alignment counts from here.
            wire.bytes = &bytes[4..];
            wire.place = 0;
        }
        Ok(wire)
    }

    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// The next bytes of a number, least significant first.
    fn number<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        if self.encoding == Encoding::Cdr {
            self.place = self.place.next_multiple_of(N);
        }
        let mut number: [u8; N] = self.array()?;
        if self.big_endian {
            number.reverse();
        }
        Ok(number)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8], DecodeError> {
        let rest = self.bytes.get(self.place..).unwrap_or_default();
        let taken = rest.get(..length).ok_or(DecodeError::TooShort {
            bytes: self.bytes.len(),
        })?;
        self.place += length;
        Ok(taken)
    }

    pub fn u8(&mut self) -> Result<u8, DecodeError> {
        self.number().map(u8::from_le_bytes)
    }

    pub fn i8(&mut self) -> Result<i8, DecodeError> {
        self.number().map(i8::from_le_bytes)
    }

    pub fn u16(&mut self) -> Result<u16, DecodeError> {
        self.number().map(u16::from_le_bytes)
    }

    pub fn u32(&mut self) -> Result<u32, DecodeError> {
        self.number().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Result<i32, DecodeError> {
        self.number().map(i32::from_le_bytes)
    }

    pub fn i64(&mut self) -> Result<i64, DecodeError> {
        self.number().map(i64::from_le_bytes)
    }

    pub fn f32(&mut self) -> Result<f32, DecodeError> {
        self.number().map(f32::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64, DecodeError> {
        self.number().map(f64::from_le_bytes)
    }

    /// A fixed number of numbers.
    pub fn f64s<const N: usize>(&mut self) -> Result<[f64; N], DecodeError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        Ok(numbers)
    }

    /// A text; its length in CDR includes the final zero.
    pub fn text(&mut self) -> Result<Cow<'a, str>, DecodeError> {
        let length = self.u32()? as usize;
        let mut bytes = self.take(length)?;
        if self.encoding == Encoding::Cdr {
            bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        }
        Ok(String::from_utf8_lossy(bytes))
    }

    /// A list with its length.
    pub fn list<T>(
        &mut self,
        item: impl Fn(&mut Self) -> Result<T, DecodeError>,
    ) -> Result<Vec<T>, DecodeError> {
        let length = self.u32()?;
        // Nothing is reserved: the length may be wrong.
        (0..length).map(|_| item(self)).collect()
    }

    /// Checks for the end of the message: a longer one has another definition.
    pub fn finish(self) -> Result<(), DecodeError> {
        let (bytes, expected) = (self.bytes.len(), self.place);
        let padded = match self.encoding {
            Encoding::Ros1 | Encoding::Ulog => expected,
            Encoding::Cdr => expected.next_multiple_of(CDR_PADDING),
        };
        if bytes > padded {
            return Err(DecodeError::TooLong { bytes, expected });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cdr_aligns_and_swaps_and_ros1_does_neither() {
        // A byte, the text "ab", a double, encoded by hand after the OMG's rules.
        let one = 1.0_f64;
        let mut little = vec![0, 1, 0, 0, 7, 0, 0, 0, 3, 0, 0, 0, b'a', b'b', 0, 0];
        little.extend([0; 4]);
        little.truncate(4 + 16);
        little.extend(one.to_le_bytes());
        let mut big = vec![
            0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 3, b'a', b'b', 0, 0, 0, 0, 0, 0,
        ];
        big.extend(one.to_be_bytes());
        let mut packed = vec![7, 2, 0, 0, 0, b'a', b'b'];
        packed.extend(one.to_le_bytes());
        for (encoding, bytes) in [
            (Encoding::Cdr, little),
            (Encoding::Cdr, big),
            (Encoding::Ros1, packed),
        ] {
            let mut wire = Wire::new(encoding, &bytes).unwrap();
            assert_eq!(wire.u8().unwrap(), 7);
            assert_eq!(wire.text().unwrap(), "ab");
            assert_eq!(wire.f64().unwrap(), one, "{bytes:?}");
            wire.finish().unwrap();
        }
    }

    #[test]
    fn other_lengths_and_representations_are_refused() {
        let short = Wire::new(Encoding::Ros1, &[1, 2]).unwrap().u32();
        assert_eq!(short, Err(DecodeError::TooShort { bytes: 2 }));
        // A list that claims a length of 4 billion.
        let lie = Wire::new(Encoding::Ros1, &[255; 9]).unwrap().list(Wire::u8);
        assert_eq!(lie, Err(DecodeError::TooShort { bytes: 9 }));
        let mut long = Wire::new(Encoding::Ros1, &[1, 2]).unwrap();
        long.u8().unwrap();
        let expected = DecodeError::TooLong {
            bytes: 2,
            expected: 1,
        };
        assert_eq!(long.finish(), Err(expected));
        let xcdr2 = Wire::new(Encoding::Cdr, &[0, 7, 0, 0]).err();
        let identifier = [0, 7];
        assert_eq!(xcdr2, Some(DecodeError::Representation { identifier }));
        assert!(Wire::new(Encoding::Cdr, &[0]).is_err());
        let packed = Wire::new(Encoding::Cdr, &[0x28, 0xb5, 0x2f, 0xfd]).err();
        assert!(packed.unwrap().to_string().contains("does not unpack"));
    }

    #[test]
    fn messages_that_are_compressed_one_by_one_are_unpacked() {
        let message = [0, 1, 0, 0, 7];
        let packed = zstd::encode_all(&message[..], 1).unwrap();
        let mut buffer = Vec::new();
        assert_eq!(unpacked(&packed, &mut buffer), message);
        assert_eq!(unpacked(&message, &mut buffer), message);
        let cut = &packed[..packed.len() - 2];
        assert_eq!(unpacked(cut, &mut buffer), cut);
        // A bomb: a gigabyte of zeros.
        let bomb = zstd::encode_all(std::io::repeat(0).take(1 << 30), 1).unwrap();
        let used = allocation_counter::measure(|| {
            let mut buffer = Vec::new();
            assert_eq!(unpacked(&bomb, &mut buffer), bomb);
        });
        assert!(used.bytes_max < 4 * LARGEST, "{used:?}");
    }
}

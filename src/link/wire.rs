//! Bytes on the line, in both directions: a body and its CRC, encoded with COBS so that none of their bytes is zero, and one zero
//! byte at the end. A reader that starts in the middle, or receives noise, is synchronised again after the next zero.
//!
//! [`telemetry`](super::telemetry) and [`command`](super::command) define the bodies; `PROTOCOL.md` beside this file describes
//! all that a client needs.

use core::fmt;
use core::ops::Deref;
use crc::{CRC_16_IBM_3740, Crc};
use heapless::Vec;

/// Version of the layout of all bodies.
pub const PROTOCOL_VERSION: u8 = 2;

/// The same for a board with several tips.
#[cfg(tips)]
pub const HAND_VERSION: u8 = 3;

/// Length of the longest body in either direction, bytes.
pub const MAXIMUM_BODY: usize = if cfg!(tips) { 240 } else { 80 };

const CRC_BYTES: usize = 2;

const CHECK_AND_END: usize = CRC_BYTES + 1;

/// Longest frame on the wire: the code byte of COBS (one for anything below 255), body, CRC and the zero.
pub const MAXIMUM_FRAME: usize = 1 + MAXIMUM_BODY + CRC_BYTES + 1;

const CHECK: Crc<u16> = Crc::<u16>::new(&CRC_16_IBM_3740);

/// Reasons why bytes are not a frame.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum DecodeError {
    /// The stuffing is broken, or there are more bytes than any frame has.
    Stuffing,
    /// Fewer bytes than the shortest frame has.
    Short,
    /// The check value does not fit the bytes.
    Crc,
    /// Another version of the layout.
    Version(u8),
    /// Unknown kind.
    Kind(u8),
    /// The kind has another number of bytes.
    Length,
    /// A field has a value that the layout does not allow. The number is the offset of the field.
    Field(u8),
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stuffing => f.write_str("the COBS stuffing is broken or the frame is too long"),
            Self::Short => f.write_str("the frame is too short"),
            Self::Crc => f.write_str("the CRC does not fit"),
            Self::Version(found) => {
                write!(
                    f,
                    "protocol version {found}, this reader knows {PROTOCOL_VERSION}"
                )
            }
            Self::Kind(found) => write!(f, "unknown kind of frame {found}"),
            Self::Length => f.write_str("the length does not fit the kind of frame"),
            Self::Field(offset) => write!(f, "the field at offset {offset} holds no allowed value"),
        }
    }
}

impl core::error::Error for DecodeError {}

/// Bytes of one frame, the closing zero included.
///
/// It is built in the buffer from which it is sent, because copying a frame costs more than checking it. Fields are appended
/// one after the other, after the first code byte of COBS, which is not known yet.
#[derive(Clone, Debug)]
pub struct Encoded {
    bytes: [u8; MAXIMUM_FRAME],
    length: usize,
}

impl Deref for Encoded {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        self.as_slice()
    }
}

impl Encoded {
    /// The bytes.
    pub fn as_slice(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or(&[])
    }

    /// No frame yet.
    pub const NOTHING: Self = Self {
        bytes: [0; MAXIMUM_FRAME],
        length: 0,
    };

    /// Starts a new frame and discards the previous one.
    #[inline]
    pub(crate) fn begin(&mut self) {
        self.length = 1;
    }

    #[inline]
    pub(crate) fn put<const N: usize>(&mut self, field: [u8; N]) {
        // The longest body fits in MAXIMUM_BODY, so no field is ever dropped. A field of fixed length takes one or two store instructions.
        if let Some(place) = self
            .bytes
            .get_mut(self.length..)
            .and_then(|rest| rest.first_chunk_mut())
        {
            *place = field;
            self.length += N;
        }
    }

    /// Appends a field of variable length.
    #[cfg(feature = "load-tip")]
    pub(crate) fn put_all(&mut self, field: &[u8]) {
        for &byte in field {
            self.put([byte]);
        }
    }

    /// Makes the body a frame.
    ///
    /// Below 254 bytes COBS is a chain through the zeros, each replaced by the distance to the next: This is done in place, in
    /// one pass with the CRC. It takes a quarter of the instructions of the general encoder, against which it is tested.
    pub(crate) fn finish(&mut self) {
        let Some((frame, [low, high, end, ..])) = self.bytes.split_at_mut_checked(self.length) else {
            return;
        };
        let Some((first, body)) = frame.split_first_mut() else {
            return;
        };
        let mut chain = Chain {
            open: first,
            distance: 1,
        };
        let mut check = CHECK.digest();
        for byte in body {
            check.update(&[*byte]);
            chain.take(byte);
        }
        [*low, *high] = check.finalize().to_le_bytes();
        chain.take(low);
        chain.take(high);
        *chain.open = chain.distance;
        *end = 0;
        self.length += CHECK_AND_END;
    }
}

/// The chain of COBS so far: the open code byte, and the distance counted so far for it.
struct Chain<'a> {
    open: &'a mut u8,
    distance: u8,
}

impl<'a> Chain<'a> {
    #[inline]
    fn take(&mut self, byte: &'a mut u8) {
        if *byte == 0 {
            *core::mem::replace(&mut self.open, byte) = self.distance;
            self.distance = 1;
        } else {
            self.distance += 1;
        }
    }
}

/// Takes fields one after the other.
pub(crate) struct Reader<'a>(pub(crate) &'a [u8]);

impl Reader<'_> {
    pub(crate) fn take<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        let (field, rest) = self.0.split_first_chunk::<N>().ok_or(DecodeError::Length)?;
        self.0 = rest;
        Ok(*field)
    }
}

/// The body in the bytes between two zeros (the zeros themselves left out).
///
/// # Errors
/// [`DecodeError::Stuffing`], [`DecodeError::Short`] and [`DecodeError::Crc`].
pub fn unstuff(stuffed: &[u8]) -> Result<Vec<u8, MAXIMUM_BODY>, DecodeError> {
    let mut plain = [0; MAXIMUM_BODY + CRC_BYTES];
    if stuffed.contains(&0) {
        return Err(DecodeError::Stuffing);
    }
    let length = cobs::decode(stuffed, &mut plain)
        .map_err(|_| DecodeError::Stuffing)?
        .frame_size();
    let plain = plain.get(..length).ok_or(DecodeError::Stuffing)?;
    let (body, check) = plain.split_last_chunk::<CRC_BYTES>().ok_or(DecodeError::Short)?;
    if CHECK.checksum(body) != u16::from_le_bytes(*check) {
        return Err(DecodeError::Crc);
    }
    Vec::from_slice(body).map_err(|_| DecodeError::Stuffing)
}

/// Extracts frames from a stream, one byte at a time. The work for each byte is bounded. The memory is one frame.
#[derive(Clone, Debug, Default)]
pub struct Deframer {
    bytes: Vec<u8, MAXIMUM_FRAME>,
    /// Whether more bytes came without a zero than the longest frame has.
    overflowed: bool,
}

impl Deframer {
    /// Takes the next byte. At the zero that closes a frame, returns its body. Zeros alone give nothing.
    pub fn push(&mut self, byte: u8) -> Option<Result<Vec<u8, MAXIMUM_BODY>, DecodeError>> {
        if byte != 0 {
            self.overflowed |= self.bytes.push(byte).is_err();
            return None;
        }
        let emitted = if core::mem::take(&mut self.overflowed) {
            Some(Err(DecodeError::Stuffing))
        } else if self.bytes.is_empty() {
            None
        } else {
            Some(unstuff(&self.bytes))
        };
        self.bytes.clear();
        emitted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn framed(body: &[u8]) -> Encoded {
        let mut frame = Encoded::NOTHING;
        frame.begin();
        for &byte in body {
            frame.put([byte]);
        }
        frame.finish();
        frame
    }

    #[test]
    fn the_check_is_the_catalogues() {
        assert_eq!(CHECK.checksum(b"123456789"), 0x29B1);
    }

    #[test]
    fn a_frame_is_stuffed_as_the_paper_does() {
        // CRC of 00 00 by Python's binascii.crc_hqx(bytes(2), 0xFFFF): 0x1D0F.
        assert_eq!(framed(&[0, 0]).as_slice(), [1, 1, 3, 0x0F, 0x1D, 0]);
    }

    #[test]
    fn short_and_broken_bytes_are_refused() {
        assert_eq!(unstuff(&[]), Err(DecodeError::Stuffing));
        assert_eq!(unstuff(&[1]), Err(DecodeError::Short));
        assert_eq!(unstuff(&[2, 1]), Err(DecodeError::Short));
        assert_eq!(unstuff(&[200, 1]), Err(DecodeError::Stuffing));
        assert_eq!(unstuff(&[3, 1, 0]), Err(DecodeError::Stuffing));
        assert_eq!(unstuff(&[4, 1, 2, 3]), Err(DecodeError::Crc));
    }

    /// A reader that ends at the first zero would take the frame and lose what follows.
    #[test]
    fn a_frame_with_a_zero_and_more_behind_it_is_no_frame() {
        let frame = [1, 1, 3, 0x0F, 0x1D];
        assert_eq!(unstuff(&frame).expect("it is one").as_slice(), [0, 0]);
        let longer = [frame.as_slice(), &[0, 9, 7]].concat();
        assert_eq!(unstuff(&longer), Err(DecodeError::Stuffing));
    }

    proptest! {
        #[test]
        fn stuffing_is_what_the_cobs_crate_gives(body in prop::collection::vec(prop_oneof![Just(0_u8), any::<u8>()], 0..=MAXIMUM_BODY)) {
            let mut plain = body.clone();
            plain.extend(CHECK.checksum(&body).to_le_bytes());
            let mut expected = cobs::encode_vec(&plain);
            expected.push(0);
            let frame = framed(&body);
            prop_assert_eq!(frame.as_slice(), expected.as_slice());
            let (_, stuffed) = frame.as_slice().split_last().expect("never empty");
            let read = unstuff(stuffed).expect("it is a frame");
            prop_assert_eq!(read.as_slice(), body.as_slice());
        }

        #[test]
        fn one_flipped_bit_is_never_a_frame(
            body in prop::collection::vec(any::<u8>(), 0..=MAXIMUM_BODY), place in any::<prop::sample::Index>(), bit in 0..8,
        ) {
            let mut frame = framed(&body).as_slice().to_vec();
            frame.pop();
            let index = place.index(frame.len());
            frame[index] ^= 1_u8 << bit;
            prop_assert!(unstuff(&frame).is_err());
        }

        #[test]
        fn no_bytes_make_the_reader_panic_and_a_frame_after_them_is_read(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
            let mut deframer = Deframer::default();
            for byte in bytes {
                let _ = deframer.push(byte);
            }
            let _ = deframer.push(0);
            let frame = framed(&[7, 0, 9]);
            let (last, stuffed) = frame.split_last().expect("never empty");
            for &byte in stuffed {
                prop_assert!(deframer.push(byte).is_none());
            }
            let body = deframer.push(*last).expect("a zero ends it").expect("it is whole");
            prop_assert_eq!(body.as_slice(), [7, 0, 9]);
        }
    }
}

//! The state of a fleet as bytes.
//!
//! What a fleet is made from (the spec) is not in them, only what has become of it. Every part
//! names its changing values once, in a function that both writes and reads them, so that the two
//! can't drift apart.

use super::report::{Body, Sweep};
use interfaces::Twist;
use nalgebra::{Isometry2, Point2, Translation2, UnitComplex};

/// What every snapshot begins with: the kind of file, and the version of its contents.
const MAGIC: u64 = u64::from_le_bytes(*b"fleet\0\0\x03");

/// Why bytes are no snapshot of a fleet.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SnapshotError {
    /// They begin with something else, or come from another version.
    #[error("these bytes are no snapshot of a fleet, or one of another version")]
    Unknown,
    /// Some of them are missing or have changed.
    #[error("the snapshot is damaged")]
    Damaged,
    /// They belong to a place with other walls, robots or settings.
    #[error("the snapshot was taken of a fleet with another spec")]
    OtherSpec,
}

/// A tape that values are written to, or read from.
pub(super) enum Tape<'a> {
    Writing(Vec<u8>),
    /// What is left to read.
    Reading(&'a [u8]),
}

/// Reading came to something that cannot be.
pub(super) struct Torn;

pub(super) type Played = Result<(), Torn>;

impl<'a> Tape<'a> {
    /// A tape to write the state of a fleet on. `spec`: a fingerprint of what it is made from.
    pub(super) fn writing(spec: u64) -> Self {
        let mut bytes = MAGIC.to_le_bytes().to_vec();
        bytes.extend(spec.to_le_bytes());
        Self::Writing(bytes)
    }

    /// The bytes that were written, with a checksum.
    pub(super) fn finish(self) -> Vec<u8> {
        let mut bytes = match self {
            Self::Writing(bytes) => bytes,
            Self::Reading(_) => Vec::new(),
        };
        bytes.extend(fingerprint(&bytes).to_le_bytes());
        bytes
    }

    /// A tape to read the state of a fleet from that is made from `spec`.
    pub(super) fn reading(bytes: &'a [u8], spec: u64) -> Result<Self, SnapshotError> {
        let word = |bytes: &[u8]| bytes.try_into().map(u64::from_le_bytes).ok();
        if bytes.get(..8).and_then(word) != Some(MAGIC) {
            return Err(SnapshotError::Unknown);
        }
        let (body, sum) = bytes.split_at(bytes.len() - 8);
        if body.len() < 16 || word(sum) != Some(fingerprint(body)) {
            return Err(SnapshotError::Damaged);
        }
        if word(&body[8..16]) != Some(spec) {
            return Err(SnapshotError::OtherSpec);
        }
        Ok(Self::Reading(&body[16..]))
    }

    /// All has been read.
    pub(super) fn is_at_end(&self) -> bool {
        matches!(self, Self::Reading([]))
    }

    /// Some bytes of known length.
    fn raw<const N: usize>(&mut self, value: &mut [u8; N]) -> Played {
        match self {
            Self::Writing(bytes) => bytes.extend(*value),
            Self::Reading(bytes) => {
                let (head, rest) = bytes.split_first_chunk().ok_or(Torn)?;
                (*value, *bytes) = (*head, rest);
            }
        }
        Ok(())
    }

    pub(super) fn u64(&mut self, value: &mut u64) -> Played {
        let mut bytes = value.to_le_bytes();
        self.raw(&mut bytes)?;
        *value = u64::from_le_bytes(bytes);
        Ok(())
    }

    pub(super) fn u128(&mut self, value: &mut u128) -> Played {
        let mut bytes = value.to_le_bytes();
        self.raw(&mut bytes)?;
        *value = u128::from_le_bytes(bytes);
        Ok(())
    }

    pub(super) fn usize(&mut self, value: &mut usize) -> Played {
        let mut wide = *value as u64;
        self.u64(&mut wide)?;
        *value = usize::try_from(wide).map_err(|_| Torn)?;
        Ok(())
    }

    pub(super) fn u32(&mut self, value: &mut u32) -> Played {
        let mut wide = u64::from(*value);
        self.u64(&mut wide)?;
        *value = u32::try_from(wide).map_err(|_| Torn)?;
        Ok(())
    }

    pub(super) fn bool(&mut self, value: &mut bool) -> Played {
        let mut byte = [u8::from(*value)];
        self.raw(&mut byte)?;
        *value = match byte {
            [0] => false,
            [1] => true,
            _ => return Err(Torn),
        };
        Ok(())
    }

    pub(super) fn f64(&mut self, value: &mut f64) -> Played {
        let mut bits = value.to_bits();
        self.u64(&mut bits)?;
        *value = f64::from_bits(bits);
        Ok(())
    }

    /// A value that may be missing; `new` is what reading it starts with.
    pub(super) fn option<T>(
        &mut self,
        value: &mut Option<T>,
        new: impl FnOnce() -> T,
        play: impl FnOnce(&mut Self, &mut T) -> Played,
    ) -> Played {
        let mut is_some = value.is_some();
        self.bool(&mut is_some)?;
        if !is_some {
            *value = None;
            return Ok(());
        }
        play(self, value.get_or_insert_with(new))
    }

    /// A list of any length; `new` is what reading an item starts with.
    pub(super) fn list<T: Clone>(
        &mut self,
        values: &mut Vec<T>,
        new: T,
        mut play: impl FnMut(&mut Self, &mut T) -> Played,
    ) -> Played {
        let mut count = values.len();
        self.usize(&mut count)?;
        if let Self::Reading(bytes) = self {
            // Every item takes a byte or more: no more memory than that.
            if count > bytes.len() {
                return Err(Torn);
            }
            values.clear();
            values.resize(count, new);
        }
        values.iter_mut().try_for_each(|value| play(self, value))
    }

    pub(super) fn bytes(&mut self, values: &mut Vec<u8>) -> Played {
        let mut count = values.len();
        self.usize(&mut count)?;
        match self {
            Self::Writing(bytes) => bytes.extend_from_slice(values),
            Self::Reading(bytes) => {
                let (head, rest) = bytes.split_at_checked(count).ok_or(Torn)?;
                *values = head.to_vec();
                *bytes = rest;
            }
        }
        Ok(())
    }

    pub(super) fn point(&mut self, value: &mut Point2<f64>) -> Played {
        self.f64(&mut value.x)?;
        self.f64(&mut value.y)
    }

    pub(super) fn pose(&mut self, value: &mut Isometry2<f64>) -> Played {
        let mut at = Point2::from(value.translation.vector);
        let (mut cos, mut sin) = (value.rotation.re, value.rotation.im);
        self.point(&mut at)?;
        self.f64(&mut cos)?;
        self.f64(&mut sin)?;
        *value = Isometry2::from_parts(Translation2::from(at), UnitComplex::from_cos_sin_unchecked(cos, sin));
        Ok(())
    }

    pub(super) fn twist(&mut self, value: &mut Twist) -> Played {
        self.f64(&mut value.linear_mps)?;
        self.f64(&mut value.angular_radps)
    }

    pub(super) fn body(&mut self, value: &mut Body) -> Played {
        let (mut kind, mut index) = match *value {
            Body::Wall(index) => (0, index),
            Body::Obstacle(index) => (1, index),
            Body::Robot(index) => (2, index),
        };
        self.u32(&mut kind)?;
        self.usize(&mut index)?;
        *value = match kind {
            0 => Body::Wall(index),
            1 => Body::Obstacle(index),
            2 => Body::Robot(index),
            _ => return Err(Torn),
        };
        Ok(())
    }

    /// What a robot saw last; the figures that all its scans share are known.
    pub(super) fn sweep(&mut self, value: &mut Sweep) -> Played {
        self.pose(&mut value.laser_pose)?;
        let reading = &mut value.reading;
        self.f64(&mut reading.time_s)?;
        self.pose(&mut reading.pose)?;
        self.twist(&mut reading.twist)?;
        self.list(&mut reading.scan.ranges_m, 0.0, |tape, range_m| {
            let mut bytes = range_m.to_le_bytes();
            tape.raw(&mut bytes)?;
            *range_m = f32::from_le_bytes(bytes);
            Ok(())
        })
    }
}

/// FNV-1a, word by word: to tell damage, not malice.
pub(super) fn fingerprint(bytes: &[u8]) -> u64 {
    let eat = |hash: u64, word: u64| (hash ^ word).wrapping_mul(0x0100_0000_01b3).rotate_left(29);
    let words = bytes.chunks(8).map(|chunk| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    });
    eat(words.fold(0xcbf2_9ce4_8422_2325, eat), bytes.len() as u64)
}

//! A state as bytes: a header, and a body that postcard writes and LZ4 compresses.
//!
//! ```text
//! 0  the kind of file, 8 bytes
//! 8  the version of the format, 4 bytes
//! 12 the hash of the layout, 16 hexadecimal digits
//! 28 the checksum of all that follows, 8 bytes: XXH3 with the version as its seed
//! 36 the length of the body, 4 bytes, and the compressed body
//! ```
//!
//! Numbers are little-endian.

use super::settings::{MAX_BODY, SavedSettings, StateError, VERSION};
use crate::build::{BUILD, other_build};
use interfaces::GridFrame;
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64_with_seed;

/// A body may be longer than the first number of bytes only up to this multiple of the compressed bytes: those of maps are shorter
/// than 10 times, and lists of empty texts take 24 bytes of memory for each of their bytes.
const MAX_SMALL_BODY: usize = 16 << 20;
const MAX_GROWTH: usize = 64;
/// A hash of the types in a file: see `build.rs`.
const LAYOUT: &str = env!("CURIOUS_LAYOUT");

/// What was learned of a place, and what its last run goes on with.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct State {
    /// The build of the program that saved it.
    pub build: String,
    /// The logs and the runs of robots from which it was learned, in the order of their times.
    pub sessions: Vec<Session>,
    /// The map with all statistics; `None` before something was learned.
    pub map: Option<SavedMap>,
    /// The surfaces in which poses are found; empty where poses are given.
    pub surfaces: Vec<u8>,
    /// What the scan filter has learned; empty in a survey of logs, which learns it anew for each log.
    pub filter: Vec<u8>,
    /// How a robot with the same settings goes on from its last pose.
    pub localization: Part,
    /// The time of the last reading by the clock of a live robot, ns.
    pub clock_ns: Option<i64>,
    /// The logs, and the names and numbers of places; `None` if no log was learned.
    pub survey: Option<Part>,
    /// What only the same run goes on with: the world, the pilot, the random streams.
    pub run: Option<Part>,
}

/// Bytes of one part of a program, and the settings that they belong to.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Part {
    /// The settings.
    pub settings: SavedSettings,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// A map in a state.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct SavedMap {
    /// Its cells.
    pub frame: GridFrame,
    /// The settings of its mapper, and of the filter of scans.
    pub settings: SavedSettings,
    /// The time at which readings have the time 0, in seconds since 1970-01-01 UTC; `None` where readings have no dates.
    pub epoch_s: Option<f64>,
    /// The snapshot of the mapper.
    pub bytes: Vec<u8>,
}

/// A session in a place: a log, or a run of a robot.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Session {
    /// The name of the log, or that of the program with a number.
    pub name: String,
    /// When it began, by the times of the map, s.
    pub offset_s: f64,
    /// This time in seconds since 1970-01-01 UTC; `None` if it is not known.
    pub begin_s: Option<f64>,
    /// The time from its begin to its end, s.
    pub duration_s: f64,
    /// The number of readings that entered the map, and of all readings.
    pub readings: [usize; 2],
    /// The laser, in words; empty if it is not known.
    pub laser: String,
    /// What was repaired, left out or assumed, each a sentence.
    pub notes: Vec<String>,
}

impl State {
    /// How a state begins.
    pub(crate) const MAGIC: &[u8; 8] = b"\x89curious";

    /// Checks that this program computes the same bits as the one that saved the state.
    ///
    /// # Errors
    ///
    /// When it is another build, or an unknown one.
    pub fn check_build(&self) -> Result<(), StateError> {
        if self.build == BUILD { Ok(()) } else { Err(StateError::OtherBuild(other_build(&self.build))) }
    }

    /// The state as the bytes of a file.
    ///
    /// # Errors
    ///
    /// When the state is too large.
    pub fn to_bytes(&self) -> Result<Vec<u8>, StateError> {
        // Strings and lists always can be written. An empty body would be refused.
        let body = postcard::to_stdvec(self).unwrap_or_default();
        check_length(body.len())?;
        let packed = lz4_flex::compress_prepend_size(&body);
        let checksum = xxh3_64_with_seed(&packed, VERSION.into());
        let version = VERSION.to_le_bytes();
        Ok([&Self::MAGIC[..], &version, LAYOUT.as_bytes(), &checksum.to_le_bytes(), &packed].concat())
    }

    /// The state in the bytes of a file.
    ///
    /// # Errors
    ///
    /// When the bytes are another kind of file, are damaged, or come from another version.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, StateError> {
        let (version, layout, packed) = Self::parts(bytes)?;
        if version != VERSION {
            return Err(StateError::OtherVersion(version));
        }
        if layout != LAYOUT.as_bytes() {
            return Err(StateError::OtherLayout);
        }
        let length = packed.first_chunk().ok_or(StateError::Damaged)?;
        let length = u32::from_le_bytes(*length) as usize;
        check_length(length)?;
        if length > MAX_SMALL_BODY + MAX_GROWTH * packed.len() {
            return Err(StateError::Damaged);
        }
        let body = lz4_flex::decompress_size_prepended(packed).map_err(|_| StateError::Damaged)?;
        postcard::from_bytes(&body).map_err(|_| StateError::Damaged)
    }

    /// Whether these are the bytes of a state of any version, as a program wrote them.
    pub(super) fn is_intact(bytes: &[u8]) -> bool {
        Self::parts(bytes).is_ok()
    }

    /// The version, the layout and the compressed body of a file with the right checksum.
    fn parts(bytes: &[u8]) -> Result<(u32, &[u8], &[u8]), StateError> {
        let rest = bytes.strip_prefix(Self::MAGIC).ok_or(StateError::OtherKind)?;
        let (version, rest) = rest.split_first_chunk().ok_or(StateError::Damaged)?;
        let version = u32::from_le_bytes(*version);
        let (layout, rest) = rest.split_at_checked(LAYOUT.len()).ok_or(StateError::Damaged)?;
        let (checksum, packed) = rest.split_first_chunk().ok_or(StateError::Damaged)?;
        // A flipped bit of the version is damage; another version has another checksum.
        let is_right = u64::from_le_bytes(*checksum) == xxh3_64_with_seed(packed, version.into());
        if is_right { Ok((version, layout, packed)) } else { Err(StateError::Damaged) }
    }
}

fn check_length(bytes: usize) -> Result<(), StateError> {
    if bytes > MAX_BODY { Err(StateError::TooLarge(bytes)) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A list of empty texts takes 24 times as much memory as its body, which LZ4 makes up to 255 times shorter.
    #[test]
    fn a_few_bytes_do_not_take_gigabytes() {
        let signed = |packed: &[u8]| {
            let checksum = xxh3_64_with_seed(packed, VERSION.into()).to_le_bytes();
            [&State::MAGIC[..], &VERSION.to_le_bytes(), LAYOUT.as_bytes(), &checksum, packed].concat()
        };
        let of_body = |body: &[u8]| State::from_bytes(&signed(&lz4_flex::compress_prepend_size(body)));
        assert_eq!(of_body(&postcard::to_stdvec(&State::default()).unwrap()).unwrap(), State::default());
        let session = Session { notes: vec![String::new(); 1000], ..Session::default() };
        let state = State { sessions: vec![session], ..State::default() };
        assert_eq!(State::from_bytes(&state.to_bytes().unwrap()).unwrap(), state);
        assert!(matches!(of_body(&vec![0; 2 * MAX_SMALL_BODY]), Err(StateError::Damaged)));
        let length = (MAX_BODY as u32).to_le_bytes();
        assert!(matches!(
            State::from_bytes(&signed(&[&length[..], &[0; 99]].concat())),
            Err(StateError::Damaged)
        ));
    }

    #[test]
    fn a_body_that_is_too_large_is_refused() {
        check_length(MAX_BODY).unwrap();
        let error = check_length(MAX_BODY + 1).unwrap_err().to_string();
        let expected = "the state has 2147483649 bytes, and a state file holds 2147483648 at most; a map of fewer cells is smaller";
        assert_eq!(error, expected);
    }
}

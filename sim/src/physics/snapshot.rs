//! The state of a fleet as bytes: a header, the values that change, and a checksum.
//!
//! A snapshot does not contain the spec of the fleet. Every part of a fleet lists its changing values once, as
//! [`Values`]; serde and postcard write them and read them in the same order.

pub(super) use interfaces::{Values, value};

use interfaces::{Value, converted, read_values, write_values};
use nalgebra::Isometry2;
use serde::{Deserialize, Serialize};

/// The first eight bytes of a snapshot: the kind of data, and the version of the format.
const MAGIC: u64 = u64::from_le_bytes(*b"fleet\0\0\x0b");

/// The error for bytes that are not a snapshot of the fleet.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SnapshotError {
    /// The bytes do not begin like a snapshot, or come from another version.
    #[error("these bytes are not a snapshot of a fleet, or they come from another version")]
    Unknown,
    /// Bytes are missing, or were changed.
    #[error("the snapshot is damaged")]
    Damaged,
    /// The snapshot belongs to a fleet with other walls, robots or settings.
    #[error("the snapshot was taken of a fleet with another spec")]
    OtherSpec,
}

/// A pose that serde can write and read as four numbers.
#[derive(Clone, Copy, Deserialize, Serialize)]
pub(super) struct SavedPose(#[serde(with = "interfaces::serde_pose")] pub(super) Isometry2<f64>);

/// A pose.
pub(super) fn pose(pose: &mut Isometry2<f64>) -> Box<dyn Value + '_> {
    converted(
        pose,
        |pose| SavedPose(*pose),
        |pose, SavedPose(saved)| {
            *pose = saved;
            Ok(())
        },
    )
}

/// The snapshot of a fleet with these values. `spec` is the fingerprint of its spec.
pub(super) fn write(spec: u64, values: Values<'_>) -> Vec<u8> {
    let mut bytes = [MAGIC.to_le_bytes(), spec.to_le_bytes()].concat();
    if write_values(values, &mut bytes).is_err() {
        // All values of a fleet can be written. If one could not, the snapshot would be refused when read.
        bytes.clear();
    }
    bytes.extend(fingerprint(&bytes).to_le_bytes());
    bytes
}

/// The bytes of the values in a snapshot of a fleet whose spec has the fingerprint `spec`.
pub(super) fn check(snapshot: &[u8], spec: u64) -> Result<&[u8], SnapshotError> {
    let word = |bytes: &[u8]| bytes.try_into().map(u64::from_le_bytes).ok();
    if snapshot.get(..8).and_then(word) != Some(MAGIC) {
        return Err(SnapshotError::Unknown);
    }
    let (body, checksum) = snapshot.split_at(snapshot.len() - 8);
    if body.len() < 16 || word(checksum) != Some(fingerprint(body)) {
        return Err(SnapshotError::Damaged);
    }
    if word(&body[8..16]) != Some(spec) {
        return Err(SnapshotError::OtherSpec);
    }
    Ok(&body[16..])
}

/// Reads values from the front of `bytes`.
pub(super) fn read(bytes: &mut &[u8], values: Values<'_>) -> Result<(), SnapshotError> {
    read_values(bytes, values).map_err(|_| SnapshotError::Damaged)
}

/// FNV-1a, word by word. It detects damage, but not intentional changes.
pub(super) fn fingerprint(bytes: &[u8]) -> u64 {
    let mix = |hash: u64, word: u64| (hash ^ word).wrapping_mul(0x0100_0000_01b3).rotate_left(29);
    let words = bytes.chunks(8).map(|chunk| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    });
    mix(words.fold(0xcbf2_9ce4_8422_2325, mix), bytes.len() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a number and a pose from a snapshot.
    fn restored(snapshot: &[u8]) -> Result<(u64, Isometry2<f64>), SnapshotError> {
        let (mut number, mut at) = (0, Isometry2::identity());
        let mut bytes = check(snapshot, 5)?;
        read(&mut bytes, vec![value(&mut number), pose(&mut at)])?;
        Ok((number, at))
    }

    #[test]
    fn a_snapshot_with_too_few_values_is_damaged() {
        let (mut number, mut at) = (u64::MAX, interfaces::pose(0.1, -0.2, 0.3));
        let whole = write(5, vec![value(&mut number), pose(&mut at)]);
        for length in 16..whole.len() - 8 {
            // With the right checksum.
            let mut cut = whole[..length].to_vec();
            cut.extend(fingerprint(&cut).to_le_bytes());
            assert_eq!(restored(&cut), Err(SnapshotError::Damaged), "{length}");
        }
    }
}

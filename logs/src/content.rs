//! The content of a log as one number: whether a log was read before, under whatever name.

use std::io::{self, Read};
use xxhash_rust::xxh3::Xxh3;

/// The hash of all bytes of some files, and of where one ends: XXH3 with 128 bits.
pub(crate) fn hash<R: Read>(files: impl IntoIterator<Item = io::Result<R>>) -> io::Result<u128> {
    let mut hash = Xxh3::new();
    for file in files {
        let length = io::copy(&mut file?, &mut hash)?;
        hash.update(&length.to_le_bytes());
    }
    Ok(hash.digest128())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_and_every_border_counts() {
        let of = |files: &[&[u8]]| hash(files.iter().map(|bytes| Ok(*bytes))).unwrap();
        let hashes = [of(&[b"ab", b"c"]), of(&[b"a", b"bc"]), of(&[b"abc"]), of(&[b"abd"]), of(&[b"ab"])];
        for (index, one) in hashes.iter().enumerate() {
            assert!(hashes[index + 1..].iter().all(|other| other != one), "{hashes:?}");
        }
        assert_eq!(of(&[b"ab", b"c"]), hashes[0]);
    }
}

//! Worlds written as text, run by the crate `sim`.
mod grid;
mod physics;
mod ros_map;

/// A fixed hash function (FNV-1a) of bytes, or of larger numbers.
fn fnv(parts: impl IntoIterator<Item = u64>) -> u64 {
    let eat = |hash: u64, part: u64| (hash ^ part).wrapping_mul(0x0100_0000_01b3);
    parts.into_iter().fold(0xcbf2_9ce4_8422_2325, eat)
}

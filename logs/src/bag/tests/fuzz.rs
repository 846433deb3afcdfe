//! Damaged bags are read or refused: no panic, no hang, no memory without bounds. More inputs by
//!
//! ```text
//! FUZZ_INPUTS=1000000 cargo test -p curious-logs damaged_bags
//! ```

use super::builder::*;
use crate::summary::TopicChoice;
use mcap::{Compression, WriteOptions};
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The number of inputs.
fn inputs() -> usize {
    std::env::var("FUZZ_INPUTS").ok().and_then(|count| count.parse().ok()).unwrap_or(10_000)
}

/// A bag with everything that is read.
fn whole() -> Builder {
    let mut bag = Builder::default();
    bag.mount();
    for time_s in times(6, 0.1) {
        let moving = transform(time_s, "odom", "base_link", pose(time_s, 0.0, 0.1));
        bag.tf("/tf", time_s, &[moving]).odometry("/odom", time_s, time_s, 0.1 * time_s);
        let sweeping = ros::LaserScan { time_increment: 0.01, ..scan(time_s, "laser") };
        bag.scan("/scan", time_s, &sweeping);
    }
    bag
}

/// Damages a file: bytes, words, cuts, repetitions.
fn damage(bytes: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    const WORDS: [u64; 12] = [
        0,
        1,
        0x7f,
        0xff,
        0xffff,
        0x7fff_ffff,
        0xffff_ffff,
        1 << 32,
        u64::MAX,
        0x7ff0_0000_0000_0000, // ∞
        0x7f80_0000_7f80_0000, // ∞ twice
        0x7e37_e43c_8800_759c, // 1e300
    ];
    for _ in 0..random.random_range(1..6) {
        let at = random.random_range(0..bytes.len().max(1));
        match random.random_range(0..10) {
            0..4 => {
                bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << random.random_range(0..8))
            }
            4..8 => {
                let word = WORDS[random.random_range(0..WORDS.len())].to_le_bytes();
                let count = [1, 2, 4, 8][random.random_range(0..4)];
                let words = bytes.iter_mut().skip(at).zip(word).take(count);
                words.for_each(|(byte, word)| *byte = word);
            }
            8 => bytes.truncate(at),
            _ => {
                let part = bytes[at..(at + random.random_range(0..200)).min(bytes.len())].to_vec();
                bytes.splice(at..at, part);
            }
        }
    }
}

/// Reads all, or refuses.
fn read_all(bytes: &[u8]) -> Option<usize> {
    let bag = open(bytes, &TopicChoice::default()).ok()?;
    let readings = readings(&bag);
    assert_eq!(readings.len(), bag.summary().scans);
    assert!(readings.windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
    for reading in &readings {
        assert_eq!(reading.scan.check(), Ok(()));
        assert!(reading.pose.translation.vector.iter().all(|at| at.is_finite()));
        assert!((reading.pose.rotation.norm_sqr() - 1.0).abs() < 1e-9);
    }
    Some(readings.len())
}

#[test]
fn damaged_bags_are_read_or_refused() {
    let bag = whole();
    let sqlite = bag.sqlite();
    let files = [
        bag.mcap(plain()),
        bag.mcap(WriteOptions::new().use_chunks(false)),
        bag.mcap(plain().chunk_size(Some(200))),
        bag.mcap(compressed(Compression::Zstd)),
        bag.mcap(compressed(Compression::Lz4)),
        sqlite,
    ];
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut read = 0;
    for input in 0..inputs() {
        let mut bytes = files[input % files.len()].clone();
        damage(&mut bytes, &mut random);
        read += usize::from(read_all(&bytes).is_some());
    }
    assert!(read > inputs() / 20 && read < inputs(), "{read} of {} inputs were read", inputs());
    assert_memory();
}

#[test]
fn damaged_messages_are_read_or_refused() {
    let bag = whole();
    let mut random = ChaCha8Rng::seed_from_u64(2);
    for _ in 0..inputs() / 4 {
        let mut bag = bag.clone();
        let index = random.random_range(0..bag.messages.len());
        damage(&mut bag.messages[index].3, &mut random);
        bag.messages[index].2 = [0, 1, u64::MAX, random.next_u64()][random.random_range(0..4)];
        read_all(&bag.mcap(plain()));
    }
}

/// At most 1 GiB was in use at any time.
fn assert_memory() {
    // Elsewhere than on Linux, the memory is not looked at.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let peak_kib = peak.and_then(|words| words.split_whitespace().next()?.parse::<u64>().ok());
    assert!(peak_kib.is_none_or(|peak_kib| peak_kib < 1 << 20), "{peak_kib:?} KiB");
}

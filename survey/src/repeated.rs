//! Scans that two logs have in common: a log that contains another one would count twice.

use interfaces::LaserReading;
use logs::{Log, LogError};
use std::collections::BTreeSet;
use xxhash_rust::xxh3::xxh3_64;

/// The number of hashes that are kept of a log, the smallest: of logs with the same scans they are the same (a bottom-k
/// sketch, Broder 1997).
const KEPT: usize = 64;
/// With fewer hashes in common, or a smaller share of those that are comparable, nothing is said.
const MIN_COMMON: usize = 6;
const MIN_SHARE: f64 = 0.2;

/// The hashes of scans of a log that are kept. A scan counts with the time since the one before, so that a place where nothing
/// moves does not look like another log.
///
/// # Errors
///
/// When the log can no longer be opened.
pub(crate) fn sketch(log: &Log) -> Result<Vec<u64>, LogError> {
    let (mut kept, mut before_s) = (BTreeSet::new(), None);
    // What is damaged is reported by the passes.
    for LaserReading { time_s, scan, .. } in log.readings()?.map_while(Result::ok) {
        if let Some(before_s) = before_s.replace(time_s) {
            let step_us = ((time_s - before_s) * 1e6).round() as i64;
            let ranges = scan.ranges_m.iter().flat_map(|range_m| range_m.to_le_bytes());
            kept.insert(xxh3_64(&ranges.chain(step_us.to_le_bytes()).collect::<Vec<u8>>()));
            if kept.len() > KEPT {
                kept.pop_last();
            }
        }
    }
    Ok(kept.into_iter().collect())
}

/// Whether a part of the scans of one log are scans of the other one.
pub(crate) fn repeats(one: &[u64], other: &[u64]) -> bool {
    let bound =
        |kept: &[u64]| if kept.len() < KEPT { u64::MAX } else { kept.last().copied().unwrap_or_default() };
    let bound = bound(one).min(bound(other));
    let comparable = |kept: &[u64]| kept.iter().filter(|hash| **hash <= bound).count();
    let common = one.iter().filter(|hash| **hash <= bound && other.binary_search(hash).is_ok()).count();
    common >= MIN_COMMON && common as f64 >= MIN_SHARE * comparable(one).min(comparable(other)) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(scans: impl Iterator<Item = u32>) -> Vec<u64> {
        let hashes: BTreeSet<u64> = scans.map(|scan| xxh3_64(&scan.to_le_bytes())).collect();
        hashes.into_iter().take(KEPT).collect()
    }

    #[test]
    fn a_log_is_known_by_its_parts_and_another_one_is_not() {
        for count in [20, 100, 1000, 20_000] {
            let whole = kept(0..count);
            for part in
                [kept(0..count / 2), kept(count / 2..count), kept(count / 3..2 * count / 3), kept(0..count)]
            {
                assert!(repeats(&whole, &part) && repeats(&part, &whole), "{count}");
            }
            assert!(!repeats(&whole, &kept(count..2 * count)) && !repeats(&whole, &[]));
        }
    }
}

//! The hash of everything that a mapper has learned.

use mapper::Mapper;
use xxhash_rust::xxh3::Xxh3;

/// A hash of the state and the statistics of every cell. Two runs with equal hashes learned the same, bit for bit.
pub fn map_hash(mapper: &Mapper) -> String {
    let mut hash = Xxh3::new();
    for index in 0..mapper.frame().len() {
        let seen = mapper.statistics(index);
        hash.update(&[mapper.states().cells()[index] as u8, u8::from(mapper.was_ever_seen(index))]);
        let figures = [
            seen.first_seen,
            seen.last_seen,
            seen.unobserved,
            seen.watched_free,
            seen.watched_blocked,
            mapper.rate(index),
            mapper.recency(index),
            mapper.change_probability(index),
        ];
        figures.iter().for_each(|figure| hash.update(&figure.to_bits().to_le_bytes()));
        let events =
            [seen.block_events, seen.free_events, seen.block_events_after_gap, seen.free_events_after_gap];
        events.iter().for_each(|count| hash.update(&count.to_le_bytes()));
    }
    format!("{:032x}", hash.digest128())
}

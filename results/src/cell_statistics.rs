//! `cell_statistics.csv`: what was learned about every cell.

use crate::intervals::Intervals;
use crate::numbers::rounded;
use files::{OutputError, write_file};
use interfaces::CellState;
use mapper::Mapper;
use std::io;
use std::path::Path;

/// One row: a cell that was seen at least once. Times are in seconds.
#[derive(serde::Serialize)]
struct Row {
    x_m: Number,
    y_m: Number,
    column: i32,
    row: i32,
    state: &'static str,
    first_seen_s: Number,
    last_seen_s: Number,
    unobserved_s: Number,
    watched_free_s: Number,
    watched_blocked_s: Number,
    block_events: u32,
    free_events: u32,
    block_events_after_gap: u32,
    free_events_after_gap: u32,
    /// `inf` for a cell that never changed.
    interval_s: Number,
    rate_hz: Number,
    /// The ends of the 90 % credible interval of the rate; the upper one is `inf` before the second reading.
    rate_low_hz: Number,
    rate_high_hz: Number,
    change_probability: Number,
    recency_s: Number,
}

/// A number as the standard library prints it: the shortest digits that give the same value. The standard library is
/// optimized in every build, unlike the package that prints the numbers of the `csv` crate.
struct Number(f64);

impl serde::Serialize for Number {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&format_args!("{:?}", self.0))
    }
}

/// Writes a CSV file with one row for every cell that was seen at least once, row by row from the lower left.
///
/// # Errors
///
/// When the file cannot be written.
pub fn write(path: &Path, mapper: &Mapper, intervals: &Intervals) -> Result<(), OutputError> {
    write_file(path, |file| {
        let mut table = csv::Writer::from_writer(file);
        for (index, interval) in intervals.of_cells(mapper) {
            table.serialize(row(mapper, index, interval)).map_err(io::Error::other)?;
        }
        table.flush()
    })
}

fn row(mapper: &Mapper, index: usize, (rate_low_hz, rate_high_hz): (f64, f64)) -> Row {
    let (frame, seen) = (mapper.frame(), mapper.statistics(index));
    let cell = frame.cell(index);
    let center = frame.center(cell);
    Row {
        x_m: micro(center.x),
        y_m: micro(center.y),
        column: cell.x,
        row: cell.y,
        state: match mapper.states().cells()[index] {
            CellState::Unknown => "unknown",
            CellState::Free => "free",
            CellState::Blocked => "blocked",
        },
        first_seen_s: micro(seen.first_seen),
        last_seen_s: micro(seen.last_seen),
        unobserved_s: micro(seen.unobserved),
        watched_free_s: micro(seen.watched_free),
        watched_blocked_s: micro(seen.watched_blocked),
        block_events: seen.block_events,
        free_events: seen.free_events,
        block_events_after_gap: seen.block_events_after_gap,
        free_events_after_gap: seen.free_events_after_gap,
        interval_s: micro(mapper.interval(index)),
        rate_hz: Number(mapper.rate(index)),
        rate_low_hz: Number(rate_low_hz),
        rate_high_hz: Number(rate_high_hz),
        change_probability: Number(mapper.change_probability(index)),
        recency_s: micro(mapper.recency(index)),
    }
}

fn micro(value: f64) -> Number {
    Number(rounded(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::World;
    use mapper::MapperSettings;
    use sim::physics::PhysicsWorld;

    /// The map of a robot that stands still in the shipped house for a minute.
    fn mapper() -> Mapper {
        let text = include_str!("../../worlds/four_rooms.toml");
        let text = text.replacen("pose_m = [2.0, 2.0]", "pose_m = [9.0, 9.0]", 1);
        let mut world =
            PhysicsWorld::new(&worldfile::physics::parse_world("four_rooms.toml", &text).unwrap(), 0);
        let mut mapper = Mapper::new(&MapperSettings::default(), world.spec().frame).unwrap();
        for _ in 0..600 {
            mapper.update(&world.sense()).unwrap();
            world.act(&interfaces::Twist::STOP);
        }
        mapper
    }

    #[test]
    fn the_table_says_what_the_mapper_knows() {
        let mapper = mapper();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cell_statistics.csv");
        write(&path, &mapper, &Intervals::of(&mapper)).unwrap();

        let mut table = csv::Reader::from_path(&path).unwrap();
        let header = table.headers().unwrap().clone();
        let column = |name: &str| header.iter().position(|field| field == name).unwrap();
        let (mut rows, mut changed) = (0, 0);
        for record in table.records() {
            let record = record.unwrap();
            let number = |name: &str| record[column(name)].parse::<f64>().unwrap();
            let at = nalgebra::Point2::new(number("x_m"), number("y_m"));
            let cell = mapper.frame().cell_at(&at);
            assert_eq!((f64::from(cell.x), f64::from(cell.y)), (number("column"), number("row")));
            let index = mapper.frame().index(cell).unwrap();
            assert!((number("recency_s") - mapper.recency(index)).abs() < 1e-6);
            assert_eq!(number("rate_hz"), mapper.rate(index));
            assert_eq!((number("rate_low_hz"), number("rate_high_hz")), mapper.credible_interval(index, 0.9));
            assert!(number("rate_low_hz") <= number("rate_high_hz"));
            assert_eq!(number("block_events"), f64::from(mapper.statistics(index).block_events));
            assert_eq!(number("interval_s").is_infinite(), mapper.interval(index).is_infinite());
            rows += 1;
            changed += usize::from(number("interval_s").is_finite());
        }
        assert_eq!(rows, (0..mapper.frame().len()).filter(|&index| mapper.was_ever_seen(index)).count());
        assert!(rows > 10_000 && changed > 50, "{rows} {changed}");
    }
}

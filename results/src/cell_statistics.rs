//! `cell_statistics.csv`: what was learned about every cell.

use crate::numbers::rounded;
use files::{OutputError, write_file};
use interfaces::Cell;
use mapper::{CellStatistics, Mapper};
use nalgebra::Point2;
use std::path::Path;

/// The probability with which an interval contains the rate.
const CREDIBLE_MASS: f64 = 0.9;

/// A cell that was seen at least once.
struct Seen<'a> {
    mapper: &'a Mapper,
    index: usize,
    cell: Cell,
    center: Point2<f64>,
    statistics: CellStatistics,
    /// The ends of the 90 % credible interval of the rate.
    rate_hz: (f64, f64),
}

/// A column: its name, and the text of a cell. Numbers have the shortest digits that give the same value.
type Column = (&'static str, fn(&Seen) -> String);

/// The columns. Times are in seconds; `interval_s` is `inf` for a cell that never changed, `rate_high_hz` before the second reading.
const COLUMNS: [Column; 21] = [
    ("x_m", |of| micro(of.center.x)),
    ("y_m", |of| micro(of.center.y)),
    ("column", |of| of.cell.x.to_string()),
    ("row", |of| of.cell.y.to_string()),
    ("state", |of| format!("{:?}", of.mapper.states().cells()[of.index]).to_lowercase()),
    ("first_seen_s", |of| micro(of.statistics.first_seen)),
    ("last_seen_s", |of| micro(of.statistics.last_seen)),
    ("unobserved_s", |of| micro(of.statistics.unobserved)),
    ("watched_free_s", |of| micro(of.statistics.watched_free)),
    ("watched_blocked_s", |of| micro(of.statistics.watched_blocked)),
    ("block_events", |of| of.statistics.block_events.to_string()),
    ("free_events", |of| of.statistics.free_events.to_string()),
    ("block_events_after_gap", |of| of.statistics.block_events_after_gap.to_string()),
    ("free_events_after_gap", |of| of.statistics.free_events_after_gap.to_string()),
    ("interval_s", |of| micro(of.mapper.interval(of.index))),
    ("rate_hz", |of| exact(of.mapper.rate(of.index))),
    ("rate_low_hz", |of| exact(of.rate_hz.0)),
    ("rate_high_hz", |of| exact(of.rate_hz.1)),
    ("blocked_probability", |of| exact(of.mapper.blocked_probability(of.index))),
    ("change_probability", |of| exact(of.mapper.change_probability(of.index))),
    ("recency_s", |of| micro(of.mapper.recency(of.index))),
];

/// Writes a CSV file with one row for every cell that was seen at least once, row by row from the lower left.
///
/// # Errors
///
/// When the file cannot be written.
pub fn write(path: &Path, mapper: &Mapper) -> Result<(), OutputError> {
    let frame = mapper.frame();
    write_file(path, |file| {
        let mut table = csv::Writer::from_writer(file);
        table.write_record(COLUMNS.map(|(name, _)| name))?;
        for index in mapper.seen() {
            let rate_hz = mapper.credible_interval(index, CREDIBLE_MASS);
            let (cell, statistics) = (frame.cell(index), mapper.statistics(index));
            let of = Seen { mapper, index, cell, center: frame.center(cell), statistics, rate_hz };
            table.write_record(COLUMNS.map(|(_, text)| text(&of)))?;
        }
        table.flush()
    })
}

fn micro(value: f64) -> String {
    exact(rounded(value))
}

fn exact(value: f64) -> String {
    format!("{value:?}")
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
        write(&path, &mapper).unwrap();

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

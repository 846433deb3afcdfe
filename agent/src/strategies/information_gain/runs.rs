//! The cells that changed: the time that each has been in view without interruption, and its expected gains.

use super::rates::{Expected, Watched, variance};
use mapper::Mapper;

/// If a cell was in view for this share of the time between two goals, it counts as in view all the time.
const UNINTERRUPTED: f64 = 0.9;

/// A cell that changed, as known at the last goal.
#[derive(Clone, Copy, Debug)]
struct Run {
    cell: usize,
    time: f64,
    seen: Watched,
    expected: Expected,
}

/// All cells that ever changed, in the order of their first change.
#[derive(Clone, Debug, Default)]
pub(super) struct Runs(Vec<Run>);

impl Runs {
    /// Applies the observations since the last goal. `expect` computes the expectation for a cell; it is called
    /// only for cells that were observed.
    pub(super) fn update(&mut self, mapper: &Mapper, expect: impl Fn(usize, &Watched) -> Expected) {
        let now = mapper.time();
        for (index, cell) in mapper.changed().enumerate() {
            let statistics = mapper.statistics(cell);
            let mut seen = Watched {
                cycles: 0.5 * f64::from(statistics.block_events + statistics.free_events),
                time: statistics.watched_free + statistics.watched_blocked,
                estimate: mapper.rate(cell),
                run: statistics.watched_free + statistics.watched_blocked,
                past_variance: 0.0,
            };
            match self.0.get_mut(index).filter(|run| run.cell == cell) {
                Some(run) => {
                    let before = run.seen;
                    let added = seen.time - before.time;
                    (seen.run, seen.past_variance) = (before.run, before.past_variance);
                    if added > 0.0 {
                        if added >= UNINTERRUPTED * (now - run.time) {
                            seen.run += added;
                        } else {
                            seen.past_variance += variance(seen.rate() * before.run);
                            seen.run = added;
                        }
                    }
                    let is_known = added == 0.0 && seen.estimate == before.estimate;
                    let expected = if is_known { run.expected } else { expect(cell, &seen) };
                    *run = Run { cell, time: now, seen, expected };
                }
                None => {
                    // The map is another one: the following entries belong to the old map.
                    self.0.truncate(index);
                    self.0.push(Run { cell, time: now, seen, expected: expect(cell, &seen) });
                }
            }
        }
    }

    /// The expectation for each cell that changed.
    pub(super) fn expected(&self) -> impl Iterator<Item = (usize, &Expected)> {
        self.0.iter().map(|run| (run.cell, &run.expected))
    }
}

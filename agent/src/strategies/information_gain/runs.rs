//! The cells that changed: for how long each has been in view on end, and what to expect of it.

use super::rates::{Expected, Watched, variance};
use mapper::Mapper;

/// Of the time between two goals, a cell in view for this share was in view all the time.
const ON_END: f64 = 0.9;

/// A cell that changed, as it was at the last goal.
#[derive(Clone, Copy, Debug)]
struct Run {
    cell: usize,
    time: f64,
    seen: Watched,
    expected: Expected,
}

/// All cells that ever changed, in the order in which they first did.
#[derive(Clone, Debug, Default)]
pub(super) struct Runs(Vec<Run>);

impl Runs {
    /// Takes in what was seen since the last goal; `expect` says what to expect of a cell, and is only
    /// asked of cells that were seen.
    pub(super) fn update(&mut self, mapper: &Mapper, expect: impl Fn(usize, &Watched) -> Expected) {
        let now = mapper.time();
        for (place, cell) in mapper.changed().enumerate() {
            let statistics = mapper.statistics(cell);
            let mut seen = Watched {
                cycles: 0.5 * f64::from(statistics.block_events + statistics.free_events),
                time: statistics.watched_free + statistics.watched_blocked,
                estimate: mapper.rate(cell),
                run: statistics.watched_free + statistics.watched_blocked,
                past_variance: 0.0,
            };
            match self.0.get_mut(place).filter(|run| run.cell == cell) {
                Some(run) => {
                    let before = run.seen;
                    let added = seen.time - before.time;
                    (seen.run, seen.past_variance) = (before.run, before.past_variance);
                    if added > 0.0 {
                        if added >= ON_END * (now - run.time) {
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
                    // Another map: what follows belongs to the old one.
                    self.0.truncate(place);
                    self.0.push(Run { cell, time: now, seen, expected: expect(cell, &seen) });
                }
            }
        }
    }

    /// What to expect of each cell that changed.
    pub(super) fn expected(&self) -> impl Iterator<Item = (usize, &Expected)> {
        self.0.iter().map(|run| (run.cell, &run.expected))
    }
}

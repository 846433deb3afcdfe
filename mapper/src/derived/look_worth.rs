//! What a look is worth to the predicted map: at things that are known, and where things may be that are not.

use crate::Mapper;
use crate::change::{Evidence, Fading, Posterior, TransitionRates};
use interfaces::CellState;
use std::collections::BTreeMap;

/// A cell that changes and belongs to nothing counts as its share of a thing of this area, m².
const THING_M2: f64 = 0.25;
/// Before the first look, one thing is expected on this area, m².
const AREA_M2: f64 = 16.0;
/// The ratio of one time to the next for which the worth of a look at a place without a known thing is computed.
const RATIO: f64 = 1.5;

impl Mapper {
    /// What a look is worth now at each cell that ever changed, by index, in units of time: by how much it reduces the Brier score of
    /// the predicted map, integrated until the next look, if that comes as late after this one as this one after the last.
    ///
    /// A door, or an object that comes and goes, counts as one, whatever its size: its cells share its worth.
    pub fn look_worths(&self) -> impl Iterator<Item = (usize, f64)> {
        let mut of_things = BTreeMap::<(bool, u32), f64>::new();
        self.changed().map(move |index| {
            let worth = match self.thing(index) {
                Some(thing) => {
                    let worth = of_things
                        .entry((thing.clock.is_some(), thing.number))
                        .or_insert_with(|| thing.look_worth(self.time()));
                    *worth / thing.cells as f64
                }
                None => self.part_of_thing() * self.look_worth_of_cell(index),
            };
            (index, worth)
        })
    }

    /// The part of a thing that a cell is that belongs to none.
    fn part_of_thing(&self) -> f64 {
        (self.frame().resolution_m() * self.frame().resolution_m() / THING_M2).min(1.0)
    }

    /// What a look at a cell of no thing is worth, by what is known of it alone, or by its chain.
    fn look_worth_of_cell(&self, index: usize) -> f64 {
        let elapsed = self.recency(index);
        if let Some(evidence) = self.changed_out_of_view(index) {
            let posterior = Posterior::new(&evidence, &self.things.objects.population);
            return posterior.fading().look_worth(self.cells.state(index) == CellState::Blocked, elapsed);
        }
        let Some(TransitionRates { block, free, .. }) = self.cells.transition_rates(index) else {
            return 0.0;
        };
        let (blocked, twice) = (self.blocked_probability(index), 2.0 * (block + free));
        let remembered =
            if twice * elapsed < 1e-9 { elapsed } else { -libm::expm1(-twice * elapsed) / twice };
        blocked * (1.0 - blocked) * remembered
    }

    /// What is known of things that the map does not know yet. One pass over the map.
    pub fn undiscovered(&self) -> Undiscovered {
        let posterior = Posterior::new(&Evidence::default(), &self.things.objects.population);
        let mut undiscovered =
            Undiscovered { per_cell: 0.0, silent: Vec::new(), fading: posterior.fading().clone() };
        let (mut found, mut searched) = (self.things.count() as f64, 0.0);
        for cell in self.seen().filter(|cell| self.is_candidate(*cell)) {
            if self.cells.has_changed(cell) {
                searched += 1.0;
                found += if self.thing(cell).is_none() { self.part_of_thing() } else { 0.0 };
            } else {
                searched += 1.0 - undiscovered.silent(self.cells.known_for(cell)).probability;
            }
        }
        let area = AREA_M2 / (self.frame().resolution_m() * self.frame().resolution_m());
        undiscovered.per_cell = ((found + 1.0) / (searched + area)).min(1.0);
        undiscovered
    }
}

/// Things that a map does not know yet: how many there may be, and what a look at them is worth.
#[derive(Clone, Debug)]
pub struct Undiscovered {
    /// The number of things per cell, those that are known included: as many as were found, divided by the number of cells where one
    /// would have been found by now (an estimate of Horvitz and Thompson).
    per_cell: f64,
    /// By the time without a change, in steps of [`RATIO`].
    silent: Vec<Option<Silent>>,
    fading: Fading,
}

/// A thing that did not change for a time, which has this probability.
#[derive(Clone, Debug)]
struct Silent {
    probability: f64,
    fading: Fading,
    /// What a look is worth, by the time since the last one, in steps of [`RATIO`].
    worths: Vec<Option<f64>>,
}

fn step(time: f64) -> usize {
    (libm::log1p(time.max(0.0)) / libm::log(RATIO)).round() as usize
}

fn time(step: usize) -> f64 {
    libm::expm1(step as f64 * libm::log(RATIO))
}

fn of_step<T: Clone>(list: &mut Vec<Option<T>>, step: usize, make: impl FnOnce() -> T) -> &mut T {
    if list.len() <= step {
        list.resize(step + 1, None);
    }
    list[step].get_or_insert_with(make)
}

impl Undiscovered {
    fn silent(&mut self, silent_for: f64) -> &mut Silent {
        let step = step(silent_for);
        let Self { silent, fading, .. } = self;
        of_step(silent, step, || {
            let (fading, probability) = fading.after_silence(time(step));
            Silent { probability, fading, worths: Vec::new() }
        })
    }

    /// What a look is worth at a cell that never changed, this time after the last one, as [`Mapper::look_worths`]. A time out of view
    /// counts as one without a change where the cell is the same after it.
    pub fn look_worth(&mut self, mapper: &Mapper, index: usize, elapsed: f64) -> f64 {
        self.worth(mapper.cells.known_for(index), elapsed)
    }

    fn worth(&mut self, silent_for: f64, elapsed: f64) -> f64 {
        let per_cell = self.per_cell;
        let Silent { probability, fading, worths } = self.silent(silent_for);
        let step = step(elapsed);
        let worth = of_step(worths, step, || fading.look_worth(false, time(step)));
        *worth * per_cell * *probability / (per_cell * *probability + 1.0 - per_cell)
    }

    /// What the first look at a cell is worth if the next one comes after this time.
    pub fn first_look_worth(&self, until_next: f64) -> f64 {
        let share = self.fading.share();
        self.per_cell * share * (1.0 - share) * self.fading.remembered_s(until_next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MapperSettings;
    use interfaces::{Cell, CellReading, GridFrame};
    use nalgebra::{Isometry2, Point2};
    use rand::RngExt;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;

    /// A tenth of the cells are things; half of them change too rarely to be found.
    #[test]
    fn things_that_have_not_changed_yet_are_expected() {
        let side = 50;
        let frame = GridFrame::new(Point2::origin(), 1.0, side, side).unwrap();
        let mut mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let things = side * side / 10;
        // Mean stays from 10 s to 12 h, as in the shipped population.
        let mut chains: Vec<([f64; 2], bool)> = (0..things)
            .map(|_| {
                let stays =
                    [(); 2].map(|()| libm::exp(rng.random_range(libm::log(10.0)..libm::log(43_200.0))));
                (stays, rng.random::<f64>() < stays[1] / (stays[0] + stays[1]))
            })
            .collect();
        for look in 0..120 {
            let cells = (0..side * side).map(|cell| {
                let is_there = cell % 10 == 0 && chains[cell / 10].1;
                (Cell::new((cell % side) as i32, (cell / side) as i32), is_there)
            });
            let time = 30.0 * f64::from(look);
            mapper
                .update(&CellReading { time, pose: Isometry2::identity(), cells: cells.collect() })
                .unwrap();
            for ([away_s, there_s], is_there) in &mut chains {
                let (rate, share) = (1.0 / *away_s + 1.0 / *there_s, *there_s / (*away_s + *there_s));
                let later = share + (f64::from(u8::from(*is_there)) - share) * libm::exp(-rate * 30.0);
                *is_there = rng.random::<f64>() < later;
            }
        }
        let found = mapper.changed().count();
        assert!((60..190).contains(&found), "{found} of {things} were seen to change");
        let per_cell = mapper.undiscovered().per_cell;
        assert!((0.05..0.2).contains(&per_cell), "{per_cell}");

        let mut undiscovered = mapper.undiscovered();
        let worths = [10.0, 100.0, 1000.0].map(|elapsed| undiscovered.worth(500.0, elapsed));
        assert!(worths.is_sorted() && worths[0] > 0.0, "{worths:?}");
        assert!(undiscovered.worth(5000.0, 100.0) < worths[1]);
        assert!(undiscovered.first_look_worth(100.0) > undiscovered.worth(100.0, 100.0));
    }
}

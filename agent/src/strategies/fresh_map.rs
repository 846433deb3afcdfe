use super::best_trip::{Elapsed, Worth};
use super::coverage::known;
use mapper::Mapper;

/// The worth of a look is how much it takes from the Brier score of the predicted map until the next look: the strategy `fresh-map`
/// keeps the predicted map right.
///
/// Things that the map knows are worth what [`Mapper::look_worths`] says. There may be as many per area where nothing changed so far
/// ([`Mapper::undiscovered`]), the less probably the longer nothing did, and where nothing was seen yet.
#[derive(Clone, Copy, Debug)]
pub struct Brier;

impl Worth for Brier {
    fn name(&self) -> &'static str {
        "fresh-map"
    }

    fn of_looks(&self, mapper: &Mapper, elapsed: Elapsed, take: &mut dyn FnMut(usize, f64)) -> f64 {
        let mut has_changed = vec![false; mapper.frame().len()];
        for (cell, worth) in mapper.look_worths() {
            has_changed[cell] = true;
            let since = mapper.recency(cell);
            // A thing that should have been seen is worth as little as one that was.
            let part = if since > 0.0 { (elapsed(cell) / since).clamp(0.0, 1.0) } else { 0.0 };
            take(cell, worth * part);
        }
        let mut undiscovered = mapper.undiscovered();
        for cell in known(mapper).filter(|cell| !has_changed[*cell]) {
            take(cell, undiscovered.look_worth(mapper, cell, elapsed(cell)));
        }
        undiscovered.first_look_worth(mapper.time())
    }
}

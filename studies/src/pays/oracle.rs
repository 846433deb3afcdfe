use agent::{Elapsed, Worth};
use interfaces::CellState;
use mapper::Mapper;

/// Keeps the predicted map right as `fresh-map`, with the true rates of all things that were seen. Of things that were never seen it
/// knows how many there are.
#[derive(Clone, Debug)]
pub struct Oracle {
    /// The cells of each thing in the map, and its mean stays, away and there, s.
    pub things: Vec<(Vec<usize>, [f64; 2])>,
}

/// The probability that a chain is in the second state, this time after a look, s, and ∫ρ² as long after it.
fn later([away_s, there_s]: [f64; 2], was_there: bool, elapsed_s: f64) -> (f64, f64) {
    let (share, rate) = (there_s / (away_s + there_s), 1.0 / away_s + 1.0 / there_s);
    let there = share + (f64::from(u8::from(was_there)) - share) * libm::exp(-rate * elapsed_s);
    (there, -libm::expm1(-2.0 * rate * elapsed_s) / (2.0 * rate))
}

impl Worth for Oracle {
    fn name(&self) -> &'static str {
        "oracle"
    }

    fn of_looks(&self, mapper: &Mapper, elapsed: Elapsed, take: &mut dyn FnMut(usize, f64)) -> f64 {
        let states = mapper.states().cells();
        let mut first = 0.0;
        for (cells, stays_s) in &self.things {
            let seen = cells.iter().filter(|cell| states[**cell] != CellState::Unknown);
            let last = seen.min_by(|a, b| mapper.recency(**a).total_cmp(&mapper.recency(**b)));
            let Some(last) = last.copied() else {
                let (there, remembered_s) = later(*stays_s, false, mapper.time());
                first += there * (1.0 - there) * remembered_s;
                continue;
            };
            let was_there = cells.iter().any(|cell| {
                states[*cell] == CellState::Blocked && mapper.recency(*cell) <= mapper.recency(last) + 1.0
            });
            let (there, remembered_s) = later(*stays_s, was_there, elapsed(last));
            let worth = there * (1.0 - there) * remembered_s / cells.len() as f64;
            cells.iter().for_each(|cell| take(*cell, worth));
        }
        let unseen = states.iter().filter(|state| **state == CellState::Unknown).count();
        first / unseen.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_chain_remembers() {
        let (there, remembered_s) = later([30.0, 10.0], true, 1e9);
        assert!((there - 0.25).abs() < 1e-12 && (remembered_s - 3.75).abs() < 1e-9);
        let (there, remembered_s) = later([30.0, 10.0], false, 1e-3);
        assert!(there < 1e-4 && (remembered_s - 1e-3).abs() < 1e-6);
    }
}

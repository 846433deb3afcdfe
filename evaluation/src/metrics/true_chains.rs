use interfaces::{GroundTruth, TrueState};
use std::collections::BTreeMap;

/// The two-state Markov chains of all cells, with the true rates so far: the reference for predictions.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct TrueChains {
    /// Of each cell that has changed, by its index.
    chains: BTreeMap<usize, TrueChain>,
}

/// The true states of one cell so far. The time in which the cell is partly covered does not count.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
struct TrueChain {
    state: TrueState,
    /// The time of the last change.
    #[serde(with = "interfaces::serde_time")]
    since: f64,
    /// The last state that was not partly covered.
    last: Option<usize>,
    /// The time free, and blocked, up to `since`.
    #[serde(with = "interfaces::serde_time")]
    times: [f64; 2],
    /// The number of times that the cell left the state free, and the state blocked, for the other.
    events: [u32; 2],
}

/// The index of a state in the arrays of a chain; `None` for a partly covered cell.
fn state_index(state: TrueState) -> Option<usize> {
    match state {
        TrueState::Free => Some(0),
        TrueState::Blocked => Some(1),
        TrueState::PartlyCovered => None,
    }
}

impl TrueChain {
    /// A cell that has been in a state since the start.
    fn constant(state: TrueState) -> Self {
        Self { state, since: 0.0, last: state_index(state), times: [0.0; 2], events: [0; 2] }
    }

    /// Adds the time up to `now` to the present state.
    fn pass_to(&mut self, now: f64) {
        if let Some(state) = state_index(self.state) {
            self.times[state] += now - self.since;
        }
        self.since = now;
    }

    fn change(&mut self, time: f64, after: TrueState) {
        self.pass_to(time);
        self.state = after;
        let Some(entered) = state_index(after) else { return };
        if let Some(left) = self.last.replace(entered).filter(|&left| left != entered) {
            self.events[left] += 1;
        }
    }
}

impl TrueChains {
    /// Adds the true changes since the last command: called once per reading.
    pub fn observe(&mut self, truth: &impl GroundTruth) {
        for change in truth.changes() {
            let Some(index) = truth.frame().index(change.cell) else { continue };
            let chain = self.chains.entry(index).or_insert_with(|| TrueChain::constant(change.before));
            chain.change(change.time, change.after);
        }
    }

    /// The probability that a cell is blocked now, `elapsed` after its state was seen: `seen` is 1 for blocked and 0 for
    /// free. The probability goes from `seen` to the true share of the time that the cell is blocked, with the sum of
    /// the true rates. A state that the cell never has is left at once.
    pub(super) fn blocked_probability(
        &self,
        truth: &impl GroundTruth,
        index: usize,
        seen: f64,
        elapsed: f64,
    ) -> f64 {
        let known = self.chains.get(&index).copied();
        let mut chain = known.unwrap_or_else(|| TrueChain::constant(truth.state(index)));
        chain.pass_to(truth.elapsed());
        let [free, blocked] = chain.times;
        if free + blocked <= 0.0 {
            return seen;
        }
        let leave = |state: usize| f64::from(chain.events[state]) / chain.times[state];
        let memory =
            if free > 0.0 && blocked > 0.0 { libm::exp(-(leave(0) + leave(1)) * elapsed) } else { 0.0 };
        let share = blocked / (free + blocked);
        share + (seen - share) * memory
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use TrueState::{Blocked, Free, PartlyCovered};
    use interfaces::{Cell, GridFrame, TrueChange};
    use nalgebra::Point2;
    use std::borrow::Cow;

    /// One cell, of which only the state, the time and the changes matter.
    struct OneCell {
        frame: GridFrame,
        now: f64,
        changes: Vec<TrueChange>,
    }

    impl GroundTruth for OneCell {
        fn frame(&self) -> &GridFrame {
            &self.frame
        }

        fn elapsed(&self) -> f64 {
            self.now
        }

        fn state(&self, _: usize) -> TrueState {
            self.changes.last().map_or(Free, |change| change.after)
        }

        fn can_be_seen(&self, _: usize) -> bool {
            true
        }

        fn block_events(&self, _: usize) -> u32 {
            0
        }

        fn is_swept(&self, _: usize) -> bool {
            true
        }

        fn moving_things(&self) -> Cow<'_, [Vec<usize>]> {
            Cow::Borrowed(&[])
        }

        fn changes(&self) -> &[TrueChange] {
            &self.changes
        }
    }

    fn predicted(changes: &[(f64, TrueState, TrueState)], now: f64, seen: f64, elapsed: f64) -> f64 {
        let frame = GridFrame::new(Point2::origin(), 1.0, 1, 1).unwrap();
        let change = |&(time, before, after)| TrueChange { time, cell: Cell::new(0, 0), before, after };
        let truth = OneCell { frame, now, changes: changes.iter().map(change).collect() };
        let mut chains = TrueChains::default();
        chains.observe(&truth);
        chains.blocked_probability(&truth, 0, seen, elapsed)
    }

    #[test]
    fn a_chain_has_the_true_rates_and_the_true_share() {
        // Free for 30 s and blocked for 10 s, twice; partly covered for 2 s at every change.
        let changes = [
            (30.0, Free, PartlyCovered),
            (32.0, PartlyCovered, Blocked),
            (42.0, Blocked, PartlyCovered),
            (44.0, PartlyCovered, Free),
            (74.0, Free, PartlyCovered),
            (76.0, PartlyCovered, Blocked),
            (86.0, Blocked, PartlyCovered),
            (88.0, PartlyCovered, Free),
        ];
        let sum = 2.0 / 60.0 + 2.0 / 20.0;
        for (seen, elapsed) in [(0.0_f64, 0.5_f64), (1.0, 5.0), (1.0, 500.0)] {
            let expected = 0.25 + (seen - 0.25) * (-sum * elapsed).exp();
            assert!((predicted(&changes, 88.0, seen, elapsed) - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn a_state_that_a_cell_never_has_is_left_at_once() {
        let changes = [(30.0, Free, PartlyCovered), (32.0, PartlyCovered, Free)];
        assert_eq!(predicted(&changes, 40.0, 1.0, 0.1), 0.0);
        assert_eq!(predicted(&[], 40.0, 1.0, 0.1), 0.0);
    }
}

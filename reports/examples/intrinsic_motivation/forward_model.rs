//! A model of the world that learns to predict the next reading: a two-state Markov chain per cell.

/// The chain of one cell.
#[derive(Clone, Copy, Debug, Default)]
struct Chain {
    /// When it was last seen, and whether it was blocked.
    last: Option<(f64, bool)>,
    /// Steps in view from free and from blocked, and how many of them changed the state.
    steps: [f64; 2],
    changes: [f64; 2],
}

/// The chains of all cells.
#[derive(Clone, Debug)]
pub(crate) struct ForwardModel(Vec<Chain>);

impl ForwardModel {
    pub(crate) fn new(cells: usize) -> Self {
        Self(vec![Chain::default(); cells])
    }

    /// The probability that a cell is blocked at a time; ½ before it was ever seen.
    pub(crate) fn predicted(&self, cell: usize, time: f64) -> f64 {
        let chain = &self.0[cell];
        let Some((last, is_blocked)) = chain.last else { return 0.5 };
        // The Krichevsky–Trofimov estimate: ½ before the first step.
        let [block, free] = [0, 1].map(|from| (chain.changes[from] + 0.5) / (chain.steps[from] + 1.0));
        let stationary = block / (block + free);
        let steps = (time - last).clamp(0.0, 1e6) as i32;
        stationary + (f64::from(u8::from(is_blocked)) - stationary) * (1.0 - block - free).powi(steps)
    }

    /// Learns from a cell in a reading. Returns the squared error of the prediction before.
    pub(crate) fn learn(&mut self, cell: usize, is_blocked: bool, time: f64) -> f64 {
        let error = self.predicted(cell, time) - f64::from(u8::from(is_blocked));
        let chain = &mut self.0[cell];
        // What happened in a gap is not counted, as with the paper's estimator.
        if let Some((last, was_blocked)) = chain.last
            && time - last <= 1.0
        {
            let from = usize::from(was_blocked);
            chain.steps[from] += 1.0;
            chain.changes[from] += f64::from(u8::from(was_blocked != is_blocked));
        }
        chain.last = Some((time, is_blocked));
        error * error
    }
}

use super::map::is_correct;
use super::mean::Mean;
use interfaces::{CellState, GroundTruth, TrueState};
use mapper::Mapper;

/// The accuracy of the map on swept cells, sampled over a part of a run: such cells are few, and at a single
/// instant all of them can be correct or incorrect.
#[derive(Clone, Copy, Debug, Default)]
pub struct ChangingAccuracy {
    /// Of truly free and of truly blocked cells; unknown is incorrect.
    all: [Mean; 2],
    /// The same of known cells that can be seen, out of view and in view.
    known: [[Mean; 2]; 2],
}

/// Balanced accuracies: the mean of the accuracy on truly free and on truly blocked cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChangingScores {
    /// Of all swept cells; unknown is incorrect. Only one of the two accuracies where the other has no
    /// cells; `None` without cells.
    pub all: Option<f64>,
    /// Of the known cells in view that can be seen; `None` unless there are free and blocked ones.
    pub in_view: Option<f64>,
    /// The same out of view.
    pub out_of_view: Option<f64>,
}

impl ChangingAccuracy {
    /// Counts the swept cells as they are now. Partly covered cells are left out.
    pub fn sample(&mut self, mapper: &Mapper, truth: &impl GroundTruth) {
        for &index in truth.swept().iter() {
            let (mapped, true_state) = (mapper.states().cells()[index], truth.state(index));
            let Some(is_correct) = is_correct(mapped, true_state) else { continue };
            let class = usize::from(true_state == TrueState::Blocked);
            self.all[class].add_bool(is_correct);
            if mapped != CellState::Unknown && truth.can_be_seen(index) {
                self.known[usize::from(mapper.is_in_view(index))][class].add_bool(is_correct);
            }
        }
    }

    /// The accuracies over all samples.
    pub fn scores(&self) -> ChangingScores {
        let mut all = Mean::default();
        self.all.iter().for_each(|accuracy| all.add_mean(accuracy));
        let balanced = |[free, blocked]: [Mean; 2]| Some((free.get()? + blocked.get()?) / 2.0);
        let [out_of_view, in_view] = self.known.map(balanced);
        ChangingScores { all: all.get(), in_view, out_of_view }
    }
}

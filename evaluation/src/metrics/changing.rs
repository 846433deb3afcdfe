use super::map::is_correct;
use super::mean::Mean;
use interfaces::{CellState, GroundTruth, TrueState};
use mapper::Mapper;
use serde::Serialize;

/// The accuracy of the map on swept cells, sampled over a part of a run. A single sample would not be enough: swept
/// cells are few, and all of them can be correct or incorrect at the same time.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
pub struct ChangingAccuracy {
    /// Accuracy on truly free and on truly blocked cells; an unknown cell counts as incorrect.
    all: [Mean; 2],
    /// The same accuracies for known cells that can be seen: out of view, and in view.
    known: [[Mean; 2]; 2],
}

/// Balanced accuracies: the mean of the accuracy on truly free cells and the accuracy on truly blocked cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ChangingScores {
    /// The accuracy on all swept cells; an unknown cell counts as incorrect. If there are only free or only blocked
    /// cells, the accuracy on these; `None` without cells.
    #[serde(skip)]
    pub all: Option<f64>,
    /// The accuracy on known cells that can be seen and are in view (seen by the robot now); `None` unless there
    /// are free and blocked ones.
    #[serde(rename = "map_quality_changing")]
    pub in_view: Option<f64>,
    /// The accuracy on known cells that can be seen and are out of view (not seen by the robot now); `None` unless
    /// there are free and blocked ones.
    #[serde(rename = "map_quality_changing_out_of_view")]
    pub out_of_view: Option<f64>,
}

impl ChangingAccuracy {
    /// Samples the swept cells now. Partly covered cells are ignored.
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

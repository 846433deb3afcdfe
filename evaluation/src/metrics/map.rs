use super::statistics::Mean;
use interfaces::{CellState, GroundTruth, TrueState};
use mapper::Mapper;
use serde::Serialize;

/// Whether the state in the map is the true state; `None` if the cell is partly covered.
pub(super) fn is_correct(mapped: CellState, truth: TrueState) -> Option<bool> {
    match truth {
        TrueState::Free => Some(mapped == CellState::Free),
        TrueState::Blocked => Some(mapped == CellState::Blocked),
        TrueState::PartlyCovered => None,
    }
}

/// The quality of the map. Both shares are 0 in a world without cells that can be seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, Serialize)]
pub struct MapScores {
    /// The share of the cells that can be seen that have been seen.
    pub coverage: f64,
    /// The share of the cells that can be seen whose state in the map is the true state now; an unknown cell counts
    /// as incorrect.
    pub map_quality: f64,
}

fn visible_cells(truth: &impl GroundTruth) -> impl Iterator<Item = usize> {
    (0..truth.frame().len()).filter(|&index| truth.can_be_seen(index))
}

/// Compares the map with the ground truth now.
pub fn map_scores(mapper: &Mapper, truth: &impl GroundTruth) -> MapScores {
    let (mut cells, mut seen, mut correct) = (0_usize, 0_usize, 0_usize);
    for index in visible_cells(truth) {
        let state = mapper.states().cells()[index];
        cells += 1;
        seen += usize::from(mapper.was_ever_seen(index));
        correct += usize::from(is_correct(state, truth.state(index)) == Some(true));
    }
    let share = |count: usize| count as f64 / cells.max(1) as f64;
    MapScores { coverage: share(seen), map_quality: share(correct) }
}

/// The time since cells were last seen, over the cells that can be seen. A cell that was never seen counts with the
/// time since the start.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Age {
    /// The maximum, s (steps in a grid world).
    pub max_s: f64,
    /// The number of cells that were never seen.
    pub never_seen: usize,
}

/// The age of the map now: the time since its cells were last seen.
pub fn age(mapper: &Mapper, truth: &impl GroundTruth) -> Age {
    let mut age = Age::default();
    for index in visible_cells(truth) {
        age.max_s = age.max_s.max(mapper.recency(index));
        age.never_seen += usize::from(!mapper.was_ever_seen(index));
    }
    age
}

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

use super::TrialWorld;
use interfaces::{CellReading, GroundTruth, Observation, Reading, TrueState, World};
use nalgebra::Isometry2;

/// A world whose robot observes the true state of every cell at every reading, except of cells that are partly
/// covered. A map of these readings has the errors of the estimator alone: it bounds what exploration can reach.
pub(super) struct FullyObserved<W: TrialWorld>(pub(super) W::World);

/// The reading of the sensors, and the cells that are observed instead.
#[derive(Clone)]
pub(super) struct FullReading<R> {
    pub(super) of_sensors: R,
    cells: CellReading,
}

impl<R: Reading> Reading for FullReading<R> {
    fn time(&self) -> f64 {
        self.cells.time
    }

    fn pose(&self) -> &Isometry2<f64> {
        &self.cells.pose
    }

    fn observation(&self) -> Observation<'_> {
        Observation::Cells(&self.cells)
    }
}

impl<W: TrialWorld> World for FullyObserved<W> {
    type Reading = FullReading<<W::World as World>::Reading>;
    type Command = <W::World as World>::Command;

    fn sense(&mut self) -> Self::Reading {
        let of_sensors = self.0.sense();
        let truth = W::truth(&self.0);
        let frame = truth.frame();
        let observed = (0..frame.len()).filter_map(|index| match truth.state(index) {
            TrueState::PartlyCovered => None,
            state => Some((frame.cell(index), state == TrueState::Blocked)),
        });
        let cells =
            CellReading { time: of_sensors.time(), pose: *of_sensors.pose(), cells: observed.collect() };
        FullReading { of_sensors, cells }
    }

    fn poses_are_exact(&self) -> bool {
        self.0.poses_are_exact()
    }

    fn act(&mut self, command: &Self::Command) {
        self.0.act(command);
    }
}

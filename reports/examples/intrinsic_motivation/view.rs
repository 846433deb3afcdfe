//! What a learner's reward is made of: one reading, as it has entered the map.

use interfaces::{Cell, CellState, GridFrame};
use mapper::Mapper;
use nalgebra::Isometry2;

/// One reading.
#[derive(Clone, Debug)]
pub(crate) struct View {
    /// The time, steps.
    pub(crate) time: f64,
    pub(crate) frame: GridFrame,
    /// The cell of the robot.
    pub(crate) robot: Cell,
    /// The cells in view by index, and whether each is blocked.
    pub(crate) cells: Vec<(usize, bool)>,
    /// The number of known cells that changed: the map updates of the paper's reward.
    pub(crate) updates: usize,
    /// The true log error of the rates before this reading: no robot knows it, only the reference `error` is paid by it.
    pub(crate) true_error: Option<f64>,
}

impl View {
    /// The last reading of a map, made at `pose` with a sensor that reaches `reach` cells.
    pub(crate) fn new(mapper: &Mapper, pose: &Isometry2<f64>, reach: i32) -> Self {
        let frame = *mapper.frame();
        let robot = frame.cell_at(&pose.translation.vector.into());
        let around = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)));
        let in_view = around
            .filter_map(|(dx, dy)| frame.index(Cell::new(robot.x + dx, robot.y + dy)))
            .filter(|&index| mapper.is_in_view(index));
        let state = |index| (index, mapper.states().cells()[index] == CellState::Blocked);
        let updates = mapper.transitions().iter().filter(|transition| transition.event().is_some()).count();
        let (time, cells) = (mapper.time(), in_view.map(state).collect());
        Self { time, frame, robot, cells, updates, true_error: None }
    }
}

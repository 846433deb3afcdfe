use interfaces::{Cell, CellState, Grid, Transition};
use nalgebra::{Isometry2, Point2};

/// The inputs of the controller at every tick.
#[derive(Clone, Copy, Debug)]
pub struct ControlInput<'a> {
    /// The time, s; steps in a grid world.
    pub time: f64,
    /// The pose of the robot in the frame of the map, m and rad.
    pub pose: &'a Isometry2<f64>,
    /// The map after the update of this tick.
    pub map: &'a Grid<CellState>,
    /// All changes of state in this update, including first observations.
    pub transitions: &'a [Transition],
    /// The end points of the beams of this tick's reading that hit something, in the frame of the map, m. Empty if
    /// the sensor measures nothing but the states of cells.
    pub points: &'a [Point2<f64>],
}

impl ControlInput<'_> {
    /// The center of the robot, m.
    pub fn position(&self) -> Point2<f64> {
        self.pose.translation.vector.into()
    }

    /// The centroid of the cells that changed in this update, m (paper, section 2); first observations are no
    /// changes. `None` without a change.
    pub fn change(&self) -> Option<Point2<f64>> {
        let changed = self.transitions.iter().filter(|transition| transition.event().is_some());
        let centroid = Cell::centroid(changed.map(|transition| transition.cell))?;
        Some(self.map.frame().center(centroid))
    }
}

use interfaces::{Cell, CellState, Grid, Transition};
use nalgebra::{Isometry2, Point2};

/// What the controller is told at every tick.
#[derive(Clone, Copy, Debug)]
pub struct Situation<'a> {
    /// The time, s; steps in a grid world.
    pub time: f64,
    /// The robot's pose in the map's frame.
    pub pose: &'a Isometry2<f64>,
    /// The map after this tick's update.
    pub map: &'a Grid<CellState>,
    /// All state changes of this update, first sightings included.
    pub transitions: &'a [Transition],
    /// Where the beams of this tick's reading ended on something, in the map's frame, m. Empty for
    /// a sensor that has no more to tell than the map.
    pub points: &'a [Point2<f64>],
}

impl Situation<'_> {
    /// Where the robot's centre is, m.
    pub fn position(&self) -> Point2<f64> {
        self.pose.translation.vector.into()
    }

    /// The point amid the cells that changed in this update; first sightings are no changes (paper,
    /// section 2). `None` without a change.
    pub fn change(&self) -> Option<Point2<f64>> {
        let changed = self.transitions.iter().filter(|transition| transition.event().is_some());
        let centroid = Cell::centroid(changed.map(|transition| transition.cell))?;
        Some(self.map.frame().center(centroid))
    }
}

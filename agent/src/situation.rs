use crate::Features;
use interfaces::Cell;
use mapper::Mapper;
use nalgebra::Isometry2;

/// Everything that strategies and choosers may judge by at the moment when a goal is due.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Situation<'a> {
    /// The map and what is known of its changes.
    pub mapper: &'a Mapper,
    /// Where the robot believes it is, in the map's frame, m and rad.
    pub pose: &'a Isometry2<f64>,
    /// The features (p, r) of the last reading.
    pub features: Features,
    /// The time from the robot to each cell, in row-major order, in the unit of the readings'
    /// times, ∞ where no way is known. Empty unless a strategy [asks for
    /// it](crate::Strategy::needs_travel).
    pub travel: &'a [f64],
}

impl<'a> Situation<'a> {
    /// The situation of a robot at `pose`.
    pub fn new(mapper: &'a Mapper, pose: &'a Isometry2<f64>, features: Features) -> Self {
        Self { mapper, pose, features, travel: &[] }
    }

    /// The same situation with the time to each cell.
    pub fn with_travel(self, travel: &'a [f64]) -> Self {
        Self { travel, ..self }
    }

    /// The time from the robot to the cell of a number; ∞ where no way is known, or none was asked for.
    pub(crate) fn travel_to(&self, cell: usize) -> f64 {
        self.travel.get(cell).copied().unwrap_or(f64::INFINITY)
    }

    /// The cell that the robot is in; outside of the grid if the robot is.
    pub fn cell(&self) -> Cell {
        self.mapper.frame().cell_at(&self.pose.translation.vector.into())
    }
}

use interfaces::Cell;
use mapper::Mapper;
use nalgebra::Isometry2;

/// The features (p, r) by which the agent chooses a strategy (section 4).
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub struct Features {
    /// The expected number of cells that changed since they were last seen, p = Σ P(E > 0).
    pub p: f64,
    /// The longest time since a candidate cell was last seen, r = max (t_now − t_last), in the time unit of the
    /// readings.
    pub r: f64,
}

impl Features {
    /// The features after the latest reading. The computing time is proportional to the number of cells that ever
    /// changed.
    pub fn of(mapper: &mut Mapper) -> Self {
        Self { p: mapper.sum_change_probability(), r: mapper.max_recency() }
    }
}

/// The inputs of strategies and choosers when a goal must be selected.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Situation<'a> {
    /// The map and the change statistics.
    pub mapper: &'a Mapper,
    /// The estimated pose of the robot in the frame of the map, m and rad.
    pub pose: &'a Isometry2<f64>,
    /// The features (p, r) after the latest reading.
    pub features: Features,
    /// The travel time from the robot to each cell, in row-major order, in the time unit of the readings; ∞ where
    /// no path is known. Empty unless a strategy [needs travel times](crate::Strategy::needs_travel).
    pub travel: &'a [f64],
}

impl<'a> Situation<'a> {
    /// The situation of a robot at `pose`.
    pub fn new(mapper: &'a Mapper, pose: &'a Isometry2<f64>, features: Features) -> Self {
        Self { mapper, pose, features, travel: &[] }
    }

    /// The same situation with the travel time to each cell.
    pub fn with_travel(self, travel: &'a [f64]) -> Self {
        Self { travel, ..self }
    }

    /// The travel time from the robot to a cell, by index; ∞ if no path is known, or if travel times were not
    /// computed.
    pub fn travel_to(&self, index: usize) -> f64 {
        self.travel.get(index).copied().unwrap_or(f64::INFINITY)
    }

    /// The cell of the robot; outside of the grid if the robot is outside.
    pub fn cell(&self) -> Cell {
        self.mapper.frame().cell_at(&self.pose.translation.vector.into())
    }
}

/// Computes the travel time to each cell. Called once per goal, for strategies that need travel times.
pub trait Travel {
    /// Writes the travel time from the robot to each cell, in row-major order, in the time unit of the readings; ∞
    /// where no path is known.
    fn times(&mut self, mapper: &Mapper, pose: &Isometry2<f64>, times: &mut Vec<f64>);
}

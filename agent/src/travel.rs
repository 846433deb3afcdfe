use mapper::Mapper;
use nalgebra::Isometry2;

/// How long the robot takes to get to places. Only strategies that weigh the way ask for it, once
/// per goal.
pub trait Travel {
    /// Writes the time from where the robot is to each cell, in row-major order and in the unit of
    /// the readings' times; ∞ where no way is known.
    fn times(&mut self, mapper: &Mapper, pose: &Isometry2<f64>, times: &mut Vec<f64>);
}

/// Straight ahead through everything, one metre per unit of time: for whoever has no planner.
#[derive(Clone, Copy, Debug, Default)]
pub struct AsTheCrowFlies;

impl Travel for AsTheCrowFlies {
    fn times(&mut self, mapper: &Mapper, pose: &Isometry2<f64>, times: &mut Vec<f64>) {
        let frame = mapper.frame();
        let from = pose.translation.vector.into();
        let time = |index| nalgebra::distance(&frame.center(frame.cell(index)), &from);
        times.clear();
        times.extend((0..frame.len()).map(time));
    }
}

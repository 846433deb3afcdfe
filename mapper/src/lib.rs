//! Laser → point cloud → occupancy grid → per-cell change statistics → maps of rate, interval,
//! change probability and recency (paper, section 3).
//!
//! [`Mapper::update`] takes one reading; everything else reads what was learned. Work per reading
//! is in proportion to the cells that the reading touches and the cells that ever changed, not to
//! the map.

mod chain;
mod credible;
mod estimator;
mod exact;
mod footprint;
mod gamma;
mod gaps;
mod ledger;
mod naive;
mod outline;
mod projection;
mod settings;
mod statistics;
mod steady;

pub use estimator::Estimator;
pub use settings::{MapperSettings, OccupancyModel, SettingsError, SteadySettings};
pub use statistics::{CellStatistics, GapWorth};

use interfaces::{CellState, Grid, GridFrame, LaserReading, Reading, ScanError, Transition};
use ledger::Ledger;
use naive::Naive;
use nalgebra::{Isometry2, Point2};
use projection::{FARTHEST_M, PointCloud};
use steady::Steady;

/// Why a reading was refused. The maps stay as they were.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReadingError {
    /// The scan's figures make no sense.
    #[error(transparent)]
    Scan(#[from] ScanError),
    /// The time is not a number, or lies before that of the last reading.
    #[error("a reading at {time} follows one at {last}: time must not go backwards")]
    Time {
        /// The refused reading's time.
        time: f64,
        /// The time of the last reading that was taken.
        last: f64,
    },
    /// A pose is not a number, or farther away than a million metres.
    #[error("the pose of the reading at {time} is not a place on the map's plane")]
    Pose {
        /// The refused reading's time.
        time: f64,
    },
}

/// Refuses what cannot be a pose: a figure that is not finite, a rotation that is none, a place beyond
/// every map.
fn check_pose(pose: &Isometry2<f64>, time: f64) -> Result<(), ReadingError> {
    let is_near = [pose.translation.x, pose.translation.y].iter().all(|at| at.abs() <= FARTHEST_M);
    let is_rotation = (pose.rotation.norm_sqr() - 1.0).abs() < 1e-3;
    if is_near && is_rotation { Ok(()) } else { Err(ReadingError::Pose { time }) }
}

/// A reading that a mapper can learn from.
pub trait Evidence: Reading {
    /// Checks the reading and hands it to the mapper's fitting step.
    ///
    /// # Errors
    ///
    /// When the reading makes no sense; the mapper is then unchanged.
    fn enter(&self, mapper: &mut Mapper) -> Result<(), ReadingError>;
}

#[derive(Clone, Debug)]
enum Occupancy {
    Steady(Box<Steady>),
    Naive(Naive),
}

/// A map of a changing place and what is known of its changes.
#[derive(Clone, Debug)]
pub struct Mapper {
    ledger: Ledger,
    occupancy: Occupancy,
    cloud: PointCloud,
    points: Vec<Point2<f64>>,
}

impl Mapper {
    /// A mapper that knows nothing of the cells of `frame`.
    ///
    /// # Errors
    ///
    /// When a setting contradicts itself or another.
    pub fn new(settings: &MapperSettings, frame: GridFrame) -> Result<Self, SettingsError> {
        Self::with_prior(settings, Grid::filled(frame, CellState::Unknown))
    }

    /// A mapper that starts from a known map. Its cells count as last seen at time 0.
    ///
    /// # Errors
    ///
    /// When a setting contradicts itself or another.
    pub fn with_prior(settings: &MapperSettings, prior: Grid<CellState>) -> Result<Self, SettingsError> {
        settings.check()?;
        let mut ledger = Ledger::new(prior, settings.estimator, settings.max_gap);
        let occupancy = match settings.occupancy {
            OccupancyModel::Steady => {
                Occupancy::Steady(Box::new(Steady::new(settings.steady.clone(), &mut ledger)))
            }
            OccupancyModel::Naive => Occupancy::Naive(Naive::new(&ledger)),
        };
        Ok(Self { ledger, occupancy, cloud: PointCloud::default(), points: Vec::new() })
    }

    /// Learns from one reading.
    ///
    /// # Errors
    ///
    /// When the reading makes no sense; the maps then stay as they were.
    pub fn update(&mut self, reading: &impl Evidence) -> Result<(), ReadingError> {
        let (time, last) = (reading.time(), self.ledger.now());
        if !time.is_finite() || time < last {
            return Err(ReadingError::Time { time, last });
        }
        check_pose(reading.pose(), time)?;
        reading.enter(self)
    }

    /// Where the map lies.
    pub fn frame(&self) -> &GridFrame {
        self.ledger.frame()
    }

    /// The map.
    pub fn states(&self) -> &Grid<CellState> {
        self.ledger.states()
    }

    /// The cells that took another state in the last update, in the order in which they did.
    pub fn transitions(&self) -> &[Transition] {
        self.ledger.transitions()
    }

    /// The end points of the last laser scan's hits in the map's frame, m.
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// The time of the last reading.
    pub fn time(&self) -> f64 {
        self.ledger.now()
    }

    /// The number of readings so far.
    pub fn readings(&self) -> usize {
        self.ledger.readings()
    }

    /// The estimator in use.
    pub fn estimator(&self) -> Estimator {
        self.ledger.estimator()
    }

    /// The change statistics of the cell at a place in row-major order.
    #[inline]
    pub fn statistics(&self, index: usize) -> CellStatistics {
        self.ledger.statistics(index)
    }

    /// Whether a reading ever saw the cell.
    pub fn was_ever_seen(&self, index: usize) -> bool {
        self.ledger.ever_seen(index)
    }

    /// Whether the last reading saw the cell.
    #[inline]
    pub fn is_in_view(&self, index: usize) -> bool {
        self.ledger.was_seen_now(index)
    }

    /// Whether the cell can be a goal: it is free, or touches a free cell by a side. The inside of
    /// a wall never is.
    #[inline]
    pub fn is_candidate(&self, index: usize) -> bool {
        self.ledger.is_candidate(index)
    }

    /// The places of the cells that ever changed, in the order of their first change.
    pub fn changed(&self) -> impl Iterator<Item = usize> {
        self.ledger.changed()
    }

    /// Mean time of a cycle of the cell, T of equation 1; ∞ for a cell that never changed.
    #[inline]
    pub fn interval(&self, index: usize) -> f64 {
        self.estimator().interval(&self.statistics(index))
    }

    /// Cycles of the cell per unit of time, 1/T; 0 for a cell that never changed.
    #[inline]
    pub fn rate(&self, index: usize) -> f64 {
        self.estimator().rate(&self.statistics(index))
    }

    /// The probability that the cell changed since it was last seen (equation 2).
    #[inline]
    pub fn change_probability(&self, index: usize) -> f64 {
        estimator::change_probability(self.recency(index), self.rate(index))
    }

    /// The interval that holds the cell's cycle rate with probability `mass`, as much of the rest above it as
    /// below, per unit of time: the posterior of the two-state chain, with the gaps if the estimator in
    /// use weighs them. A cell without an event has rate 0; here the prior shows, and what was seen since: the
    /// longer nothing happened, the lower the upper bound. From 0 to ∞ before the second reading.
    pub fn credible_interval(&self, index: usize, mass: f64) -> (f64, f64) {
        self.ledger.credible_interval(index, mass)
    }

    /// The rates at which the cell leaves its states, per unit of time: free → blocked (α) and
    /// blocked → free (β). A reading apart, they are probabilities of a step. None for a cell that
    /// never changed, or whose changes tell no rate by the estimator in use.
    pub fn transition_rates(&self, index: usize) -> Option<(f64, f64)> {
        self.ledger.chain(index).map(|chain| (chain.block, chain.free))
    }

    /// The probability that the cell is blocked now. A cell in view is as seen; out of view a cell that
    /// changes relaxes from its last state to its mean by the two-state chain,
    /// π + (x₀ − π) λ^t. One that never changed stays as it was last seen, and an unknown one is
    /// blocked as likely as not.
    pub fn blocked_probability(&self, index: usize) -> f64 {
        self.ledger.blocked_probability(index)
    }

    /// The time since the cell was last seen. A cell never seen counts as last seen at 0.
    #[inline]
    pub fn recency(&self, index: usize) -> f64 {
        self.ledger.now() - self.ledger.last_seen(index)
    }

    /// The sum of [`Mapper::change_probability`] over all cells: the expected number of cells that changed
    /// since they were seen. Costs time in proportion to the cells that ever changed.
    pub fn sum_change_probability(&mut self) -> f64 {
        self.ledger.sum_change_probability()
    }

    /// The largest [`Mapper::recency`] of a candidate; 0 without a candidate.
    pub fn max_recency(&mut self) -> f64 {
        self.ledger.max_recency()
    }
}

impl Evidence for LaserReading {
    fn enter(&self, mapper: &mut Mapper) -> Result<(), ReadingError> {
        check_pose(&self.mount, self.time_s)?;
        self.scan.check()?;
        let Mapper { ledger, occupancy, cloud, points } = mapper;
        ledger.open(self.time_s);
        cloud.project(self);
        points.clear();
        points.extend((0..cloud.len()).filter_map(|beam| cloud.hit(beam)));
        match occupancy {
            Occupancy::Steady(steady) => steady.update(cloud, ledger),
            Occupancy::Naive(naive) => naive.update(cloud, ledger),
        }
        Ok(())
    }
}

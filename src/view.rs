//! What a run looks like, as plain data: all that the recording and the pictures are told.

use agent::Features;
use evaluation::metrics::{MapScores, RateErrors};
use interfaces::{CellReading, LaserReading};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use robot::{Message, StrategyState};

/// The corners of a polygon, m; the last is joined to the first.
pub type Outline = Vec<Point2<f64>>;

/// What time is counted in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeUnit {
    /// Seconds of simulated time.
    #[default]
    Second,
    /// Steps of a grid world, in which nothing happens in between.
    Step,
}

impl TimeUnit {
    /// The unit as a word, as in "many seconds".
    pub fn plural(self) -> &'static str {
        match self {
            Self::Second => "seconds",
            Self::Step => "steps",
        }
    }

    /// The unit behind a number.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Second => "s",
            Self::Step => "steps",
        }
    }
}

/// What stays the same for a whole run.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// What is run, for a person: the name of the world.
    pub title: String,
    /// What kind of place it is, as in "the house".
    pub place: &'static str,
    /// What time is counted in.
    pub unit: TimeUnit,
    /// The walls.
    pub walls: Vec<Outline>,
}

/// A run at one instant.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// Simulated time, in the unit of the [`Scene`].
    pub time: f64,
    /// The number of readings so far; where time is counted in steps, that time.
    pub step: u64,
    /// The map and what was learned of its changes.
    pub mapper: &'a Mapper,
    /// What the agent judges its situation by.
    pub features: Features,
    /// Every robot, in an order that never changes.
    pub robots: &'a [RobotView<'a>],
    /// Everything that may appear, go or move and is no robot, in an order that never changes.
    pub obstacles: &'a [ObstacleView<'a>],
    /// The way that the curious robot means to take, m; empty without one.
    pub path: &'a [Point2<f64>],
    /// Where the curious robot wants to be, m.
    pub goal: Option<Point2<f64>>,
    /// How right the map is; `None` where that was not measured.
    pub scores: Option<MapScores>,
    /// How wrong the rates of change are; `None` where that is not measured.
    pub rate_errors: Option<RateErrors>,
    /// The agent's strategies, in an order that never changes; empty while a person drives.
    pub strategies: &'a [StrategyView<'a>],
    /// What happened since the last view.
    pub messages: &'a [Message],
}

impl<'a> View<'a> {
    /// What the curious robot sees.
    pub fn sight(&self) -> Option<Sight<'a>> {
        self.robots.iter().find(|robot| robot.is_curious)?.sight
    }
}

/// One robot at one instant.
#[derive(Clone, Copy, Debug)]
pub struct RobotView<'a> {
    /// Its name in the world file.
    pub name: &'a str,
    /// Where it is, m and rad.
    pub pose: Isometry2<f64>,
    /// The radius of its body, m.
    pub radius_m: f64,
    /// Whether it is the curious robot, and not part of the place.
    pub is_curious: bool,
    /// What it sees.
    pub sight: Option<Sight<'a>>,
}

/// What a robot sees.
#[derive(Clone, Copy, Debug)]
pub enum Sight<'a> {
    /// By a laser: its last scan.
    Laser(&'a LaserReading),
    /// Cell by cell.
    Cells {
        /// What it sees now.
        reading: &'a CellReading,
        /// How far it sees at most, cells.
        radius: u32,
    },
}

/// A thing that may appear, go or move.
#[derive(Clone, Copy, Debug)]
pub struct ObstacleView<'a> {
    /// Its name in the world file.
    pub name: &'a str,
    /// Its corners now, m.
    pub outline: &'a [Point2<f64>],
    /// Whether it stands there now.
    pub is_present: bool,
}

/// One strategy of the agent at one instant.
#[derive(Clone, Copy, Debug)]
pub struct StrategyView<'a> {
    /// Its name on the command line.
    pub name: &'a str,
    /// What the agent expects of it here: map updates per observation, V(p, r) of section 4.
    pub value: f64,
    /// Share of the goals so far that it chose.
    pub share: f64,
    /// Whether it chose the present goal.
    pub is_current: bool,
}

impl<'a> From<&'a StrategyState> for StrategyView<'a> {
    /// A strategy about which nothing was learned is worth nothing.
    fn from(state: &'a StrategyState) -> Self {
        let StrategyState { name, value, share, is_current } = state;
        Self { name, value: value.unwrap_or(0.0), share: *share, is_current: *is_current }
    }
}

/// Where a robot has been. Points nearer than a few centimetres to the last one are dropped, so
/// that a robot which stands still costs nothing.
#[derive(Clone, Debug)]
pub struct Trail {
    /// The robot's name.
    pub name: String,
    /// Whether it is the curious robot's.
    pub is_curious: bool,
    points: Vec<Point2<f64>>,
}

/// The distance between two points of a trail, m: half a cell of the shipped worlds.
const TRAIL_SPACING_M: f64 = 0.025;

impl Trail {
    /// A trail without a point.
    pub fn new(name: impl Into<String>, is_curious: bool) -> Self {
        Self { name: name.into(), is_curious, points: Vec::new() }
    }

    /// Appends where the robot is now, m. Returns whether it had moved far enough to be kept.
    pub fn push(&mut self, at: Point2<f64>) -> bool {
        let keep = self.points.last().is_none_or(|last| (at - last).norm() >= TRAIL_SPACING_M);
        if keep {
            self.points.push(at);
        }
        keep
    }

    /// The points from the start on, m.
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trail_keeps_the_way_and_not_the_waiting() {
        let mut trail = Trail::new("robot", true);
        for step in 0..100 {
            trail.push(Point2::new(f64::from(step) * 0.01, 0.0));
            trail.push(Point2::new(f64::from(step) * 0.01, 0.0));
        }
        assert_eq!(trail.points().len(), 34); // every 3 cm from 0 to 99 cm
        assert_eq!(trail.points()[1], Point2::new(0.03, 0.0));
    }
}

//! The state of a run at one time, as plain data: the input of the recording and of the moving picture.

use crate::scene::{Outline, RobotState};
use agent::Features;
use interfaces::LaserReading;
use mapper::Mapper;
use nalgebra::Point2;
use results::thinned::Thinned;
use robot::{Belief, Message, StrategyState, Turn};
use std::collections::VecDeque;

/// The state of a run at one time.
pub struct View<'a> {
    /// The simulated time, s.
    pub time_s: f64,
    /// The number of readings so far.
    pub step: u64,
    /// The map and the change statistics.
    pub mapper: &'a Mapper,
    /// The features by which the agent chooses a strategy.
    pub features: Features,
    /// The robots, in the order of the scene.
    pub robots: Vec<RobotState<'a>>,
    /// What the curious robot believes about its pose; `None` if its poses are exact. The map, the path and the goal are in the
    /// frame of this pose.
    pub belief: Option<&'a Belief>,
    /// The outlines of the obstacles, m, in the order of the scene; `None` for an obstacle that is absent.
    pub obstacles: Vec<Option<Outline>>,
    /// The planned path of the curious robot, m; empty without a plan.
    pub path: &'a [Point2<f64>],
    /// The position of the goal of the curious robot, m; `None` without a goal.
    pub goal: Option<Point2<f64>>,
    /// The strategies of the agent, in an order that never changes; empty without an agent.
    pub strategies: Vec<StrategyState>,
    /// The measurements against the ground truth.
    pub measured: Measured<'a>,
}

/// The measurements that an observer adds to the state of the robot.
#[derive(Clone, Copy, Default)]
pub struct Measured<'a> {
    /// The share of the cells that can be seen that was seen, and the share that is right in the map; `None` if they were not
    /// measured.
    pub coverage_and_quality: Option<[f64; 2]>,
    /// The messages since the last view.
    pub messages: &'a [Message],
}

impl<'a> View<'a> {
    /// The state of a pass over a log, in which nothing but the robot is known.
    pub fn of_log(turn: &'a Turn<LaserReading, ()>, mapper: &'a Mapper) -> Self {
        Self {
            time_s: mapper.time(),
            step: mapper.readings() as u64,
            mapper,
            features: turn.features,
            robots: vec![RobotState { pose: turn.reading.pose, sight: Some(&turn.reading) }],
            belief: None,
            obstacles: Vec::new(),
            path: &[],
            goal: None,
            strategies: Vec::new(),
            measured: Measured::default(),
        }
    }

    /// The error of the position that the curious robot believes in, m; `None` if its poses are exact.
    pub fn error_m(&self) -> Option<f64> {
        let curious = self.robots.iter().find(|robot| robot.sight.is_some())?;
        Some((self.belief?.pose.translation.vector - curious.pose.translation.vector).norm())
    }

    /// The latest scan of the curious robot.
    pub fn sight(&self) -> Option<&'a LaserReading> {
        self.robots.iter().find_map(|robot| robot.sight)
    }
}

/// The positions of a robot since the start, in bounded memory. Positions nearer than a few centimeters to the last one
/// are dropped.
#[derive(Clone, Debug, Default)]
pub struct Trail {
    points: Thinned<Point2<f64>, MAX_POINTS>,
    /// The last positions, all of them.
    recent: VecDeque<Point2<f64>>,
}

/// The minimum distance between two points of a trail, m: half a cell of the shipped worlds.
const TRAIL_SPACING_M: f64 = 0.025;
/// The maximum number of points of a whole trail: a robot that moves all the time adds 12,000 points in 20 minutes.
const MAX_POINTS: usize = 1 << 14;
/// The number of recent points.
const RECENT_POINTS: usize = 500;

/// Whether a robot has moved far enough from the `last` point of its trail for `position` to be the next point.
pub fn is_next_point(last: Option<&Point2<f64>>, position: &Point2<f64>) -> bool {
    last.is_none_or(|last| (position - last).norm() >= TRAIL_SPACING_M)
}

impl Trail {
    /// Appends the present position of the robot, m, if the robot has moved far enough.
    pub fn push(&mut self, position: Point2<f64>) {
        if is_next_point(self.recent.back(), &position) {
            self.points.push(position);
            self.recent.push_back(position);
            if self.recent.len() > RECENT_POINTS {
                self.recent.pop_front();
            }
        }
    }

    /// The positions from the start on, m; of a long run spread evenly along the trail.
    pub fn points(&self) -> &[Point2<f64>] {
        self.points.samples()
    }

    /// The last 500 positions, m; fewer at the start.
    pub fn recent(&self) -> impl Iterator<Item = Point2<f64>> {
        self.recent.iter().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trail_drops_points_while_the_robot_stands() {
        let mut trail = Trail::default();
        for step in 0..100 {
            trail.push(Point2::new(f64::from(step) * 0.01, 0.0));
            trail.push(Point2::new(f64::from(step) * 0.01, 0.0));
        }
        assert_eq!(trail.points().len(), 34); // every 3 cm from 0 to 99 cm
        assert_eq!(trail.points()[1], Point2::new(0.03, 0.0));
    }

    #[test]
    fn a_trail_of_many_hours_is_bounded() {
        let mut trail = Trail::default();
        for step in 0..1_000_000 {
            trail.push(Point2::new(f64::from(step), 0.0));
        }
        let (points, recent) = (trail.points(), Vec::from_iter(trail.recent()));
        assert!((8192..=16_384).contains(&points.len()), "{}", points.len());
        assert_eq!((points[0].x, points.last().unwrap().x), (0.0, 999_999.0));
        assert_eq!((recent.len(), recent[0].x, recent[499].x), (500, 999_500.0, 999_999.0));
    }
}

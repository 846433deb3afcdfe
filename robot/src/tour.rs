use agent::{Goal, GoalSelector, Stay, Travel};
use interfaces::{Values, value};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};

/// A list of waypoints, visited one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Tour {
    waypoints: Vec<Point2<f64>>,
    repeat: bool,
    next: usize,
}

impl Tour {
    /// A tour along `waypoints`, m. With `repeat`, the tour starts again after the last waypoint; otherwise
    /// the run ends there.
    pub fn new(waypoints: Vec<Point2<f64>>, repeat: bool) -> Self {
        Self { waypoints, repeat, next: 0 }
    }
}

impl GoalSelector for Tour {
    fn next_goal(&mut self, _: &Isometry2<f64>, _: &Mapper, _: &mut impl Travel) -> Option<Goal> {
        if self.repeat && self.next == self.waypoints.len() {
            self.next = 0;
        }
        let position = *self.waypoints.get(self.next)?;
        self.next += 1;
        Some(Goal { position, stay: Stay::Watch(0.0) })
    }

    fn values(&mut self, _: &Mapper) -> Values<'_> {
        vec![value(&mut self.next)]
    }

    fn reason(&self) -> String {
        format!("waypoint {} of {}", self.next, self.waypoints.len())
    }
}

use agent::Stay;
use controller::{Controller, Drive, Situation, Status};
use interfaces::{CellState, Grid, Values};
use nalgebra::Point2;

/// Drives the robot to goals: the controller of this project, or that of another system.
pub trait Driver {
    /// The type of the commands.
    type Command;

    /// Replaces the goal, m.
    fn set_goal(&mut self, goal: Point2<f64>, stay: Stay);

    /// Gives the goal up.
    fn cancel(&mut self);

    /// The goal, m; `None` without a goal.
    fn goal(&self) -> Option<Point2<f64>>;

    /// The command until the next reading, on the way to the goal.
    fn drive(&mut self, situation: &Situation) -> Self::Command;

    /// The command until the next reading for a robot that must not drive to its goal: it rests, or looks around.
    fn pause(&mut self, situation: &Situation, looks_around: bool) -> Self::Command;

    /// The state after the last command.
    fn status(&self) -> Status;

    /// Why the last goal was given up, in a few words.
    fn trouble(&self) -> &'static str {
        "no path leads nearer to it"
    }

    /// Writes the travel time to each cell, as [`Controller::travel_times`]. Called after [`drive`](Self::drive).
    fn travel_times(&mut self, situation: &Situation, times: &mut Vec<f64>);

    /// Plans anew: the map is another one.
    fn forget_map(&mut self);

    /// The planned path, m; empty without a path.
    fn path(&self) -> &[Point2<f64>] {
        &[]
    }

    /// Everything that a reading changes and a later reading needs, as [`Controller::values`].
    fn values(&mut self, map: &Grid<CellState>) -> Values<'_>;
}

impl<D: Drive> Driver for Controller<D> {
    type Command = D::Command;

    fn set_goal(&mut self, goal: Point2<f64>, stay: Stay) {
        match stay {
            Stay::Explore => self.set_goal(goal),
            Stay::Watch(duration) => self.watch_at(goal, duration),
        }
    }

    fn cancel(&mut self) {
        self.cancel();
    }

    fn goal(&self) -> Option<Point2<f64>> {
        self.goal().copied()
    }

    fn drive(&mut self, situation: &Situation) -> D::Command {
        self.drive(situation)
    }

    fn pause(&mut self, situation: &Situation, looks_around: bool) -> D::Command {
        self.pause(situation, looks_around)
    }

    fn status(&self) -> Status {
        self.status()
    }

    fn travel_times(&mut self, situation: &Situation, times: &mut Vec<f64>) {
        self.travel_times(situation, times);
    }

    fn forget_map(&mut self) {
        self.forget_map();
    }

    fn path(&self) -> &[Point2<f64>] {
        self.path()
    }

    fn values(&mut self, map: &Grid<CellState>) -> Values<'_> {
        self.values(map)
    }
}

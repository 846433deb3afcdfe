use interfaces::{Cell, CellState, Grid, Obstacles, Transition, Values};
use nalgebra::{Isometry2, Point2};

/// The state of a driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// There was no goal yet, or the goal was canceled.
    Idle,
    /// The robot drives to the goal.
    Travelling,
    /// The robot explores around the goal, or observes at the goal.
    Exploring,
    /// The goal is finished; the robot stops until the next goal.
    Finished(Outcome),
}

/// The outcome of a goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
pub enum Outcome {
    /// The robot reached the goal.
    Reached,
    /// The goal is blocked or hidden; the robot reached the nearest point that can be reached.
    Nearest,
    /// The goal was given up, because the robot was stuck for too long.
    GivenUp,
}

/// What others may know of a driver.
#[derive(Clone, Copy, Debug)]
pub struct DriverView<'a> {
    /// The present path, from the position where it was planned to its end, m; empty without a path.
    pub path: &'a [Point2<f64>],
    /// The last goal; `None` before the first goal, and after the goal was canceled.
    pub goal: Option<Point2<f64>>,
    /// The state after the last tick.
    pub status: Status,
    /// Why the last goal was given up, if it was.
    pub trouble: &'static str,
}

/// Drives the robot to goals: the [`Controller`](crate::Controller), or the navigation of another system.
pub trait Driver {
    /// The type of the commands.
    type Command;

    /// Sets a goal in the frame of the map, m; it replaces any other one. The robot drives there, and then explores around it,
    /// or, with `watch`, stops there for this duration, s (steps in a grid world); NaN counts as 0. A goal outside of the map
    /// is replaced by the nearest point in the map.
    fn set_goal(&mut self, goal: Point2<f64>, watch: Option<f64>);

    /// Cancels the goal; the robot stops.
    fn cancel(&mut self);

    /// What others may know of the driver.
    fn view(&self) -> DriverView<'_>;

    /// Returns the command for this tick. After a new goal was set, the method may be called again in the same
    /// tick, with the same input but without its transitions; the robot then starts without delay.
    fn drive(&mut self, input: &ControlInput) -> Self::Command;

    /// Returns the command for a tick in which the robot does not drive to its goal: it rests, or looks around.
    fn pause(&mut self, input: &ControlInput, looks_around: bool) -> Self::Command;

    /// Writes the travel time from the robot to each cell at full speed, in row-major order, s (steps in a grid
    /// world); ∞ where no path is known. Call it after [`drive`](Self::drive), which applies the changes of the
    /// map. The computing time is that of one wave over the whole map.
    fn travel_times(&mut self, input: &ControlInput, times: &mut Vec<f64>);

    /// Forgets the map: the next one is not the last one with some changes. A path to the goal is planned anew; a local
    /// exploration ends.
    fn forget_map(&mut self);

    /// Everything that a tick changes and a later tick needs: what a state file holds of the driver. `map` is the map
    /// of the last tick; what follows from it is not in the list.
    fn values(&mut self, map: &Grid<CellState>) -> Values<'_>;
}

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
    /// How long obstacles stay: the robot then waits for one that blocks its path, if the expected time is shorter so. `None`: it takes
    /// the way round at once.
    pub obstacles: Option<&'a dyn Obstacles>,
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

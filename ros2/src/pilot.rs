//! Who decides: nobody, or our agent. Who drives: someone else, our controller, or another navigation.

mod navigation;

pub(crate) use navigation::Order;

use crate::link;
use crate::parameters::{Mode, Navigator, Parameters};
use agent::{Agent, Features};
use anyhow::Context;
use controller::{ControlInput, Controller, DiffDrive, Driver, DriverView};
use interfaces::{CellState, Grid, Values};
use mapper::Mapper;
use nalgebra::Point2;
use navigation::Navigation;
use robot::{Autonomous, Belief, Message, Pilot, PilotView, Settings};

/// Decides what the robot is asked to do.
pub(crate) struct LivePilot {
    /// `None`: the robot is driven by someone else.
    explorer: Option<Autonomous<Agent, LiveDriver>>,
    /// Whether the robot waits, see [`LivePilot::resume`].
    is_paused: bool,
}

impl LivePilot {
    /// The pilot for a mode.
    ///
    /// # Errors
    ///
    /// When a parameter is out of range.
    pub(crate) fn new(parameters: &Parameters, settings: &Settings) -> anyhow::Result<Self> {
        if parameters.mode == Mode::Map {
            return Ok(Self { explorer: None, is_paused: false });
        }
        let seed = parameters.seed as u64;
        let agent = settings.agent(&parameters.policy()?, seed)?;
        let controller = settings.controller(seed).context("cannot drive this robot")?;
        let navigation = match parameters.navigator {
            Navigator::CmdVel => None,
            Navigator::Nav2 => Some(Navigation::new(true)),
            Navigator::GoalPose => Some(Navigation::new(false)),
        };
        let driver = LiveDriver { controller, navigation };
        Ok(Self { explorer: Some(Autonomous::new(agent, driver).patient()), is_paused: false })
    }

    /// Lets the robot explore, or wait.
    pub(crate) fn resume(&mut self, resume: bool) {
        self.is_paused = !resume;
        self.forget_map();
    }

    /// Takes the new state of the goal that Nav2 has.
    pub(crate) fn navigated(&mut self, news: link::Navigation) {
        let driver = self.explorer.as_mut().map(|explorer| &mut explorer.driver);
        if let Some(navigation) = driver.and_then(|driver| driver.navigation.as_mut()) {
            navigation.navigated(news);
        }
    }
}

impl Pilot for LivePilot {
    type Command = Order;

    fn command(&mut self, belief: &Belief, features: Features, mapper: &Mapper) -> Order {
        match &mut self.explorer {
            None => Order::None,
            // The node stops the robot once. Then it leaves the robot to others.
            Some(explorer) if self.is_paused => {
                explorer.driver.navigation.as_mut().map_or(Order::None, Navigation::withdraw)
            }
            Some(explorer) => explorer.command(belief, features, mapper),
        }
    }

    fn forget_map(&mut self) {
        if let Some(explorer) = &mut self.explorer {
            explorer.forget_map();
        }
    }

    fn view(&self) -> PilotView<'_> {
        self.explorer.as_ref().map(Pilot::view).unwrap_or_default()
    }

    fn take_messages(&mut self) -> Vec<Message> {
        self.explorer.as_mut().map(Pilot::take_messages).unwrap_or_default()
    }

    fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        self.explorer.as_mut().map(|explorer| explorer.values(mapper)).unwrap_or_default()
    }
}

/// Drives to the goals of our agent.
struct LiveDriver {
    /// Knows the travel times; without another navigation, it drives as well.
    controller: Controller<DiffDrive>,
    navigation: Option<Navigation>,
}

impl Driver for LiveDriver {
    type Command = Order;

    fn set_goal(&mut self, goal: Point2<f64>, watch: Option<f64>) {
        match &mut self.navigation {
            None => self.controller.set_goal(goal, watch),
            Some(navigation) => navigation.set_goal(goal, watch),
        }
    }

    fn cancel(&mut self) {
        match &mut self.navigation {
            None => self.controller.cancel(),
            Some(navigation) => navigation.cancel(),
        }
    }

    fn view(&self) -> DriverView<'_> {
        let own = self.controller.view();
        self.navigation.as_ref().map_or(own, |navigation| navigation.view(own.path))
    }

    fn drive(&mut self, input: &ControlInput) -> Order {
        match &mut self.navigation {
            None => Order::Velocity(self.controller.drive(input)),
            Some(navigation) => {
                self.controller.pause(input, false); // so that it knows the map
                navigation.drive(input)
            }
        }
    }

    fn pause(&mut self, input: &ControlInput, looks_around: bool) -> Order {
        let twist = self.controller.pause(input, looks_around);
        match &mut self.navigation {
            None => Order::Velocity(twist),
            Some(navigation) => navigation.pause(input, looks_around),
        }
    }

    fn travel_times(&mut self, input: &ControlInput, times: &mut Vec<f64>) {
        self.controller.travel_times(input, times);
    }

    fn forget_map(&mut self) {
        self.controller.forget_map();
    }

    fn values(&mut self, map: &Grid<CellState>) -> Values<'_> {
        self.controller.values(map)
    }
}

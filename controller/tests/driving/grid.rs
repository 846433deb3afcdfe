//! The same controller in a world of cells, where a command is one move to a neighbor.

use controller::{CellDrive, ControlInput, Controller, Driver, Outcome, Status};
use interfaces::{
    Cell, CellState, Grid, GridFrame, Obstacles, Purpose, RandomStream, Step, Transition, pose,
};
use nalgebra::{Isometry2, Point2};

struct World {
    map: Grid<CellState>,
    robot: Cell,
    step: u32,
    transitions: Vec<Transition>,
    patience: Option<Patience>,
}

/// Every obstacle goes after this number of steps, or is worth waiting for that long.
#[derive(Debug)]
struct Patience(f64);

impl Obstacles for Patience {
    fn cells(&self) -> Vec<Cell> {
        vec![DOOR]
    }

    fn patience(&self, cell: Cell, detour: f64) -> f64 {
        assert_eq!(cell, DOOR);
        self.0.min(detour)
    }
}

const DOOR: Cell = Cell::new(7, 0);

impl World {
    fn new(rows: &[&str]) -> Self {
        let frame = GridFrame::new(Point2::origin(), 1.0, rows[0].len(), rows.len()).unwrap();
        let mut world = Self {
            map: Grid::filled(frame, CellState::Free),
            robot: Cell::new(0, 0),
            step: 0,
            transitions: Vec::new(),
            patience: None,
        };
        for (y, row) in rows.iter().rev().enumerate() {
            for (x, character) in row.chars().enumerate() {
                let cell = Cell::new(x as i32, y as i32);
                match character {
                    '#' => *world.map.get_mut(cell).unwrap() = CellState::Blocked,
                    'R' => world.robot = cell,
                    _ => {}
                }
            }
        }
        world
    }

    fn change(&mut self, cell: Cell, after: CellState) {
        let before = std::mem::replace(self.map.get_mut(cell).unwrap(), after);
        self.transitions.push(Transition { cell, before, after });
    }

    fn input<'a>(&'a self, pose: &'a Isometry2<f64>) -> ControlInput<'a> {
        let Self { map, transitions, .. } = self;
        let obstacles = self.patience.as_ref().map(|known| known as &dyn Obstacles);
        ControlInput { time: f64::from(self.step), pose, map, transitions, points: &[], obstacles }
    }

    fn tick(&mut self, controller: &mut Controller<CellDrive>) -> Step {
        let at = self.map.frame().center(self.robot);
        let step = controller.drive(&self.input(&pose(at.x, at.y, 0.0)));
        let next = step.target(self.robot);
        assert_ne!(self.map.get(next), Some(&CellState::Blocked), "a move into something seen");
        self.robot = next;
        self.step += 1;
        self.transitions.clear();
        step
    }
}

fn controller() -> Controller<CellDrive> {
    Controller::new(CellDrive, 42, RandomStream::new(3, Purpose::Controller))
}

#[test]
fn it_takes_a_shortest_way_one_cell_per_step() {
    let mut world = World::new(&["R.......", "######..", "........"]);
    let mut controller = controller();
    controller.set_goal(Point2::new(0.5, 0.5), Some(0.0));
    let mut steps = 0;
    loop {
        let moved = world.tick(&mut controller);
        if controller.view().status == Status::Finished(Outcome::Reached) {
            break;
        }
        assert_ne!(moved, Step::Stay);
        steps += 1;
    }
    assert_eq!((world.robot, steps), (Cell::new(0, 0), 14));
}

#[test]
fn it_goes_another_way_when_a_block_stands_in_it() {
    let mut world = World::new(&["......", "R.....", "......"]);
    let mut controller = controller();
    controller.set_goal(Point2::new(5.5, 1.5), Some(0.0));
    world.tick(&mut controller);
    world.change(Cell::new(2, 1), CellState::Blocked);
    let mut steps = 1;
    while !matches!(controller.view().status, Status::Finished(_)) {
        world.tick(&mut controller);
        steps += 1;
        assert!(steps < 12);
    }
    assert_eq!(world.robot, Cell::new(5, 1));
}

#[test]
fn it_follows_a_block_one_action_per_step_up_to_the_bound() {
    let row = "................................................................";
    let mut world = World::new(&[row, row, row]);
    let mut controller = controller();
    controller.set_goal(Point2::new(1.5, 0.5), None);
    world.robot = Cell::new(0, 0);
    let (mut block, mut explored) = (3, 0);
    loop {
        let before = CellState::Free;
        world.change(Cell::new(block, 2), before);
        block += 1;
        world.change(Cell::new(block, 2), CellState::Blocked);
        world.tick(&mut controller);
        match controller.view().status {
            Status::Exploring => explored += 1,
            Status::Finished(outcome) => break assert_eq!(outcome, Outcome::Reached),
            _ => {}
        }
        assert!(world.step < 60);
    }
    assert_eq!(explored, 42);
    // As fast as the block, so no farther behind than at first.
    assert!((world.robot.x - block).abs() <= 5, "lost the block: {} {block}", world.robot.x);
}

#[test]
fn it_watches_at_a_goal_for_the_given_time() {
    let mut world = World::new(&["R....."]);
    let mut controller = controller();
    controller.set_goal(Point2::new(2.5, 0.5), Some(3.0));
    let steps: Vec<_> = (0..5).map(|_| world.tick(&mut controller)).collect();
    assert_eq!(steps, [Step::Right, Step::Right, Step::Stay, Step::Stay, Step::Stay]);
    assert_eq!(controller.view().status, Status::Exploring);
    world.tick(&mut controller);
    assert_eq!(controller.view().status, Status::Finished(Outcome::Reached));
}

#[test]
fn it_knows_how_long_it_takes_to_get_anywhere() {
    let mut world = World::new(&["..#.", "R.#.", "...."]);
    let mut controller = controller();
    world.tick(&mut controller);
    let mut times = Vec::new();
    let at = world.map.frame().center(world.robot);
    let (pose, infinity) = (pose(at.x, at.y, 0.0), f64::INFINITY);
    controller.travel_times(&world.input(&pose), &mut times);
    assert_eq!(times, [1.0, 2.0, 3.0, 4.0, 0.0, 1.0, infinity, 5.0, 1.0, 2.0, infinity, 6.0]);
}

/// The steps to a goal 13 cells ahead, if the door is closed between these steps.
fn steps_with_door(patience: Option<f64>, closed: std::ops::Range<u32>) -> u32 {
    let mut world = World::new(&["..............", ".############.", "R............."]);
    let mut controller = controller();
    controller.set_goal(Point2::new(13.5, 0.5), Some(0.0));
    while !matches!(controller.view().status, Status::Finished(_)) {
        let (is_closed, was_closed) =
            (closed.contains(&world.step), world.map.get(DOOR) == Some(&CellState::Blocked));
        if is_closed != was_closed {
            world.change(DOOR, if is_closed { CellState::Blocked } else { CellState::Free });
        }
        // Nobody looks through a closed door.
        world.patience = patience.filter(|_| is_closed).map(Patience);
        world.tick(&mut controller);
        assert!(world.step < 100);
    }
    assert_eq!(world.robot, Cell::new(13, 0));
    world.step - 1 // the robot arrives in the step before
}

#[test]
fn it_waits_for_an_obstacle_as_long_as_that_is_worth_it() {
    let (direct, round) = (13, 13 + 2 + 2);
    assert_eq!(
        steps_with_door(None, 5..99),
        5 + 5 + round,
        "nothing is known: it takes the way round at once"
    );
    assert_eq!(steps_with_door(Some(10.0), 5..9), direct + 3, "the door opens while it waits");
    assert_eq!(steps_with_door(Some(6.0), 5..99), 12 + 1 + 6 + round, "the door stays closed");
    assert_eq!(steps_with_door(Some(0.0), 5..99), 5 + 5 + round, "it is not worth waiting");
    assert_eq!(
        steps_with_door(Some(10.0), 0..3),
        direct,
        "it is closed at first, and open when the robot comes"
    );
}

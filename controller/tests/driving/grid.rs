//! The same controller in a world of cells, where a command is one move to a neighbor.

use controller::{CellDrive, ControlInput, Controller, Driver, Outcome, Status};
use interfaces::{Cell, CellState, Grid, GridFrame, Purpose, RandomStream, Step, Transition, pose};
use nalgebra::{Isometry2, Point2};

struct World {
    map: Grid<CellState>,
    robot: Cell,
    step: u32,
    transitions: Vec<Transition>,
}

impl World {
    fn new(rows: &[&str]) -> Self {
        let frame = GridFrame::new(Point2::origin(), 1.0, rows[0].len(), rows.len()).unwrap();
        let mut world = Self {
            map: Grid::filled(frame, CellState::Free),
            robot: Cell::new(0, 0),
            step: 0,
            transitions: Vec::new(),
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
        ControlInput { time: f64::from(self.step), pose, map, transitions, points: &[] }
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

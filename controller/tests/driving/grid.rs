//! The same controller in a world of cells, where a command is one move to a neighbour.

use controller::{
    Body, Controller, Drive, InflationSettings, Moves, Outcome, Path, Scene, Settings, Situation, Status,
};
use geometry::{Cell, CellState, Grid, GridFrame, Transition, pose};
use nalgebra::Point2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

struct GridDrive;

impl Drive for GridDrive {
    /// The cell to go to from the present one: itself, or one beside it.
    type Command = (i32, i32);

    fn body(&self) -> Body {
        Body {
            radius_m: 0.0,
            moves: Moves::Four,
            tolerance_m: 0.4,
            stride_m: 1.0,
            directions: 4,
            step_s: 1.0,
            step_limit_s: 1.0,
        }
    }

    fn follow(&mut self, scene: &Scene, path: &Path) -> Self::Command {
        let frame = scene.costmap.frame();
        let here = frame.cell_at(&scene.situation.position());
        let next = path.ahead().first().map_or(here, |next| frame.cell_at(next));
        if scene.costmap.is_open(next) { (next.x - here.x, next.y - here.y) } else { (0, 0) }
    }

    fn rest(&mut self, _: &Scene) -> Self::Command {
        (0, 0)
    }

    fn recover(&mut self, _: &Scene, _: f64) -> Option<Self::Command> {
        None
    }
}

fn settings() -> Settings {
    let inflation = InflationSettings { margin_m: 0.0, comfort_m: 0.0, comfort_price: 1 };
    Settings { inflation, ..Settings::default() }
}

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

    fn tick(&mut self, controller: &mut Controller<GridDrive>) -> (i32, i32) {
        let at = self.map.frame().center(self.robot);
        let (x, y) = controller.drive(&Situation {
            time: f64::from(self.step),
            pose: &pose(at.x, at.y, 0.0),
            map: &self.map,
            transitions: &self.transitions,
            points: &[],
        });
        assert!(x.abs() + y.abs() <= 1);
        let next = Cell::new(self.robot.x + x, self.robot.y + y);
        assert_ne!(self.map.get(next), Some(&CellState::Blocked), "a move into something seen");
        self.robot = next;
        self.step += 1;
        self.transitions.clear();
        (x, y)
    }
}

fn controller() -> Controller<GridDrive> {
    Controller::new(settings(), GridDrive, ChaCha8Rng::seed_from_u64(3)).unwrap()
}

#[test]
fn it_takes_a_shortest_way_one_cell_per_step() {
    let mut world = World::new(&["R.......", "######..", "........"]);
    let mut controller = controller();
    controller.go_to(Point2::new(0.5, 0.5));
    let mut steps = 0;
    loop {
        let moved = world.tick(&mut controller);
        if controller.status() == Status::Finished(Outcome::Reached) {
            break;
        }
        assert_ne!(moved, (0, 0));
        steps += 1;
    }
    assert_eq!((world.robot, steps), (Cell::new(0, 0), 14));
}

#[test]
fn it_goes_another_way_when_a_block_stands_in_it() {
    let mut world = World::new(&["......", "R.....", "......"]);
    let mut controller = controller();
    controller.go_to(Point2::new(5.5, 1.5));
    world.tick(&mut controller);
    world.change(Cell::new(2, 1), CellState::Blocked);
    let mut steps = 1;
    while !matches!(controller.status(), Status::Finished(_)) {
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
    controller.set_goal(Point2::new(1.5, 0.5));
    world.robot = Cell::new(0, 0);
    let (mut block, mut explored) = (3, 0);
    loop {
        let before = CellState::Free;
        world.change(Cell::new(block, 2), before);
        block += 1;
        world.change(Cell::new(block, 2), CellState::Blocked);
        world.tick(&mut controller);
        match controller.status() {
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

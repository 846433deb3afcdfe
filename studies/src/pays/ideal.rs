use super::Place;
use anyhow::Context;
use calendar::Timeline;
use interfaces::{Cell, CellReading, GridFrame, Purpose, RandomStream, Step, World};
use nalgebra::{Isometry2, Point2};

/// The side of a cell, m, and the time to drive to the next one, s: a robot with a laser drives 3.5 to 3.6 m of the 4.1 m from
/// room to room in ten seconds, with its turns and stops (`way_m` of `pays measure`); here a room is 9 cells wide.
const CELL_M: f64 = 0.5;
pub(super) const STEP_S: f64 = 1.25;

/// A place as an event simulator of views and travel: a robot that moves from cell to cell, and sees at once everything within
/// the range of its laser that no wall hides. Things hide nothing.
#[derive(Clone, Debug)]
pub struct IdealWorld {
    frame: GridFrame,
    is_wall: Vec<bool>,
    things: Vec<Thing>,
    /// The cells in view from each cell; computed when they are needed.
    views: Vec<Option<Vec<usize>>>,
    range_cells: f64,
    robot: Cell,
    time_s: f64,
}

#[derive(Clone, Debug)]
struct Thing {
    cells: Vec<usize>,
    timeline: Timeline,
}

impl IdealWorld {
    /// The place with the changes of a seed: those of the physics world with this seed.
    ///
    /// # Errors
    ///
    /// When the grid has too many cells.
    pub fn new(place: &Place, seed: u64) -> anyhow::Result<Self> {
        let (n, side) = (place.setting.rooms, (place.setting.side_m / CELL_M) as usize);
        let pitch = side + 1;
        let cells = n * pitch + 1;
        let frame = GridFrame::new(Point2::origin(), CELL_M, cells, cells).context("too many cells")?;
        let at = |x: usize, y: usize| y * cells + x;
        let mut is_wall: Vec<bool> =
            (0..cells * cells).map(|cell| cell % cells % pitch == 0 || cell / cells % pitch == 0).collect();
        for (room, axis) in &place.doorways {
            let [x, y] = room.map(|number| number * pitch + 1 + side / 2);
            for aside in [0, 1] {
                is_wall[if *axis == 0 {
                    at((room[0] + 1) * pitch, y - aside)
                } else {
                    at(x - aside, (room[1] + 1) * pitch)
                }] = false;
            }
        }
        let things = place.things.iter().enumerate().map(|(number, item)| {
            let [x, y] =
                [0, 1].map(|axis| item.room[axis] * pitch + 1 + (item.corner_m[axis] / CELL_M) as usize);
            // An object has at least two cells.
            let cells = vec![at(x, y), at(x + 1, y)];
            let rng = RandomStream::new(seed, Purpose::Thing(number));
            Thing { cells, timeline: place.schedule(item).timeline(0.0, rng) }
        });
        let middle = Cell::new(4, 4);
        Ok(Self {
            frame,
            is_wall,
            things: things.collect(),
            views: vec![None; cells * cells],
            range_cells: place.setting.laser_m / CELL_M,
            robot: middle,
            time_s: 0.0,
        })
    }

    /// The position and the size of the grid.
    pub fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// The time, s.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// The position of the robot, m.
    pub fn position(&self) -> Point2<f64> {
        self.frame.center(self.robot)
    }

    /// The cells of all things.
    pub fn things(&self) -> impl Iterator<Item = &[usize]> {
        self.things.iter().map(|thing| thing.cells.as_slice())
    }

    /// Whether each thing is there.
    pub fn are_there(&self) -> Vec<bool> {
        self.things.iter().map(|thing| thing.timeline.is_blocked()).collect()
    }

    /// Lets the time of a step pass.
    pub fn pass(&mut self) {
        self.time_s += STEP_S;
        self.things.iter_mut().for_each(|thing| thing.timeline.advance(self.time_s, |_, _| {}));
    }

    fn is_blocked(&self) -> Vec<bool> {
        let mut is_blocked = self.is_wall.clone();
        for thing in self.things.iter().filter(|thing| thing.timeline.is_blocked()) {
            thing.cells.iter().for_each(|cell| is_blocked[*cell] = true);
        }
        // Nothing comes to where the robot stands.
        self.frame.index(self.robot).into_iter().for_each(|cell| is_blocked[cell] = false);
        is_blocked
    }

    /// The cells within the range of the laser that no wall hides.
    fn view(&self) -> Vec<usize> {
        let reach = self.range_cells as i32;
        let mut seen = Vec::new();
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let cell = Cell::new(self.robot.x + dx, self.robot.y + dy);
                let Some(index) = self.frame.index(cell) else { continue };
                let steps = 2 * dx.abs().max(dy.abs());
                let between = (1..steps).map(|step| {
                    let along = |d: i32| (f64::from(d * step) / f64::from(steps)).round() as i32;
                    Cell::new(self.robot.x + along(dx), self.robot.y + along(dy))
                });
                let is_hidden = between
                    .filter(|other| *other != cell)
                    .any(|other| self.frame.index(other).is_none_or(|other| self.is_wall[other]));
                if f64::from(dx * dx + dy * dy) <= self.range_cells * self.range_cells && !is_hidden {
                    seen.push(index);
                }
            }
        }
        seen
    }
}

impl World for IdealWorld {
    type Reading = CellReading;
    type Command = Step;

    fn sense(&mut self) -> CellReading {
        let (is_blocked, center) = (self.is_blocked(), self.position());
        let at = self.frame.index(self.robot).unwrap_or(0);
        if self.views[at].is_none() {
            self.views[at] = Some(self.view());
        }
        let cells = self.views[at].iter().flatten().map(|cell| (self.frame.cell(*cell), is_blocked[*cell]));
        CellReading {
            time: self.time_s,
            pose: Isometry2::translation(center.x, center.y),
            cells: cells.collect(),
        }
    }

    fn poses_are_exact(&self) -> bool {
        true
    }

    fn act(&mut self, command: &Step) {
        let target = command.target(self.robot);
        if self.frame.index(target).is_some_and(|target| !self.is_blocked()[target]) {
            self.robot = target;
        }
        self.pass();
    }
}

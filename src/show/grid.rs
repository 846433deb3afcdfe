//! A trial that is shown to the recording while it goes on.

use crate::recording::{Recorder, RecordingError};
use crate::view::{ObstacleView, Outline, RobotView, Scene, Sight, StrategyView, TimeUnit, View};
use evaluation::metrics::{RateErrors, Scores, cell_map_scores, cell_rate_scores};
use evaluation::report::Trial;
use evaluation::trials::{Life, Look, SettingsError, live};
use interfaces::{Cell, Grid, pose};
use nalgebra::{Isometry2, Point2};
use robot::{Level, Message};
use sim::grid::GridSpec;
use std::sync::atomic::{AtomicBool, Ordering};

/// Later steps are not recorded: a person has seen enough, and the file stays a few megabytes large.
pub const RECORDED_STEPS: u64 = 20_000;

/// The scores take a pass over the map: once in so many steps in a map of up to [`SCORE_CELLS`], and
/// the more seldom the larger it is.
const SCORE_EVERY: u64 = 10;
/// See [`SCORE_EVERY`].
const SCORE_CELLS: usize = 10_000;
/// What the robot is called.
const ROBOT: &str = "robot";
/// The radius that the robot is drawn with, m: it is as large as its cell, which is 1 m wide.
const ROBOT_RADIUS_M: f64 = 0.35;
/// How far inside of its cell a block is drawn, m, so that the cell is seen around it.
const INSET_M: f64 = 0.12;

/// What came of a recorded trial.
#[derive(Debug)]
pub struct Recorded {
    /// The trial, the same as without a recording; `None` if it was cancelled.
    pub trial: Option<Trial>,
    /// Why not all of it is in the recording, if so. The trial has gone on.
    pub problem: Option<RecordingError>,
}

/// What stays the same in a trial in `world`.
pub fn scene(world: &GridSpec) -> Scene {
    Scene {
        title: world.name().to_owned(),
        place: "grid",
        unit: TimeUnit::Step,
        walls: rectangles(world.walls()),
    }
}

/// Runs one trial, the first steps of which go to `recorder`. When `is_cancelled` is set the trial is
/// given up, and what was recorded is kept.
///
/// # Errors
///
/// When settings make no sense.
pub fn record(life: &Life, recorder: Recorder, is_cancelled: &AtomicBool) -> Result<Recorded, SettingsError> {
    let mut observer = Observer::new(life, recorder);
    let mut problem = None;
    let trial = live(life, |mut look| {
        let goes_on = !is_cancelled.load(Ordering::Relaxed);
        if let Err(error) = observer.watch(&mut look, !goes_on) {
            problem = Some(error);
        }
        goes_on
    })?;
    Ok(Recorded { trial, problem })
}

/// Watches a trial from outside.
struct Observer {
    /// `None` when the recording is over.
    recorder: Option<Recorder>,
    /// Steps of the trial.
    steps: u64,
    /// Where the robot is, looking along its last move.
    pose: Isometry2<f64>,
    /// Steps from one look at the scores to the next.
    score_every: u64,
}

impl Observer {
    fn new(life: &Life, recorder: Recorder) -> Self {
        let start = life.world.frame().center(life.world.start());
        Self {
            recorder: Some(recorder),
            steps: life.steps,
            pose: pose(start.x, start.y, 0.0),
            score_every: SCORE_EVERY * life.world.frame().len().div_ceil(SCORE_CELLS) as u64,
        }
    }

    /// Looks at one step, which is the last one if `is_cancelled`. After an error there is no recording
    /// any more.
    fn watch(&mut self, look: &mut Look, is_cancelled: bool) -> Result<(), RecordingError> {
        let Some(mut recorder) = self.recorder.take() else { return Ok(()) };
        let step = look.reading.time as u64;
        let is_last = is_cancelled || step >= self.steps.min(RECORDED_STEPS);
        let mut messages = look.pilot.take_messages();
        if is_last && !is_cancelled && step < self.steps {
            let text = format!("the recording ends here; the trial goes on to step {}", self.steps);
            messages.push(Message { level: Level::Event, text });
        }
        self.turn(look);
        let scores = (is_last || step.is_multiple_of(self.score_every)).then(|| measure(look));
        if is_last {
            return self.show(look, step, scores, &messages, |view| recorder.finish(view));
        }
        self.show(look, step, scores, &messages, |view| recorder.log(view))?;
        self.recorder = Some(recorder);
        Ok(())
    }

    /// A cell has no direction: the robot is drawn as it last went.
    fn turn(&mut self, look: &Look) {
        let to = look.reading.pose.translation.vector;
        let way = to - self.pose.translation.vector;
        if way.norm() > 0.0 {
            self.pose = pose(to.x, to.y, libm::atan2(way.y, way.x));
        }
    }

    /// Puts together what the trial looks like now.
    fn show<T>(
        &self,
        look: &Look,
        step: u64,
        scores: Option<(Scores, RateErrors)>,
        messages: &[Message],
        log: impl FnOnce(&View) -> T,
    ) -> T {
        let robot = RobotView {
            name: ROBOT,
            pose: self.pose,
            radius_m: ROBOT_RADIUS_M,
            is_curious: true,
            sight: Some(Sight::Cells { reading: look.reading, radius: look.world.spec().sensor_radius() }),
        };
        let outlines: Vec<Outline> =
            look.world.blocks().map(|(_, cell)| rectangle(cell, cell, INSET_M)).collect();
        let names = look.world.blocks().map(|(name, _)| name).zip(&outlines);
        let blocks: Vec<ObstacleView> =
            names.map(|(name, outline)| ObstacleView { name, outline, is_present: true }).collect();
        let states = look.pilot.strategies(look.belief.features);
        let strategies: Vec<StrategyView> = states.iter().map(StrategyView::from).collect();
        log(&View {
            time: look.reading.time,
            step,
            mapper: look.belief.mapper,
            features: look.belief.features,
            robots: &[robot],
            obstacles: &blocks,
            path: look.pilot.path(),
            goal: look.pilot.goal(),
            scores: scores.map(|(map, _)| map),
            rate_errors: scores.map(|(_, rates)| rates),
            strategies: &strategies,
            messages,
        })
    }
}

/// How right the map is, and how wrong the rates are.
fn measure(look: &Look) -> (Scores, RateErrors) {
    let (mapper, truth) = (look.belief.mapper, look.world.truth());
    let (map, rates) = (cell_map_scores(mapper, truth), cell_rate_scores(mapper, truth));
    (
        Scores { coverage: map.coverage, map_quality: map.map_quality },
        RateErrors { relative: rates.rate_error, log: rates.log_error },
    )
}

/// The rectangle from one cell to another, both included, with its sides moved inwards, m. Cells are
/// 1 m wide, with `[0, 0]` at the origin.
pub fn rectangle(low: Cell, high: Cell, inset_m: f64) -> Outline {
    let from = Point2::new(f64::from(low.x), f64::from(low.y)).map(|side| side + inset_m);
    let to = Point2::new(f64::from(high.x), f64::from(high.y)).map(|side| side + 1.0 - inset_m);
    vec![from, Point2::new(to.x, from.y), to, Point2::new(from.x, to.y)]
}

/// The cells as few rectangles: runs along the rows, joined with equally long ones above each other.
fn rectangles(cells: &Grid<bool>) -> Vec<Outline> {
    let mut done: Vec<(Cell, Cell)> = Vec::new();
    let mut open: Vec<(Cell, Cell)> = Vec::new();
    for (row, y) in cells.cells().chunks(cells.frame().width()).zip(0..) {
        let mut x = 0;
        let mut still_open = Vec::new();
        for run in row.chunk_by(|a, b| a == b) {
            let (from, to) = (x, x + run.len() as i32 - 1);
            x = to + 1;
            if run[0] {
                let below = open.iter().position(|(low, high)| (low.x, high.x) == (from, to));
                let low = below.map_or(Cell::new(from, y), |below| open.swap_remove(below).0);
                still_open.push((low, Cell::new(to, y)));
            }
        }
        done.append(&mut open);
        open = still_open;
    }
    done.append(&mut open);
    done.sort_unstable();
    done.into_iter().map(|(low, high)| rectangle(low, high, 0.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::RecordingOptions;
    use agent::{AgentSettings, StrategyChoice};
    use controller::CellDrive;
    use evaluation::trials::{Experiment, TrialStrategy};
    use mapper::{Estimator, MapperSettings};
    use std::path::Path;

    /// The first trial of the shipped world, of so many steps.
    fn experiment(steps: u64) -> Experiment {
        Experiment {
            worlds: vec![crate::worlds::load_grid("two_blocks").unwrap()],
            estimators: vec![Estimator::Paper],
            strategies: vec![TrialStrategy::Agent(StrategyChoice::Recency)],
            trials: 1,
            seed: 3,
            steps,
            mapper: MapperSettings::default(),
            agent: AgentSettings::default(),
            controller: CellDrive::settings(),
        }
    }

    fn recorded(steps: u64, file: &Path, is_cancelled: bool) -> Recorded {
        let experiment = experiment(steps);
        let life = experiment.life(experiment.jobs()[0]);
        let options = RecordingOptions { file: Some(file.to_owned()), ..Default::default() };
        let recorder = Recorder::new(&options, scene(life.world)).unwrap();
        record(&life, recorder, &is_cancelled.into()).unwrap()
    }

    #[test]
    fn a_recording_does_not_change_the_trial() {
        let folder = tempfile::tempdir().unwrap();
        let Recorded { trial, problem } = recorded(400, &folder.path().join("trial.rrd"), false);
        assert!(problem.is_none(), "{problem:?}");
        let experiment = experiment(400);
        let alone = experiment.run(experiment.jobs(), &false.into(), |_| ()).unwrap();
        // As text: what is not a number is not equal to itself.
        assert_eq!(format!("{:?}", trial.unwrap()), format!("{:?}", alone[0]));
    }

    #[test]
    fn a_trial_that_is_given_up_leaves_a_whole_recording() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("trial.rrd");
        let Recorded { trial, problem } = recorded(400, &file, true);
        assert!(trial.is_none() && problem.is_none(), "{problem:?}");
        let bytes = std::fs::read(&file).unwrap();
        let stores = rerun::ChunkStore::from_rrd_reader(&rerun::ChunkStoreConfig::ALL_DISABLED, &mut &*bytes);
        assert_eq!(stores.unwrap().len(), 2, "the trial and its layout");
    }

    /// The walls of a drawn world, as rectangles.
    fn walls(rows: &[&str]) -> (Grid<bool>, Vec<Outline>) {
        let text = format!("name = 'x'\nsensor_radius = 1\nmap = '''\n{}\n'''", rows.join("\n"));
        let walls = GridSpec::parse("x.toml", &text).unwrap().walls().clone();
        let rectangles = rectangles(&walls);
        (walls, rectangles)
    }

    #[test]
    fn rectangles_cover_the_walls_once_and_nothing_else() {
        let rows = ["#######", "#..#..#", "####R.#", "#..##.#", "#.....#", "##.##.#", "#######"];
        let (walls, rectangles) = walls(&rows);
        for (index, is_wall) in walls.cells().iter().enumerate() {
            let middle = walls.frame().center(walls.frame().cell(index));
            let holds = |outline: &&Outline| {
                (outline[0].x..outline[2].x).contains(&middle.x)
                    && (outline[0].y..outline[2].y).contains(&middle.y)
            };
            assert_eq!(rectangles.iter().filter(holds).count(), usize::from(*is_wall), "{middle}");
        }
    }

    #[test]
    fn a_box_of_walls_is_four_rectangles() {
        let (_, rectangles) = walls(&["#####", "#...#", "#...#", "#####"]);
        let corners: Vec<_> = rectangles.iter().map(|outline| (outline[0], outline[2])).collect();
        let corner = |x, y| Point2::new(x, y);
        assert_eq!(
            corners,
            [
                (corner(0.0, 0.0), corner(5.0, 1.0)),
                (corner(0.0, 1.0), corner(1.0, 3.0)),
                (corner(0.0, 3.0), corner(5.0, 4.0)),
                (corner(4.0, 1.0), corner(5.0, 3.0)),
            ]
        );
    }
}

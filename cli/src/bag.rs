//! `--mcap`: a run as a bag of ROS 2.

use files::{OutputError, UnfinishedFile};
use interfaces::{CellState, Grid, LaserReading};
use mapper::Mapper;
use nalgebra::{Isometry2, Point2};
use robot::{Pilot, PilotView, Turn};
use ros::McapWriter;
use std::io::{self, BufWriter};
use std::path::Path;

/// The time between two maps, and between two maps of changes and predictions, s.
const MAP_S: f64 = 1.0;
const CHANGES_S: f64 = 10.0;
/// The time in which a change matters to a robot on its route, s: maps of changes show the probability of a change
/// [within](Mapper::change_probability_within) this time. It is 0.63 where a cycle takes this long on average.
const CHANGE_HORIZON_S: f64 = 600.0;
/// Maps of more cells than this are written less often.
const MANY_CELLS: f64 = 1e6;

/// A bag that is being written. It has its name when it is complete. The first error ends the bag, not the run;
/// [`finish`](Self::finish) reports it.
pub struct RunBag {
    writer: Result<McapWriter<BufWriter<UnfinishedFile>>, io::Error>,
    /// What was written last.
    correction: Option<Isometry2<f64>>,
    goal: Option<Point2<f64>>,
    path: Vec<Point2<f64>>,
    next_map_s: f64,
    next_changes_s: f64,
}

impl RunBag {
    /// Creates the bag. `begin_s` is the time 0 of the readings, in seconds since the epoch; 0 in a simulation.
    ///
    /// # Errors
    ///
    /// When the file cannot be written, or would replace another file than one of a run.
    pub fn create(path: &Path, begin_s: f64) -> Result<Self, OutputError> {
        let to = BufWriter::new(UnfinishedFile::create(path)?);
        let writer = McapWriter::new(to, &path.display().to_string(), begin_s);
        Ok(Self {
            writer: Ok(writer.map_err(|why| OutputError::new(path, why))?),
            correction: None,
            goal: None,
            path: Vec::new(),
            next_map_s: f64::NEG_INFINITY,
            next_changes_s: f64::NEG_INFINITY,
        })
    }

    /// Writes a turn of the robot: `raw`, the reading as the source gave it, with the times of the map; the pose, the maps, the
    /// changes, the goal and the path.
    pub fn add<C>(
        &mut self,
        raw: &LaserReading,
        turn: &Turn<LaserReading, C>,
        mapper: &Mapper,
        pilot: &impl Pilot,
    ) {
        let correction = turn.belief.pose * raw.pose.inverse();
        let written = self.write(raw, &correction, mapper, pilot);
        if let Err(problem) = written {
            self.writer = Err(problem);
        }
    }

    /// Completes the bag.
    ///
    /// # Errors
    ///
    /// When a part of it could not be written. There is no file then.
    pub fn finish(self) -> anyhow::Result<()> {
        Ok(self.writer?.finish()?.into_inner().map_err(|error| error.into_error())?.finish()?)
    }

    fn write(
        &mut self,
        raw: &LaserReading,
        correction: &Isometry2<f64>,
        mapper: &Mapper,
        pilot: &impl Pilot,
    ) -> Result<(), io::Error> {
        let time_s = mapper.time();
        let Ok(writer) = &mut self.writer else { return Ok(()) };
        writer.reading(raw)?;
        if self.correction != Some(*correction) {
            writer.correction(time_s, correction)?;
            self.correction = Some(*correction);
        }
        let frame = mapper.frame();
        let changes = mapper.transitions().iter();
        let events = changes.filter_map(|change| Some((frame.center(change.cell), change.event()?)));
        let events: Vec<_> = events.collect();
        if !events.is_empty() {
            writer.events(time_s, &events)?;
        }
        if time_s >= self.next_map_s {
            self.next_map_s = time_s + MAP_S * (frame.len() as f64 / MANY_CELLS).max(1.0);
            writer.grid("/map", time_s, mapper.states(), |state| match state {
                CellState::Unknown => None,
                CellState::Free => Some(0.0),
                CellState::Blocked => Some(1.0),
            })?;
        }
        if time_s >= self.next_changes_s {
            self.next_changes_s = time_s + CHANGES_S * (frame.len() as f64 / MANY_CELLS).max(1.0);
            let change = |index: usize| mapper.change_probability_within(index, CHANGE_HORIZON_S);
            writer.grid("/change_map", time_s, &layer(mapper, change), |share| *share)?;
            let predicted = layer(mapper, |index| mapper.blocked_probability(index));
            writer.grid("/predicted_map", time_s, &predicted, |share| *share)?;
        }
        let PilotView { goal, path, .. } = pilot.view();
        if let Some(at) = goal.filter(|_| goal != self.goal) {
            writer.goal(time_s, &interfaces::pose(at.x, at.y, 0.0))?;
        }
        if path != self.path {
            let poses: Vec<_> = path.iter().map(|at| interfaces::pose(at.x, at.y, 0.0)).collect();
            writer.path(time_s, &poses)?;
            self.path = path.to_vec();
        }
        self.goal = goal;
        Ok(())
    }
}

/// A value from 0 to 1 for every cell that was seen.
fn layer(mapper: &Mapper, value: impl Fn(usize) -> f64) -> Grid<Option<f64>> {
    let mut grid = Grid::filled(*mapper.frame(), None);
    mapper.seen().for_each(|index| grid.cells_mut()[index] = Some(value(index)));
    grid
}

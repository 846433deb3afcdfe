//! Scan → projected scan → occupancy grid → change statistics per cell → maps of rate, cycle time, change
//! probability and recency (paper, section 3). It must not know worlds, simulators, goals, strategies,
//! drives, recordings or files.
//!
//! [`Mapper::update`] processes one reading; all other methods return results. The work per reading is proportional
//! to the number of cells that the reading observes and of cells that ever changed, not to the size of the map.
//!
//! - `scan_filter`: removes ranges that must not enter a map (mixed pixels, hits beside edges, long ranges), before scan matching.
//! - `occupancy`: from scans to the states of cells. A new model implements [`OccupancyModel`].
//! - `change`: the change statistics of cells, and the estimators of rates. A new estimator implements
//!   [`Estimator`].
//! - `derived`: the maps that follow from both.
//! - `things`: cells that change together: [`Door`]s, and objects that come and go ([`ObjectReport`]).
//! - `tiles`: the places where something changes, each with a clock.
//! - `clock`: [`Clock`], a model of one thing over days: hours of the day and of the week, and a memory of all looks.

mod change;
mod clock;
mod derived;
mod growth;
mod look_counts;
mod occupancy;
mod reading_error;
mod scan_filter;
mod things;
mod tiles;

pub use change::{
    CellMap, CellStatistics, Estimator, EstimatorChoice, Evidence, GapWorth, Paper, PaperAll, Population,
    Posterior, RateDistribution, ReadingIndex, SharedPrior, TransitionRates, TwoState, TwoStateGaps, Waiting,
};
pub use clock::{Calendar, Clock, DAY_S, Look, UnknownZone, UsualChange, UsualSlot, Week};
pub use derived::Undiscovered;
pub use growth::Growth;
pub use occupancy::{
    BeamReturn, CloneModel, OccupancyChoice, OccupancyModel, ProjectedScan, SurfaceGridSettings,
};
pub use reading_error::ReadingError;
pub use scan_filter::{
    NoReturn, NoReturnDistrust, NoReturnEvidence, NoReturns, ScanFilter, ScanFilterSettings,
};
pub use things::{Door, Leaf, ObjectReport, Segment};

pub use tiles::Tile;

use derived::{Alone, ExpectedChanges};
use interfaces::{
    CellState, Grid, GridFrame, LaserReading, Observation, Reading, SMALL_GRID, SettingsCheck, SettingsError,
    Transition, ValueError, Values, is_valid_pose, value,
};
use nalgebra::Point2;
use reading_error::check_pose;
use things::Things;
use tiles::Tiles;

/// Settings of a [`Mapper`].
#[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct MapperSettings {
    /// The estimator of rates.
    pub estimator: EstimatorChoice,
    /// The occupancy model.
    pub occupancy: OccupancyChoice,
    /// The maximum gap, s (steps in a grid world): a cell stays in view during a time without an observation if
    /// this time is at most `max_gap`. A moving thing hides the cells that it is about to enter. Where a sensor
    /// must look past moving things, set `max_gap` to the duration of such an occlusion. By default a cell is in
    /// view only between consecutive readings, as in the paper.
    pub max_gap: f64,
    /// Settings of the occupancy model `steady`.
    pub steady: SurfaceGridSettings,
    /// Whether every place where something changes has a [`Clock`], by which the map is predicted for hours and days ahead.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub clocks: bool,
    /// The zone by whose clocks people live, by its IANA name: a place can then have hours. The times of readings count from the
    /// [epoch](Mapper::set_epoch). Without a zone, times have no hours.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_zone: Option<String>,
    /// The maximum of [`Mapper::bytes`]; 2 GiB by default. What was learned does not depend on it: it is no part of what a state is
    /// compared by.
    #[serde(skip)]
    pub max_bytes: usize,
}

impl Default for MapperSettings {
    fn default() -> Self {
        Self {
            estimator: EstimatorChoice::default(),
            occupancy: OccupancyChoice::default(),
            max_gap: 0.0,
            steady: SurfaceGridSettings::default(),
            clocks: false,
            time_zone: None,
            max_bytes: 2 << 30,
        }
    }
}

impl MapperSettings {
    fn check(&self) -> Result<(), SettingsError> {
        let check = SettingsCheck { part: "mapper" };
        check.not_negative("max_gap", self.max_gap)?;
        self.calendar().map_err(|_| SettingsError {
            part: check.part,
            key: "time_zone",
            expected: "the IANA name of a time zone, such as Europe/Berlin",
            found: self.time_zone.clone().unwrap_or_default(),
        })?;
        self.steady.check(check)
    }

    /// The calendar of the time zone.
    fn calendar(&self) -> Result<Calendar, UnknownZone> {
        self.time_zone.as_deref().map_or(Ok(Calendar::Relative), Calendar::of_zone)
    }
}

/// A map of a changing environment, with the change statistics of every cell. Cells are addressed by their index in
/// row-major order.
#[derive(Clone, Debug)]
pub struct Mapper {
    settings: MapperSettings,
    cells: CellMap,
    occupancy: Box<dyn OccupancyModel>,
    expected_changes: ExpectedChanges,
    alone: Alone,
    things: Things,
    tiles: Tiles,
    scan: ProjectedScan,
    points: Vec<Point2<f64>>,
}

impl Mapper {
    /// What a cell takes that was seen and never changed, bytes, at most on average over a place.
    pub const BYTES_PER_SEEN_CELL: usize = 130;

    /// The memory of the map, bytes: it grows with what is seen, not with the frame.
    pub fn bytes(&self) -> usize {
        self.cells.bytes() + self.occupancy.bytes()
    }

    /// Whether the map takes [as much memory as it may](MapperSettings::max_bytes). Where nothing was seen yet, readings then
    /// change nothing, as outside of the frame; the rest of the map goes on, and what its cells record takes some more memory. A
    /// map of at most [`SMALL_GRID`] cells, some 10 MB, is never full: it has its memory from the start.
    pub fn is_full(&self) -> bool {
        self.frame().len() > SMALL_GRID && self.bytes() >= self.settings.max_bytes
    }

    /// Checks whether a prior map fits, before its cells get their records.
    fn check_prior(settings: &MapperSettings, prior: &Grid<CellState>) -> Result<(), SettingsError> {
        let known = prior.cells().other_than(CellState::Unknown).count();
        let bytes = known * CellMap::BYTES_PER_KNOWN_CELL;
        if bytes <= settings.max_bytes {
            return Ok(());
        }
        let gib = |bytes: usize| bytes as f64 / f64::from(1 << 30);
        Err(SettingsError {
            part: "mapper",
            key: "prior",
            expected: "a map that fits into the memory that the mapper may take (max_bytes)",
            found: format!(
                "{known} known cells, which need {:.4} GiB of {:.4} GiB",
                gib(bytes),
                gib(settings.max_bytes)
            ),
        })
    }

    /// A mapper whose cells are all unknown.
    ///
    /// # Errors
    ///
    /// When a setting is out of range or contradicts another.
    pub fn new(settings: &MapperSettings, frame: GridFrame) -> Result<Self, SettingsError> {
        Self::with_prior(settings, Grid::filled(frame, CellState::Unknown))
    }

    /// A mapper that starts from a known map. Its cells count as last seen at time 0.
    ///
    /// # Errors
    ///
    /// When a setting is out of range or contradicts another, and when the known cells need more than
    /// [`MapperSettings::max_bytes`].
    pub fn with_prior(settings: &MapperSettings, prior: Grid<CellState>) -> Result<Self, SettingsError> {
        settings.check()?;
        Self::check_prior(settings, &prior)?;
        Ok(Self::build(settings.clone(), prior))
    }

    fn build(settings: MapperSettings, prior: Grid<CellState>) -> Self {
        let mut cells = CellMap::new(prior, settings.estimator.clone(), settings.max_gap);
        let occupancy = settings.occupancy.build(&settings, &mut cells);
        let (expected_changes, alone) = (ExpectedChanges::default(), Alone::default());
        let tiles = Tiles::new(&settings, cells.frame().resolution_m());
        let (things, scan, points) = (Things::default(), ProjectedScan::default(), Vec::new());
        Self { settings, cells, occupancy, expected_changes, alone, tiles, things, scan, points }
    }

    /// Makes a mapper with the same settings and the same frame, whose cells are all unknown: when it is called, perhaps in
    /// another thread.
    pub fn emptied(&self) -> impl FnOnce() -> Self + Send + use<> {
        let (settings, frame) = (self.settings.clone(), *self.frame());
        let (epoch_s, is_dated) = (self.tiles.epoch_s, self.tiles.is_dated);
        move || {
            let mut mapper = Self::build(settings, Grid::filled(frame, CellState::Unknown));
            mapper.set_epoch(epoch_s, is_dated);
            mapper
        }
    }

    /// Goes on in a larger map, with the range noise of `settings`; its other settings are those of this mapper. The new
    /// cells are unknown. Returns how the cells have moved, if they have. A frame that does not cover this map with the same
    /// cells leaves the map as large as it is.
    ///
    /// # Errors
    ///
    /// When a setting is out of range.
    pub fn grow(
        &mut self,
        settings: &MapperSettings,
        frame: GridFrame,
    ) -> Result<Option<Growth>, SettingsError> {
        settings.check()?;
        let present = *self.frame();
        let Some(growth) = Growth::new(present, frame).or_else(|| Growth::new(present, present)) else {
            return Ok(None);
        };
        let is_larger = *growth.frame() != present;
        if is_larger {
            self.cells.grow(&growth);
            self.things.grow(&growth);
            self.tiles.grow(&growth);
            self.points.clear();
        }
        self.occupancy.grow(&growth, settings);
        self.settings.steady.range_noise_std_m = settings.steady.range_noise_std_m;
        Ok(is_larger.then_some(growth))
    }

    /// Updates the maps with one reading.
    ///
    /// # Errors
    ///
    /// When the reading is invalid; the maps then stay as they were.
    pub fn update(&mut self, reading: &impl Reading) -> Result<(), ReadingError> {
        let (time, last) = (reading.time(), self.cells.time());
        if !time.is_finite() || time < last {
            return Err(ReadingError::Time { time, last });
        }
        check_pose(reading.pose(), time)?;
        self.cells.is_full = self.is_full();
        match reading.observation() {
            Observation::Scan(laser) => {
                check_pose(&laser.mount, time)?;
                laser.scan.check()?;
                self.project(laser);
                self.cells.open(time);
                self.occupancy.update(&self.scan, &mut self.cells);
                let is_doubted = |index: usize| self.occupancy.is_doubted(index, &self.cells);
                self.things.update(&self.cells, is_doubted, self.tiles.dates());
            }
            Observation::Cells(exact) => {
                self.points.clear();
                self.cells.open(time);
                self.occupancy.update_cells(&exact.cells, &mut self.cells);
            }
        }
        self.expected_changes.note(&self.cells);
        self.tiles.note(&self.cells);
        Ok(())
    }

    /// Records a reading that must not enter the map, because its pose is not certain: for every cell, the time since the
    /// reading before counts as not observed. An invalid reading is no error.
    pub fn skip(&mut self, reading: &impl Reading) {
        let last = self.cells.time();
        let time = Some(reading.time()).filter(|time| time.is_finite()).map_or(last, |time| time.max(last));
        self.points.clear();
        if let Observation::Scan(laser) = reading.observation() {
            let is_pose = is_valid_pose(&laser.pose) && is_valid_pose(&laser.mount);
            if is_pose && laser.scan.check().is_ok() {
                self.project(laser);
            }
        }
        self.cells.interrupt(time);
        self.expected_changes.note(&self.cells);
    }

    /// Begins another session, whose first reading will have this time or a later one: the time from the last reading on is
    /// a gap in the view of every cell, and is left out of the mean time between readings. A time that is not after the
    /// last reading, or not finite, counts as that of the last reading.
    pub fn pause(&mut self, time: f64) {
        self.points.clear();
        self.cells.pause(if time.is_finite() { time } else { self.cells.time() });
        self.expected_changes.note(&self.cells);
    }

    /// Everything that readings have changed, as bytes; settings are not in it.
    pub fn snapshot(&mut self) -> Vec<u8> {
        interfaces::snapshot(self.values())
    }

    /// Goes on from the snapshot of a mapper with the same settings and the same frame, bit for bit.
    ///
    /// # Errors
    ///
    /// When the bytes are no such snapshot. The mapper must not be used then.
    pub fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError> {
        interfaces::restore(self.values(), snapshot)?;
        self.cells.derive()?;
        self.points.clear();
        self.alone = Alone::default();
        let is_sound = self.expected_changes.is_sound(&self.cells)
            && self.tiles.is_sound(&self.cells)
            && self.things.is_sound(&self.cells);
        if is_sound { Ok(()) } else { Err(ValueError) }
    }

    fn values(&mut self) -> Values<'_> {
        let mut values = self.cells.values();
        values.extend(self.occupancy.values());
        values.push(value(&mut self.expected_changes));
        values.push(self.tiles.value());
        values.push(value(&mut self.things));
        values
    }

    fn project(&mut self, laser: &LaserReading) {
        self.scan.project(laser);
        self.points.clear();
        self.points.extend((0..self.scan.len()).filter_map(|beam| self.scan.hit(beam)));
    }

    /// The doors that are known, in the order in which they were found.
    pub fn doors(&self) -> &[Door] {
        self.things.doors()
    }

    /// The objects that come and go as a whole, in the order in which they were found.
    pub fn objects(&self) -> impl Iterator<Item = ObjectReport> {
        self.things.objects.reports()
    }

    /// Says when readings have the time 0, in seconds since 1970-01-01 UTC; by default they count from there. `is_dated`: whether
    /// the readings that follow say when they were made; otherwise they have no hours.
    pub fn set_epoch(&mut self, epoch_s: f64, is_dated: bool) {
        self.tiles.set_epoch(epoch_s, is_dated);
    }

    /// The time at which readings have the time 0, in seconds since 1970-01-01 UTC.
    pub fn epoch_s(&self) -> f64 {
        self.tiles.epoch_s
    }

    /// Whether readings say when they were made.
    pub fn is_dated(&self) -> bool {
        self.tiles.is_dated
    }

    /// The settings.
    pub fn settings(&self) -> &MapperSettings {
        &self.settings
    }

    /// How the times of readings, [since the epoch](Self::epoch_s), relate to local civil time.
    pub fn calendar(&self) -> &Calendar {
        self.tiles.calendar()
    }

    /// The tile at a cell; `None` if nothing ever changed there, or without [`MapperSettings::clocks`].
    pub fn tile(&self, index: usize) -> Option<&Tile> {
        self.tiles.at(self.frame().cell(index))
    }

    /// All tiles in which something ever changed.
    pub fn tiles(&self) -> impl Iterator<Item = &Tile> {
        self.tiles.iter()
    }

    /// The position and the size of the map.
    pub fn frame(&self) -> &GridFrame {
        self.cells.frame()
    }

    /// The map.
    pub fn states(&self) -> &Grid<CellState> {
        self.cells.states()
    }

    /// The cells that changed their state in the last update, in the order of the changes.
    pub fn transitions(&self) -> &[Transition] {
        &self.cells.transitions
    }

    /// The end points of the beams of the last laser scan that hit something, in the frame of the map, m.
    pub fn points(&self) -> &[Point2<f64>] {
        &self.points
    }

    /// The time of the last reading.
    pub fn time(&self) -> f64 {
        self.cells.time()
    }

    /// The number of readings so far.
    pub fn readings(&self) -> usize {
        self.cells.readings()
    }

    /// The estimator in use.
    pub fn estimator(&self) -> &EstimatorChoice {
        &self.cells.estimator
    }

    /// The change statistics of a cell. The prior of its rate is that of its door, if it has one.
    #[inline]
    pub fn statistics(&self, index: usize) -> CellStatistics {
        let seen = self.cells.statistics(index);
        let of_door = seen.prior.and_then(|_| self.things.of_door(index)?.rate_prior());
        CellStatistics { prior: of_door.or(seen.prior), ..seen }
    }

    /// How often the known state of a cell changed in the map: the changes in its [statistics](Self::statistics), and the
    /// correction of a wrong first observation, which the statistics do not count.
    pub fn map_changes(&self, index: usize) -> u32 {
        self.cells.map_changes(index)
    }

    /// Whether a reading ever observed the cell.
    pub fn was_ever_seen(&self, index: usize) -> bool {
        self.cells.was_ever_seen(index)
    }

    /// The cells that a reading ever observed, by ascending index.
    pub fn seen(&self) -> impl Iterator<Item = usize> {
        self.cells.seen()
    }

    /// Whether the last reading observed the cell.
    #[inline]
    pub fn is_in_view(&self, index: usize) -> bool {
        self.cells.is_seen_now(index)
    }

    /// Whether the cell can be a goal: the cell is free, or shares a side with a free cell. The inside of a wall
    /// never can be a goal.
    #[inline]
    pub fn is_candidate(&self, index: usize) -> bool {
        self.cells.is_candidate(index)
    }

    /// Whether the cell ever changed.
    #[inline]
    pub fn has_changed(&self, index: usize) -> bool {
        self.cells.has_changed(index)
    }

    /// The indices of the cells that ever changed, in the order of their first change.
    pub fn changed(&self) -> impl Iterator<Item = usize> {
        self.cells.changed.iter().map(|&index| index as usize)
    }
}

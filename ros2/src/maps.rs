//! The maps that are published, and masks for the costmap filters of Nav2: only the part that is known, rarely as a whole, and what changes at once.

use crate::message::{CostmapFilterInfo, Header, Message, OccupancyGrid, OccupancyGridUpdate, Topic};
use crate::parameters::Parameters;
use interfaces::{Cell, CellState, Grid, GridFrame};
use mapper::Mapper;
use nalgebra::{Point2, Vector2};
use std::time::{Duration, Instant};
use survey::{Outlook, masks_ahead};

/// The border of a published map lies on multiples of this number of cells, so that its frame rarely changes.
const BLOCK: i32 = 64;
/// A map of more cells is published less often, in proportion: with the default buffers of an operating system, larger
/// messages arrive late, and one that is replaced before it has arrived never does.
const MANY_CELLS: f64 = 600.0 * 600.0;
/// The time between two maps of that size, at least.
const LARGE: Duration = Duration::from_secs(5);
/// The time between two maps of changes, predictions and rates, at least.
const CHANGES: Duration = Duration::from_secs(10);

/// The map of rates has cycles per hour, at most 100.
const HOUR_S: f64 = 3600.0;
/// The map of expiry has minutes, at most 100.
const MINUTE_S: f64 = 60.0;

/// What was published, and when.
#[derive(Default)]
pub(crate) struct PublishedMaps {
    /// The map as subscribers know it.
    shown: Option<Grid<i8>>,
    whole: Option<Instant>,
    changes: Option<Instant>,
    masks: Option<Instant>,
    /// Whether nothing changed since the last whole map.
    is_whole: bool,
}

impl PublishedMaps {
    /// The messages after a reading. `header` has the time of the reading and the frame of the map. `name` is the full name of a
    /// topic: the filters of Nav2 subscribe the masks by it.
    pub(crate) fn after<'a>(
        &mut self,
        parameters: &Parameters,
        mapper: &Mapper,
        header: &Header,
        now: Instant,
        name: impl Fn(Topic) -> &'a str,
    ) -> Vec<(Topic, Message)> {
        let mut messages = Vec::new();
        self.is_whole &= mapper.transitions().is_empty();
        if self.is_due(parameters, now) && !self.is_whole {
            self.show_whole(parameters, mapper, header, now, &mut messages);
        } else if let Some(update) = self.update(mapper, header) {
            messages.push((Topic::MapUpdates, Message::GridUpdate(update)));
        }
        messages.extend(self.masks(parameters, mapper, header, now, name));
        messages
    }

    /// Publishes the whole map again as soon as it is time: one was not sent.
    pub(crate) fn repeat(&mut self) {
        self.is_whole = false;
    }

    fn is_due(&self, parameters: &Parameters, now: Instant) -> bool {
        let cells = self.shown.as_ref().map_or(0, |shown| shown.cells().len());
        let share = cells as f64 / MANY_CELLS;
        let interval = Duration::from_secs_f64(parameters.map_update_interval_s);
        let interval = if share > 1.0 { interval.max(LARGE).mul_f64(share) } else { interval };
        self.whole.is_none_or(|whole| now.duration_since(whole) >= interval)
    }

    fn show_whole(
        &mut self,
        parameters: &Parameters,
        mapper: &Mapper,
        header: &Header,
        now: Instant,
        messages: &mut Vec<(Topic, Message)>,
    ) {
        let Some(frame) = known_part(mapper.states()) else { return };
        let message = |grid: &Grid<i8>| Message::Grid(OccupancyGrid::of(grid, header.clone()));
        let map = cut(mapper.states(), frame, |state, _| percent(*state));
        messages.push((Topic::Map, message(&map)));
        self.shown = Some(map);
        self.whole = Some(now);
        self.is_whole = true;
        if self.changes.is_none_or(|last| now.duration_since(last) >= CHANGES) {
            self.changes = Some(now);
            let (change_s, ahead_s) = (parameters.change_horizon_s, parameters.prediction_horizon_s);
            let share = |index, share: f64| match mapper.was_ever_seen(index) {
                true => (share.clamp(0.0, 1.0) * 100.0).round() as i8,
                false => -1,
            };
            let change = |index| share(index, mapper.change_probability_within(index, change_s));
            let predicted = |index| share(index, mapper.blocked_probability_later(index, ahead_s));
            let rate = |index| share(index, mapper.rate(index) * HOUR_S / 100.0);
            let mut show = |topic, value: &dyn Fn(usize) -> i8| {
                messages.push((topic, message(&cut(mapper.states(), frame, |_, index| value(index)))));
            };
            show(Topic::ChangeMap, &change);
            show(Topic::PredictedMap, &predicted);
            show(Topic::RateMap, &rate);
            let worth = Outlook::live(mapper).worth();
            let minutes = |index: usize| match worth.cells()[index] {
                worth_s if worth_s.is_nan() => -1,
                worth_s => (worth_s / MINUTE_S).round().min(100.0) as i8,
            };
            show(Topic::ExpiryMap, &minutes);
        }
    }

    /// The rectangle of the published map in which cells changed with the last reading.
    fn update(&mut self, mapper: &Mapper, header: &Header) -> Option<OccupancyGridUpdate> {
        let shown = self.shown.as_mut()?;
        let offset = offset(shown.frame(), mapper.frame());
        let mut changed = Vec::new();
        for transition in mapper.transitions() {
            let cell = Cell::new(transition.cell.x - offset.x, transition.cell.y - offset.y);
            let state = mapper.states().get(transition.cell).copied().unwrap_or(CellState::Unknown);
            let Some(known) = shown.get_mut(cell).filter(|known| **known != percent(state)) else { continue };
            *known = percent(state);
            changed.push(cell);
        }
        OccupancyGridUpdate::around(shown, changed.into_iter(), header.clone())
    }

    /// The masks, if they are due.
    fn masks<'a>(
        &mut self,
        parameters: &Parameters,
        mapper: &Mapper,
        header: &Header,
        now: Instant,
        name: impl Fn(Topic) -> &'a str,
    ) -> Vec<(Topic, Message)> {
        let is_first = self.masks.is_none();
        let interval = Duration::from_secs_f64(parameters.mask_update_interval_s);
        if interval.is_zero() || self.masks.is_some_and(|last| now.duration_since(last) < interval) {
            return Vec::new();
        }
        let Some(frame) = known_part(mapper.states()) else { return Vec::new() };
        self.masks = Some(now);
        let [speed, keepout] = masks_ahead(mapper, parameters.prediction_horizon_s);
        let mut messages = Vec::new();
        for (topic, mask) in [(Topic::SpeedMask, speed), (Topic::KeepoutMask, keepout)] {
            let value = |_: &CellState, index: usize| i8::try_from(mask.cells()[index]).unwrap_or(i8::MAX);
            let part = cut(mapper.states(), frame, value);
            messages.push((topic, Message::Grid(OccupancyGrid::of(&part, header.clone()))));
        }
        if is_first {
            messages.extend(filter_infos(header, name));
        }
        messages
    }
}

/// What the values mean: the filters subscribe the masks after these messages. A speed mask of v allows 100 − v percent of the
/// full speed.
fn filter_infos<'a>(header: &Header, name: impl Fn(Topic) -> &'a str) -> [(Topic, Message); 2] {
    let info = |topic, mask, kind, base, multiplier| {
        let filter_mask_topic = name(mask).to_owned();
        let info = CostmapFilterInfo { header: header.clone(), kind, filter_mask_topic, base, multiplier };
        (topic, Message::FilterInfo(info))
    };
    [
        info(Topic::SpeedFilterInfo, Topic::SpeedMask, CostmapFilterInfo::SPEED_PERCENT, 100.0, -1.0),
        info(Topic::KeepoutFilterInfo, Topic::KeepoutMask, CostmapFilterInfo::KEEPOUT, 0.0, 1.0),
    ]
}

/// The value of a cell in an occupancy grid.
fn percent(state: CellState) -> i8 {
    match state {
        CellState::Unknown => -1,
        CellState::Free => 0,
        CellState::Blocked => 100,
    }
}

/// The frame of the known cells, with borders on multiples of [`BLOCK`]; `None` if nothing is known.
fn known_part(map: &Grid<CellState>) -> Option<GridFrame> {
    let frame = map.frame();
    let known = map.cells().other_than(CellState::Unknown).map(|(index, _)| frame.cell(index));
    let (low, high) = known.map(|cell| (cell, cell)).reduce(|(low, high), (cell, _)| {
        let low = Cell::new(low.x.min(cell.x), low.y.min(cell.y));
        (low, Cell::new(high.x.max(cell.x), high.y.max(cell.y)))
    })?;
    let begin = |at: i32| at / BLOCK * BLOCK;
    let end = |at: i32, size: usize| ((at / BLOCK + 1) * BLOCK).min(size as i32);
    let (x, y) = (begin(low.x), begin(low.y));
    let (width, height) = (end(high.x, frame.width()) - x, end(high.y, frame.height()) - y);
    let origin = frame.origin() + Vector2::new(f64::from(x), f64::from(y)) * frame.resolution_m();
    GridFrame::new(origin, frame.resolution_m(), width as usize, height as usize)
}

/// The part of a map in a frame.
fn cut(map: &Grid<CellState>, frame: GridFrame, value: impl Fn(&CellState, usize) -> i8) -> Grid<i8> {
    let offset = offset(&frame, map.frame());
    let mut part = Grid::filled(frame, -1);
    for at in 0..frame.len() {
        let cell = frame.cell(at);
        if let Some(index) = map.frame().index(Cell::new(cell.x + offset.x, cell.y + offset.y)) {
            part.cells_mut().set(at, value(&map.cells()[index], index));
        }
    }
    part
}

/// The cell of the whole map in which a part of it begins.
fn offset(part: &GridFrame, whole: &GridFrame) -> Cell {
    let half = Vector2::repeat(0.5 * whole.resolution_m());
    whole.cell_at(&(Point2::from(part.origin()) + half))
}

#[cfg(test)]
pub(crate) mod tests;

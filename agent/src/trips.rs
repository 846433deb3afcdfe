//! Trips: what a robot sees on its way to a goal, and there.
//!
//! A robot that crosses a building sees the rooms on its way at no cost. So a goal is worth all that comes into view from the robot to
//! the goal, each part of it once, per time of the trip.

use crate::situation::Situation;
use crate::visibility::{Regions, Visibility};
use interfaces::{Cell, GridFrame, Values, runs, value};
use mapper::Mapper;

/// The distance between two stops at which the view counts, m, and the largest number of stops.
const STOP_M: f64 = 0.4;
const MAX_STOPS: usize = 10_000;
/// The longest way from a stop to the next, in sides of a stop.
const MAX_DETOUR: usize = 4;

/// A trip that has begun.
#[derive(Clone, Debug, serde::Deserialize, serde::Serialize)]
struct Trip {
    /// The index of the cell of its goal.
    goal: usize,
    /// The regions that come into view, in order.
    seen: Vec<usize>,
}

/// The places where a robot can stop, and the stop before each on the way from the robot.
#[derive(Clone, Debug)]
struct Stops {
    regions: Regions,
    /// For each stop the cell that the robot reaches first, and the stop before; `None` where the robot cannot go, and at the start.
    cells: Vec<Option<usize>>,
    before: Vec<Option<usize>>,
    /// The stop of the robot.
    start: Option<usize>,
}

/// Weighs goals by trips, and remembers, for each cell, the last trip on which it should have been in view.
///
/// An obstacle that hides a cell is not always on the map. Without this memory the robot would return again and again to see a cell
/// that cannot be seen.
#[derive(Clone, Debug)]
pub(crate) struct Trips {
    visibility: Visibility,
    frame: Option<GridFrame>,
    /// For each cell, the end of the last trip on which it should have been in view, whether or not it was seen.
    visited: Vec<f64>,
    trip: Option<Trip>,
    stops: Option<Stops>,
}

impl Trips {
    /// For a robot whose sensor has the range `radius_m`.
    pub(crate) fn new(radius_m: f64) -> Self {
        let visibility = Visibility::new(radius_m);
        Self { visibility, frame: None, visited: Vec::new(), trip: None, stops: None }
    }

    /// Applies the present map, and ends the last trip. Returns the regions of the map.
    pub(crate) fn update(&mut self, mapper: &Mapper) -> Regions {
        let regions = self.visibility.update(mapper);
        self.set_frame(*mapper.frame());
        if let Some(Trip { seen, .. }) = self.trip.take() {
            // A state can be of another sensor.
            for region in seen.into_iter().filter(|region| *region < regions.count()) {
                regions.cells(region).for_each(|cell| self.visited[cell] = mapper.time());
            }
        }
        regions
    }

    /// Ends the last trip, where no other goal follows for a while. If the robot has been called away on its way, there was no trip.
    pub(crate) fn end(&mut self, situation: &Situation) {
        let (mapper, frame) = (situation.mapper, situation.mapper.frame());
        self.set_frame(*frame);
        let regions = Regions::of_sensor(*frame, self.visibility.radius_m);
        self.trip.take_if(|trip| !regions.are_near(situation.cell(), frame.cell(trip.goal)));
        self.update(mapper);
    }

    fn set_frame(&mut self, frame: GridFrame) {
        if self.frame != Some(frame) {
            self.frame = Some(frame);
            self.visited = vec![0.0; frame.len()];
            (self.trip, self.stops) = (None, None);
        }
    }

    /// The trips so far, and the present one.
    pub(crate) fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        self.set_frame(*mapper.frame());
        vec![runs(&mut self.visited), value(&mut self.trip)]
    }

    /// The time since the cell was last seen or should have been seen.
    #[inline]
    pub(crate) fn elapsed(&self, mapper: &Mapper, cell: usize) -> f64 {
        mapper.recency(cell).min(mapper.time() - self.visited[cell])
    }

    /// Writes the weight of each goal: the sum of `worth`, one value per region, over all that comes into view on the trip to there,
    /// divided by the time of the trip and of a look at its end.
    pub(crate) fn weigh(
        &mut self,
        situation: &Situation,
        regions: &Regions,
        worth: &[f64],
        look: f64,
        weights: &mut [f64],
    ) {
        let stops = Stops::new(situation, regions);
        let mut onward = vec![Vec::new(); stops.cells.len()];
        for (stop, before) in stops.before.iter().enumerate() {
            before.iter().for_each(|before| onward[*before].push(stop));
        }
        // How often each region is in view from the stops on the way to the present one: a walk through the tree of all ways.
        let mut views = vec![0_u32; regions.count()];
        let mut ways: Vec<(usize, f64, bool)> =
            stops.start.map(|stop| (stop, 0.0, false)).into_iter().collect();
        while let Some((stop, seen_before, is_done)) = ways.pop() {
            let Some(cell) = stops.cells[stop] else { continue };
            let from = regions.of(cell);
            if is_done {
                self.visibility.seen_from(from).for_each(|region| views[region] -= 1);
                continue;
            }
            let mut seen = seen_before;
            for region in self.visibility.seen_from(from) {
                seen += if views[region] == 0 { worth[region] } else { 0.0 };
            }
            weights[cell] = seen / (situation.travel_to(cell) + look);
            if !onward[stop].is_empty() {
                self.visibility.seen_from(from).for_each(|region| views[region] += 1);
                ways.push((stop, seen, true));
                ways.extend(onward[stop].iter().map(|next| (*next, seen, false)));
            }
        }
        self.stops = Some(stops);
    }

    /// Begins the trip to a goal that was weighed last.
    pub(crate) fn begin(&mut self, goal: Cell) {
        let (Some(goal), Some(stops), Some(regions)) =
            (self.frame.and_then(|frame| frame.index(goal)), &self.stops, self.visibility.regions)
        else {
            return;
        };
        let mut is_seen = vec![false; regions.count()];
        let mut stop = Some(stops.regions.of(goal));
        while let Some((at, cell)) = stop.and_then(|stop| Some((stop, stops.cells[stop]?))) {
            self.visibility.seen_from(regions.of(cell)).for_each(|region| is_seen[region] = true);
            stop = stops.before[at];
        }
        let seen = (0..regions.count()).filter(|region| is_seen[*region]).collect();
        self.trip = Some(Trip { goal, seen });
    }
}

impl Stops {
    fn new(situation: &Situation, regions: &Regions) -> Self {
        let frame = *situation.mapper.frame();
        let side = ((STOP_M / frame.resolution_m()) as usize).max(regions.side);
        let of_stops = Regions::at_most(MAX_STOPS, frame, side.min(frame.width().max(frame.height())));
        let time = |cell: &usize| situation.travel_to(*cell);
        let can_stop = |cell: &usize| time(cell) < f64::INFINITY && situation.mapper.is_candidate(*cell);
        let first = |stop| of_stops.cells(stop).filter(can_stop).min_by(|a, b| time(a).total_cmp(&time(b)));
        let cells: Vec<Option<usize>> = (0..of_stops.count()).map(first).collect();
        let reached = cells.iter().enumerate().filter_map(|(stop, cell)| Some((stop, time(cell.as_ref()?))));
        let start = reached.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(stop, _)| stop);
        let before = |(stop, cell): (usize, &Option<usize>)| {
            let cell = (*cell).filter(|_| Some(stop) != start)?;
            way_back(situation, &frame, cell, MAX_DETOUR * of_stops.side)
                .map(|cell| of_stops.of(cell))
                .find(|other| *other != stop && cells[*other].is_some())
                .or(start)
        };
        let before = cells.iter().enumerate().map(before).collect();
        Self { regions: of_stops, cells, before, start }
    }
}

/// The cells on the way from a cell back to the robot: each has a shorter travel time than the one before.
fn way_back<'a>(
    situation: &'a Situation,
    frame: &'a GridFrame,
    from: usize,
    steps: usize,
) -> impl Iterator<Item = usize> + 'a {
    let nearer = move |cell: &usize| {
        let Cell { x, y } = frame.cell(*cell);
        let around = (-1..=1).flat_map(|dy| [-1, 0, 1].map(|dx| Cell::new(x + dx, y + dy)));
        let time = |cell: &usize| situation.travel_to(*cell);
        let next = around.filter_map(|cell| frame.index(cell)).min_by(|a, b| time(a).total_cmp(&time(b)))?;
        (time(&next) < time(cell)).then_some(next)
    };
    std::iter::successors(Some(from), nearer).skip(1).take(steps)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::CellReading;
    use mapper::MapperSettings;
    use nalgebra::{Isometry2, Point2};
    use proptest::prelude::*;

    /// A free map of cells of 1 m with some walls.
    fn map(width: usize, walls: &[bool]) -> Mapper {
        let frame = GridFrame::new(Point2::origin(), 1.0, width, walls.len() / width).unwrap();
        let mut mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        let cells = (0..walls.len()).map(|cell| (frame.cell(cell), walls[cell])).collect();
        mapper.update(&CellReading { time: 0.0, pose: Isometry2::identity(), cells }).unwrap();
        mapper
    }

    proptest! {
        /// The simple version: each way for itself, and each view as a set.
        #[test]
        fn a_trip_is_worth_each_region_in_view_once(
            walls in prop::collection::vec(prop::bool::weighted(0.2), 70),
            worth in prop::collection::vec(0.0..9.0, 70),
            travel in prop::collection::vec(prop_oneof![4 => 0.0..30.0, 1 => Just(f64::INFINITY)], 70),
            reach in 0.5..6.0,
        ) {
            let mapper = map(10, &walls);
            let pose = Isometry2::identity();
            let situation = Situation::new(&mapper, &pose, Default::default()).with_travel(&travel);
            let mut trips = Trips::new(reach);
            let regions = trips.update(&mapper);
            let mut weights = vec![0.0; 70];
            trips.weigh(&situation, &regions, &worth, 1.0, &mut weights);
            let stops = trips.stops.clone().unwrap();
            for cell in (0..70).filter(|cell| stops.cells[*cell].is_some()) {
                let mut seen = std::collections::BTreeSet::new();
                let (mut at, mut steps) = (Some(cell), 0);
                while let Some(stop) = at {
                    seen.extend(trips.visibility.seen_from(stop));
                    at = stops.before[stop];
                    steps += 1;
                    prop_assert!(steps <= 70, "a way ends at the robot");
                }
                let expected = seen.iter().map(|region| worth[*region]).sum::<f64>() / (travel[cell] + 1.0);
                prop_assert!((weights[cell] - expected).abs() < 1e-9, "{} {expected}", weights[cell]);
                trips.begin(mapper.frame().cell(cell));
                prop_assert!(trips.trip.as_ref().unwrap().seen.iter().eq(&seen));
            }
        }
    }
}

//! Where an observation is expected to reduce the error of the rates of change most.

mod change;
mod clusters;
mod rates;
mod view_reliability;

use super::{Pick, Stay, Strategy};
use crate::settings::AgentSettings;
use crate::situation::Situation;
use crate::travel::travel_past_obstacles;
use crate::visibility::{Regions, Visibility};
use change::Change;
use clusters::{Clusters, Occlusion, Position};
use interfaces::{Cell, CellState, Values, value};
use mapper::Mapper;
use rates::{Gains, RATES, Rates, WATCHES};
use view_reliability::ViewReliability;

/// The maximum duration of an observation before the next decision, in the time unit of the readings. New
/// observations often make another region better.
const LONGEST_WATCH: f64 = 5.0;
/// The time that every visit takes in addition to travel and observation.
const OVERHEAD: f64 = 1.0;
/// The number of cells in which an undiscovered moving thing of one cell could have been seen: an observation without an
/// event, far from all clusters, counts this many times.
const PATH_IN_VIEW: f64 = 5.0;
/// The factor on the value of a region beside a cluster, where the robot may block the path of a moving thing.
const IN_THE_WAY: f64 = 0.5;

/// Goes to the region where a visit reduces the error of the rates most, per time to get there and to observe.
///
/// The error of a cell's rate r is |ln(r̂ / r)|, at most ln 10, and ln 10 without an estimate r̂. The value of a
/// region is
///
/// ```text
/// max over watches d of   Σ over cells c in view   v(c) · P(c changes) · E[error(c) now − error(c) after d]
///                         ―――――――――――――――――――――――――――――――――――――――――――――――――――――――――――――――――――――――
///                                              travel time + d + 1
/// ```
///
/// with v(c) the share of the cell that is really seen from the region, and d the duration of the observation
/// ("watch"). The robot leaves a region when the rest of what can be learned there is worth less, per time, than
/// the travel to another region. The robot therefore does not spend time on cells that never change, and does not
/// follow moving things. Three estimates are used:
///
/// - *Whether a cell changes.* The distribution of the rate has a spike at zero. The share of cells that change is
///   learned from the cells seen so far, and is larger beside the end of a cluster; a cell that was observed for
///   long without an event is probably static (empirical Bayes).
/// - *The gain of an observation.* After n cycles in view the error is about 0.9 / √(n + ½), so that each further cycle
///   gains less.
/// - *What is really seen.* A moving thing hides the cells behind it. Some cells should not be observed from a
///   region at all: cells that things enter from their own shadow. The events of such a cell are missed, but its
///   time counts.
///
/// Each file of this folder describes one estimate. All times are in the time unit of the readings. All constants
/// were set on other worlds than those of the reported results.
#[derive(Clone, Debug)]
pub struct InformationGain {
    visibility: Visibility,
    rates: Rates,
    change: Change,
    reliability: ViewReliability,
    plan: Option<Plan>,
}

/// The plan for the goal that is selected by the last weights.
#[derive(Clone, Debug)]
struct Plan {
    regions: Regions,
    /// The best duration of the observation from each region.
    watches: Vec<f64>,
    /// The time that each region has been in view so far.
    watched: Vec<f64>,
}

/// For each region the gain of each duration, summed over the cells of the region.
type RegionGains = Vec<[f32; WATCHES.len()]>;

fn add(sums: &mut [f32; WATCHES.len()], gains: &Gains) {
    sums.iter_mut().zip(gains).for_each(|(sum, gain)| *sum += *gain as f32);
}

impl InformationGain {
    /// The strategy of a robot whose sensor has the range `settings.sensor_radius_m`.
    pub fn new(settings: &AgentSettings) -> Self {
        Self {
            visibility: Visibility::new(settings.sensor_radius_m),
            rates: Rates::new(),
            change: Change::new(),
            reliability: ViewReliability::default(),
            plan: None,
        }
    }

    /// The gains of an observation of each region.
    fn gains(&mut self, mapper: &Mapper, clusters: &Clusters, regions: &Regions) -> RegionGains {
        let mut sums = vec![[0.0; WATCHES.len()]; regions.count()];
        let mut cells_with_rate = [0; RATES];
        for cell in mapper.changed() {
            let seen = mapper.statistics(cell);
            let cycles = 0.5 * f64::from(seen.block_events + seen.free_events);
            let (rate, gains) = self.rates.of_changed(cycles, seen.watched_free + seen.watched_blocked);
            cells_with_rate[rate] += 1;
            add(&mut sums[regions.of(cell)], &gains);
        }
        self.change.learn_rates(cells_with_rate);
        let path_in_view = if regions.are_cells() { PATH_IN_VIEW } else { 1.0 };
        self.change.gains_of_unchanged(mapper, clusters, &self.rates, path_in_view, |cell, gains| {
            add(&mut sums[regions.of(cell)], gains);
        });
        sums
    }

    /// The gain of each duration of an observation from a region: the sum over the regions in view, weighted by the
    /// share that is really seen.
    fn in_view(
        &mut self,
        region: usize,
        gains: &RegionGains,
        visible_share: impl Fn(usize) -> f64,
    ) -> [f32; WATCHES.len()] {
        let view: Vec<usize> = self.visibility.seen_from(region).collect();
        let mut sums = [0.0; WATCHES.len()];
        let mut add = |seen: usize, share: f64| {
            let factor = (share * visible_share(seen)) as f32;
            sums.iter_mut().zip(&gains[seen]).for_each(|(sum, gain)| *sum += factor * gain);
        };
        match self.reliability.share(region, view.len()) {
            Some(shares) => view.iter().zip(shares).for_each(|(&seen, share)| add(seen, share)),
            None => view.iter().for_each(|&seen| add(seen, 1.0)),
        }
        sums
    }
}

impl Strategy for InformationGain {
    fn name(&self) -> &'static str {
        "information-gain"
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        let (mapper, frame) = (situation.mapper, situation.mapper.frame());
        let regions = self.visibility.update(mapper);
        self.reliability.end(mapper, &mut self.visibility, &regions, situation.cell(), false);
        let clusters = Clusters::new(mapper);
        let gains = self.gains(mapper, &clusters, &regions);
        let travel = travel_past_obstacles(situation);
        // Where things are as large as a cell, a robot on a path blocks the path, and a thing hides the cells behind it.
        // Where things cover many cells, most of the free space is on some path, and the robot can be passed.
        let is_in_the_way = regions.are_cells();
        let occlusion = is_in_the_way.then(|| Occlusion::new(mapper, &clusters));
        let mut watches = vec![0.0; regions.count()];
        for (region, chosen) in watches.iter_mut().enumerate() {
            let may_stand = |&cell: &usize| {
                mapper.states().cells()[cell] == CellState::Free
                    && !(is_in_the_way && clusters.has(cell))
                    && travel[cell] < f64::INFINITY
            };
            let nearest = |one: &usize, other: &usize| travel[*one].total_cmp(&travel[*other]);
            let Some(cell) = regions.cells(region).filter(may_stand).min_by(nearest) else { continue };
            let sums = self.in_view(region, &gains, |seen| match &occlusion {
                Some(occlusion) if clusters.has(seen) => occlusion.visible_share(region, seen),
                _ => 1.0,
            });
            let is_beside = is_in_the_way && clusters.position(frame, cell).0 != Position::Far;
            let factor = if is_beside { IN_THE_WAY } else { 1.0 };
            for (sum, watch) in sums.into_iter().zip(WATCHES) {
                let worth = factor * f64::from(sum) / (travel[cell] + watch + OVERHEAD);
                if worth > weights[cell] {
                    weights[cell] = worth;
                    *chosen = watch.min(LONGEST_WATCH);
                }
            }
        }
        let watched = |region| view_reliability::watched(mapper, &regions, region);
        self.plan = Some(Plan { regions, watches, watched: (0..regions.count()).map(watched).collect() });
    }

    fn end(&mut self, situation: &Situation) {
        let mapper = situation.mapper;
        let regions = self.visibility.update(mapper);
        self.reliability.end(mapper, &mut self.visibility, &regions, situation.cell(), true);
    }

    fn values(&mut self, _: &Mapper) -> Values<'_> {
        let mut values = self.change.values();
        values.push(value(&mut self.reliability));
        values
    }

    fn pick(&self) -> Pick {
        Pick::Best
    }

    fn stay(&mut self, goal: Cell) -> Stay {
        let Some(Plan { regions, watches, watched }) = &self.plan else { return Stay::Watch(0.0) };
        let Some(goal) = regions.index(goal) else { return Stay::Watch(0.0) };
        let watch = watches[regions.of(goal)];
        self.reliability.begin(self.visibility.seen_from(regions.of(goal)), watched, goal, watch);
        Stay::Watch(watch)
    }
}

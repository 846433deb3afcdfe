//! Where a look is expected to teach most about how often cells change.

mod change;
mod rates;
mod runs;
mod sight;
mod things;
mod ways;

use crate::view::{Outlook, Places};
use crate::{AgentSettings, Pick, Situation, Stay, Strategy};
use change::Change;
use interfaces::{Cell, CellState};
use mapper::Mapper;
use rates::{Gains, Rates, WATCHES};
use runs::Runs;
use sight::{Hiding, Sight};
use things::{Position, Things};

/// The robot watches for at most so long before it thinks again, in the unit of the readings' times. What
/// it then sees often makes another place better.
const THINK_AGAIN: f64 = 5.0;
/// What every visit costs besides the way and the watch.
const OVERHEAD: f64 = 1.0;
/// Beside a thing's way the robot may stand in its way, which holds up what it came to see.
const IN_THE_WAY: f64 = 0.5;
/// From a place so near to the robot, what is in view now stays in view on the way.
const STILL_IN_VIEW: f64 = 3.0;

/// Go where a visit takes most from the error of the rates, per time to get there and to watch.
///
/// The error of a cell's rate r is |ln(r̂ / r)|, at most ln 10, and ln 10 without an estimate r̂. The
/// worth of a place is
///
/// ```text
/// max over watches d of   Σ over cells c in view   v(c) · P(c changes) · E[error(c) now − error(c) after d]
///                         ―――――――――――――――――――――――――――――――――――――――――――――――――――――――――――――――――――――――
///                                                 way + d + 1
/// ```
///
/// with v(c) the share of it that is really seen from there. So the robot leaves a place when the rest
/// of what there is to learn there is worth less, per time, than the way to another: it does not waste time
/// on cells that never change, nor follow what moves. Three beliefs go into it:
///
/// - *Whether a cell changes.* The rate has a spike at zero. The share of cells that change is
///   learned from those seen so far, and is larger beside the end of a thing's way; a cell that was
///   watched for long and showed nothing is believed to be static (empirical Bayes).
/// - *What a watch teaches.* After n cycles of variance V the error is √(2 V / π) / n. With fewer than
///   three it is averaged over the rates that the cell may have. A watch on end has less variance
///   than one in pieces, which keeps the robot where it is.
/// - *What is really seen.* What moves hides the cell behind it. A cell that things enter out of their
///   own shadow is better not watched at all from there: its events are missed, its time counts.
///
/// Where the beliefs come from is told in the files beside this one. All times are in the unit of the
/// readings', all constants were set on worlds other than those that figures are reported for.
#[derive(Clone, Debug)]
pub struct InformationGain {
    outlook: Outlook,
    rates: Rates,
    change: Change,
    runs: Runs,
    sight: Sight,
    plan: Option<Plan>,
}

/// What was thought when the weights were written, for the goal that comes of it.
#[derive(Clone, Debug)]
struct Plan {
    places: Places,
    /// The best watch from each place.
    watches: Vec<f64>,
    /// For how long each place was in view so far.
    watched: Vec<f64>,
}

/// The gains of watching each place, summed over its cells: by a watch that begins anew, and by one
/// that goes on without a gap.
#[derive(Clone, Debug)]
struct PlaceGains {
    anew: Vec<[f32; WATCHES.len()]>,
    on_end: Vec<[f32; WATCHES.len()]>,
}

fn add(sums: &mut [f32; WATCHES.len()], gains: &Gains) {
    sums.iter_mut().zip(gains).for_each(|(sum, gain)| *sum += *gain as f32);
}

impl InformationGain {
    /// For a robot that sees as far as `settings.sensor_radius_m`.
    pub fn new(settings: &AgentSettings) -> Self {
        Self {
            outlook: Outlook::new(settings.sensor_radius_m),
            rates: Rates::new(),
            change: Change::new(),
            runs: Runs::default(),
            sight: Sight::default(),
            plan: None,
        }
    }

    fn gains(&mut self, mapper: &Mapper, things: &Things, places: &Places) -> PlaceGains {
        let nothing = vec![[0.0; WATCHES.len()]; places.count()];
        let mut gains = PlaceGains { anew: nothing.clone(), on_end: nothing };
        let Self { change, runs, rates, .. } = self;
        runs.update(mapper, |cell, seen| rates.of_changed(seen, &change.odds(rates, things.pace(cell))));
        change.learn_odds(runs.expected().map(|(_, expected)| &expected.odds));
        for (cell, expected) in runs.expected() {
            let place = places.of(cell);
            add(&mut gains.anew[place], &expected.anew);
            let on_end = if mapper.is_in_view(cell) { &expected.on_end } else { &expected.anew };
            add(&mut gains.on_end[place], on_end);
        }
        change.judge(mapper, things, rates, |cell, worth| {
            let place = places.of(cell);
            add(&mut gains.anew[place], worth);
            add(&mut gains.on_end[place], worth);
        });
        gains
    }

    /// The gain of each watch from a place: what is in view there, as far as it will be seen.
    fn in_view(
        &mut self,
        place: usize,
        gains: &[[f32; WATCHES.len()]],
        clear: impl Fn(usize) -> f64,
    ) -> [f32; WATCHES.len()] {
        let view = self.outlook.seen_from(place);
        let mut sums = [0.0; WATCHES.len()];
        let mut add = |seen: u32, share: f64| {
            let factor = (share * clear(seen as usize)) as f32;
            let gains = &gains[seen as usize];
            sums.iter_mut().zip(gains).for_each(|(sum, gain)| *sum += factor * gain);
        };
        match self.sight.share(place, view) {
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
        let places = self.outlook.follow(mapper);
        self.sight.end(mapper, &mut self.outlook, &places, situation.cell());
        let things = Things::new(mapper);
        let gains = self.gains(mapper, &things, &places);
        let travel = ways::times(situation);
        // A thing that covers many cells does not hide as one that covers a cell.
        let hiding = places.are_cells().then(|| Hiding::new(mapper, &things));
        let mut watches = vec![0.0; places.count()];
        for (place, chosen) in watches.iter_mut().enumerate() {
            let may_stand = |&cell: &usize| {
                mapper.states().cells()[cell] == CellState::Free
                    && !things.has(cell)
                    && travel[cell] < f64::INFINITY
            };
            let nearest = |one: &usize, other: &usize| travel[*one].total_cmp(&travel[*other]);
            let Some(cell) = places.cells(place).filter(may_stand).min_by(nearest) else { continue };
            let way = travel[cell];
            let gains = if way <= STILL_IN_VIEW { &gains.on_end } else { &gains.anew };
            let sums = self.in_view(place, gains, |seen| match &hiding {
                Some(hiding) if things.has(seen) => hiding.clear(place, seen),
                _ => 1.0,
            });
            let is_beside = things.position(frame, cell).0 != Position::Far;
            let factor = if is_beside { IN_THE_WAY } else { 1.0 };
            for (sum, watch) in sums.into_iter().zip(WATCHES) {
                let worth = factor * f64::from(sum) / (way + watch + OVERHEAD);
                if worth > weights[cell] {
                    weights[cell] = worth;
                    *chosen = watch.min(THINK_AGAIN);
                }
            }
        }
        let watched = (0..places.count()).map(|place| sight::watched(mapper, &places, place)).collect();
        self.plan = Some(Plan { places, watches, watched });
    }

    fn pick(&self) -> Pick {
        Pick::Best
    }

    fn needs_travel(&self) -> bool {
        true
    }

    fn stay(&mut self, goal: Cell) -> Stay {
        let Some(Plan { places, watches, watched }) = &self.plan else { return Stay::Watch(0.0) };
        let Some(place) = places.at_cell(goal) else { return Stay::Watch(0.0) };
        let watch = watches[place];
        self.sight.begin(&mut self.outlook, watched, place, watch);
        Stay::Watch(watch)
    }
}

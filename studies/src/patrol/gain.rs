use super::demand::Demand;
use super::duty::Duty;
use super::round::Round;
use super::view::{Choice, Seen, Strategy, View};
use crate::building::Building;
use interfaces::RandomStream;

/// The number of viewpoints that are planned ahead.
const LOOKAHEAD: usize = 4;
/// The number of plans that are kept from each length to the next one.
const BEAM: usize = 8;
/// The time between two decisions at the dock, steps: a minute.
const REST_STEPS: usize = 6;
/// The weight of the last interval in the mean interval between looks at a thing.
const INTERVAL_WEIGHT: f64 = 0.2;
/// The longest patrol that is planned from the dock, viewpoints.
const LONGEST: usize = 40;

/// The patrols that the forecast of the time on patrol is trusted for before it is compared with what happened, steps.
const FORECAST_STEPS: f64 = 40.0;
/// While the models of the things change, the demand is forecast again after this time, steps: a day.
const FORECAST_AGAIN_STEPS: usize = 8640;

/// A robot that learns goes out with this share of a full battery to see what it has not seen for longest, and returns with the
/// second one: what does not fit into the battery is lost.
const EXPLORE_FROM: f64 = 0.98;
const EXPLORE_TO: f64 = 0.8;
/// Below this charge, a robot that learns raises its price, up to a multiple at an empty battery: the forecast with learned
/// habits is uncertain, and a robot with an empty battery sees nothing in the hours in which most happens.
const SCARCE: f64 = 0.2;
const SCARCE_PRICE: f64 = 3.0;

/// Goes where the expected integral of the Brier score falls most, by looks, until the next look at each thing, per time
/// of travel and look.
///
/// With a battery there is a price for every step of patrol, with which the battery is expected to last ([`Demand`]): the robot
/// leaves the dock for a patrol that gains more than its price, and stays out as long as what follows does.
pub(super) struct Gain {
    /// The mean interval between two looks at each thing, steps.
    intervals: Vec<f64>,
    /// The share of one thing of a round of all viewpoints, steps.
    look_steps: f64,
    demand: Option<Demand>,
    demanded_at: usize,
    /// The gain that a step of patrol must have.
    price: f64,
    priced_at: usize,
    /// The steps on patrol, as they were and as they were forecast.
    spent_steps: f64,
    forecast_steps: f64,
    /// Whether the robot is on a patrol to learn, which a full battery gives it for nothing.
    is_exploring: bool,
}

/// A sequence of viewpoints.
#[derive(Clone, Copy)]
struct Draft {
    first: usize,
    last: usize,
    steps: usize,
    gain: f64,
    /// The things that it sees, one bit each.
    sees: u128,
}

/// What a decision needs: the gain of each thing, and the things of each viewpoint.
struct Worth<'a> {
    view: &'a View<'a>,
    gains: Vec<f64>,
    sees: Vec<u128>,
}

impl Gain {
    pub(super) fn new(building: &Building, duty: Duty) -> Self {
        // A guess until it is known: half of the time of a round.
        let viewpoints = building.viewpoints.len();
        let mean = building.steps.iter().flatten().sum::<usize>() as f64 / (viewpoints * viewpoints) as f64;
        let interval = 0.5 * mean * viewpoints as f64 * duty.spread();
        Self {
            intervals: vec![interval; building.things.len()],
            look_steps: Round::new(building).steps(building) as f64 / building.things.len().max(1) as f64,
            demand: None,
            demanded_at: 0,
            price: 0.0,
            priced_at: 0,
            spent_steps: FORECAST_STEPS,
            forecast_steps: FORECAST_STEPS,
            is_exploring: false,
        }
    }

    fn worth<'a>(&self, view: &'a View<'a>) -> Worth<'a> {
        let gain = |thing: usize| {
            if self.is_exploring {
                return view.age(thing) as f64;
            }
            let horizon = self.intervals[thing].max(view.age(thing) as f64).max(1.0) as usize;
            view.models[thing].gain(&view.beliefs[thing], view.step, horizon)
        };
        let bits = |sees: &Vec<usize>| sees.iter().fold(0, |bits, thing| bits | 1 << thing);
        Worth {
            view,
            gains: (0..view.building.things.len()).map(gain).collect(),
            sees: view.building.viewpoints.iter().map(|viewpoint| bits(&viewpoint.sees)).collect(),
        }
    }

    /// The price with which the battery lasts, by the forecast; where more or less was spent than forecast, the same is
    /// expected of the future.
    fn update_price(&mut self, view: &View<'_>) {
        if view.is_learning && view.step >= self.demanded_at + FORECAST_AGAIN_STEPS {
            self.demand = None;
            self.demanded_at = view.step;
        }
        let demand = self.demand.get_or_insert_with(|| Demand::new(view.models, self.look_steps));
        let passed = (view.step - self.priced_at) as f64;
        self.forecast_steps += demand.share(self.priced_at, self.price) * passed;
        self.priced_at = view.step;
        let scale = self.spent_steps / self.forecast_steps;
        self.price = demand.price(view.step, view.charge_steps, view.duty, scale);
        // On the first day nothing is known, and every look teaches.
        if view.is_learning && view.step >= FORECAST_AGAIN_STEPS {
            let missing = (1.0 - view.charge_steps / view.duty.full_steps() / SCARCE).max(0.0);
            self.price *= 1.0 + (SCARCE_PRICE - 1.0) * missing;
        }
    }
}

impl Worth<'_> {
    /// A plan with one more viewpoint.
    fn extended(&self, draft: &Draft, to: usize) -> Draft {
        let new = self.sees[to] & !draft.sees;
        let bits = |mut bits: u128| {
            let mut sum = 0.0;
            while bits != 0 {
                sum += self.gains[bits.trailing_zeros() as usize];
                bits &= bits - 1;
            }
            sum
        };
        let building = self.view.building;
        let open = self.view.reach(draft.last, to);
        let door = building.door_between(draft.last, to).map_or(0, |door| 1 << door);
        // A closed door is seen all the same.
        let gain = open * bits(new & !door) + bits(new & door);
        Draft {
            last: to,
            steps: draft.steps + building.steps[draft.last][to],
            gain: draft.gain + gain,
            sees: draft.sees | self.sees[to],
            ..*draft
        }
    }

    fn home(&self, draft: &Draft) -> usize {
        self.view.building.steps[draft.last][self.view.building.dock]
    }

    fn fits(&self, draft: &Draft) -> bool {
        (draft.steps + self.home(draft)) as f64 <= self.view.charge_steps
    }

    /// The best plan by a measure, over sequences of up to [`LOOKAHEAD`] viewpoints.
    fn best(&self, measure: impl Fn(&Draft) -> f64) -> Option<Draft> {
        let viewpoints = 0..self.view.building.viewpoints.len();
        let here = Draft { first: 0, last: self.view.at, steps: 0, gain: 0.0, sees: 0 };
        let starts = viewpoints.clone().filter(|to| self.view.is_open(*to));
        let mut beam: Vec<Draft> = starts.map(|to| Draft { first: to, ..self.extended(&here, to) }).collect();
        let mut best: Option<(f64, Draft)> = None;
        for depth in 0..LOOKAHEAD {
            let mut measured: Vec<(f64, Draft)> = beam.iter().map(|draft| (measure(draft), *draft)).collect();
            measured.sort_by(|a, b| b.0.total_cmp(&a.0));
            if let Some(first) = measured.first()
                && best.is_none_or(|best| best.0 < first.0)
            {
                best = Some(*first);
            }
            if depth + 1 < LOOKAHEAD {
                let kept = measured.iter().take(BEAM);
                let longer =
                    kept.flat_map(|(_, draft)| viewpoints.clone().map(move |to| self.extended(draft, to)));
                beam = longer.filter(|draft| self.fits(draft)).collect();
            }
        }
        best.map(|best| best.1)
    }

    /// Gain and steps of a patrol from here to the dock, which goes on greedily while a viewpoint gains most per time, and
    /// ends where the ratio is highest.
    fn patrol(&self) -> (f64, usize) {
        let mut draft = Draft { first: 0, last: self.view.at, steps: 0, gain: 0.0, sees: 0 };
        let mut best = (0.0, 1);
        let rate = |(gain, steps): (f64, usize)| gain / steps as f64;
        for _ in 0..LONGEST {
            let longer = (0..self.view.building.viewpoints.len()).map(|to| self.extended(&draft, to));
            let per_time = |next: &Draft| (next.gain - draft.gain) / (next.steps - draft.steps) as f64;
            let next =
                longer.filter(|next| self.fits(next)).max_by(|a, b| per_time(a).total_cmp(&per_time(b)));
            let Some(next) = next.filter(|next| next.gain > draft.gain) else { break };
            draft = next;
            let whole = (draft.gain, draft.steps + self.home(&draft));
            if rate(whole) > rate(best) {
                best = whole;
            }
        }
        best
    }
}

impl Strategy for Gain {
    fn choose(&mut self, view: &View<'_>, _: &mut RandomStream) -> Choice {
        let charge = view.charge_steps / view.duty.full_steps();
        self.is_exploring =
            view.is_learning && (charge >= EXPLORE_FROM || self.is_exploring && charge >= EXPLORE_TO);
        let worth = self.worth(view);
        if view.duty.is_always() || self.is_exploring {
            let best = worth.best(|draft| draft.gain / draft.steps as f64);
            return best.map_or(Choice::Rest(1), |draft| Choice::Go(draft.first));
        }
        self.update_price(view);
        if view.is_docked {
            let (gain, steps) = worth.patrol();
            let rate = gain / steps as f64;
            if gain <= 0.0 || rate < self.price {
                return Choice::Rest(REST_STEPS);
            }
        }
        let price = self.price;
        let home = view.building.steps[view.at][view.building.dock];
        // What is left after paying for the steps; the way home is due now or later.
        let left = |draft: &Draft| {
            let more = draft.steps + worth.home(draft);
            draft.gain - price * (more as f64 - if view.is_docked { 0.0 } else { home as f64 })
        };
        let best = worth.best(|draft| left(draft));
        match best.filter(|draft| view.is_docked || left(draft) > 0.0) {
            Some(draft) => Choice::Go(draft.first),
            None => Choice::Rest(REST_STEPS),
        }
    }

    fn learn(&mut self, seen: &Seen<'_>) {
        self.spent_steps += seen.steps as f64;
        for (thing, before) in seen.things {
            let interval = (seen.step - before.unwrap_or(0)) as f64;
            self.intervals[*thing] += INTERVAL_WEIGHT * (interval - self.intervals[*thing]);
        }
    }
}

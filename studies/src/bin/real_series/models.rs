//! Models that predict a thing: the clock, the estimators of the map, and simple baselines.

use crate::series::STEP_S;
use interfaces::{Cell, CellReading, GridFrame};
use mapper::{Calendar, Clock, DAY_S, EstimatorChoice, Look, Mapper, MapperSettings};
use nalgebra::{Isometry2, Point2};

/// A model of one thing.
pub(crate) trait Model {
    /// Learns from all looks of the first part of a series.
    fn learn(&mut self, looks: &[Look]);

    /// A look from which nothing more is learned.
    fn look(&mut self, look: Look);

    /// The probability that the thing is blocked at a time not before the last look.
    fn predict(&self, time_s: f64) -> f64;
}

/// The share of blocked looks, with one look of a half before.
fn mean(looks: &[Look]) -> f64 {
    let blocked = looks.iter().filter(|look| look.is_blocked).count();
    (blocked as f64 + 0.5) / (looks.len() as f64 + 1.0)
}

fn state(look: Look) -> f64 {
    f64::from(u8::from(look.is_blocked))
}

/// The model of the mapper, with a schedule over local time.
pub(crate) struct TheClock(Clock, Calendar);

impl Model for TheClock {
    fn learn(&mut self, looks: &[Look]) {
        for look in looks {
            self.0.observe(*look, &self.1);
        }
    }

    fn look(&mut self, look: Look) {
        self.0.track(look, &self.1);
    }

    fn predict(&self, time_s: f64) -> f64 {
        self.0.probability(time_s, &self.1)
    }
}

/// A profile of mean states, towards which the last look fades.
pub(crate) struct Profile {
    kind: Kind,
    fades: bool,
    chain: Chain,
    slots: Vec<f64>,
}

/// What a profile knows.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// One mean.
    Mean,
    /// One mean per hour of the day, or of the week.
    Daily,
    Weekly,
}

impl Kind {
    fn slots(self) -> usize {
        match self {
            Self::Mean => 1,
            Self::Daily => 24,
            Self::Weekly => 168,
        }
    }

    fn slot(self, time_s: f64) -> usize {
        (time_s / DAY_S * 24.0).rem_euclid(self.slots() as f64) as usize
    }
}

impl Profile {
    pub(crate) fn new(kind: Kind, fades: bool) -> Self {
        Self { kind, fades, chain: Chain::new(EstimatorChoice::default(), false), slots: Vec::new() }
    }
}

impl Model for Profile {
    fn learn(&mut self, looks: &[Look]) {
        let mean = mean(looks);
        let mut sums = vec![[mean, 1.0]; self.kind.slots()];
        // Each hour of each day counts once.
        let mut at = 0;
        while at < looks.len() {
            let hour = (looks[at].time_s / 3600.0).floor();
            let end =
                at + looks[at..].iter().take_while(|look| (look.time_s / 3600.0).floor() == hour).count();
            let share = looks[at..end].iter().map(|look| state(*look)).sum::<f64>() / (end - at) as f64;
            let sum = &mut sums[self.kind.slot(looks[at].time_s)];
            *sum = [sum[0] + share, sum[1] + 1.0];
            at = end;
        }
        self.slots = sums.iter().map(|[blocked, all]| blocked / all).collect();
        if self.kind == Kind::Mean {
            self.slots = vec![mean];
        }
        self.chain.learn(looks);
    }

    fn look(&mut self, look: Look) {
        self.chain.look(look);
    }

    fn predict(&self, time_s: f64) -> f64 {
        let at = |time_s| self.slots[self.kind.slot(time_s)];
        match self.chain.last {
            Some(last) if self.fades => {
                at(time_s) + (state(last) - at(last.time_s)) * self.chain.memory(time_s - last.time_s)
            }
            _ => at(time_s),
        }
    }
}

/// The state of the last look.
#[derive(Default)]
pub(crate) struct LastSeen(Option<Look>);

impl Model for LastSeen {
    fn learn(&mut self, looks: &[Look]) {
        self.0 = looks.last().copied();
    }

    fn look(&mut self, look: Look) {
        self.0 = Some(look);
    }

    fn predict(&self, _: f64) -> f64 {
        self.0.map_or(0.5, state)
    }
}

/// The two-state chain with the rates of an estimator of the map.
pub(crate) struct Chain {
    estimator: EstimatorChoice,
    is_paced: bool,
    last: Option<Look>,
    leave: [f64; 2],
    pace: f64,
}

impl Chain {
    pub(crate) fn new(estimator: EstimatorChoice, is_paced: bool) -> Self {
        Self { estimator, is_paced, last: None, leave: [0.0; 2], pace: 1.0 }
    }

    fn memory(&self, elapsed_s: f64) -> f64 {
        (1.0 - (self.leave[0] + self.leave[1]) * STEP_S).max(0.0).powf(self.pace * elapsed_s / STEP_S)
    }
}

/// The squared coefficient of variation of the stays in each state that began and ended between looks.
fn variation(looks: &[Look]) -> [f64; 2] {
    let changes: Vec<Look> = looks
        .windows(2)
        .filter(|pair| pair[0].is_blocked != pair[1].is_blocked)
        .map(|pair| pair[1])
        .collect();
    [false, true].map(|is_blocked| {
        let stays = || {
            let pairs = changes.windows(2).filter(move |pair| pair[0].is_blocked == is_blocked);
            pairs.map(|pair| pair[1].time_s - pair[0].time_s)
        };
        let count = stays().count() as f64;
        let mean = stays().sum::<f64>() / count;
        let square = stays().map(|stay| (stay - mean) * (stay - mean)).sum::<f64>() / count;
        if count > 1.0 { square / (mean * mean) } else { 1.0 }
    })
}

impl Model for Chain {
    fn learn(&mut self, looks: &[Look]) {
        self.last = looks.last().copied();
        let (Some(first), Some(last)) = (looks.first(), looks.last()) else { return };
        let settings = MapperSettings { estimator: self.estimator.clone(), ..MapperSettings::default() };
        let frame = GridFrame::new(Point2::origin(), 1.0, 1, 1).expect("the frame is valid");
        let mut mapper = Mapper::new(&settings, frame).expect("the settings are valid");
        let mut next = looks.iter().peekable();
        for step in 0..=((last.time_s - first.time_s) / STEP_S).round() as usize {
            let time = first.time_s + step as f64 * STEP_S;
            let look = next.next_if(|look| look.time_s < time + 0.5 * STEP_S);
            let cells = look.map(|look| (Cell { x: 0, y: 0 }, look.is_blocked)).into_iter().collect();
            mapper
                .update(&CellReading { time: time - first.time_s, pose: Isometry2::identity(), cells })
                .expect("time goes on");
        }
        let (rates, share) = (self.estimator.transition_rates(&mapper.statistics(0)), mean(looks));
        self.leave = match rates {
            Some(rates) => [rates.block, rates.free],
            // Nothing changed: it stays as it is for as long as it was looked at.
            None => [share, 1.0 - share].map(|other| other / (last.time_s - first.time_s).max(STEP_S)),
        };
        if self.is_paced {
            let share = self.leave[0] / (self.leave[0] + self.leave[1]);
            let variation = variation(looks);
            self.pace = 2.0 / (1.0 + variation[0] * share + variation[1] * (1.0 - share));
        }
    }

    fn look(&mut self, look: Look) {
        self.last = Some(look);
    }

    fn predict(&self, time_s: f64) -> f64 {
        let share = self.leave[0] / (self.leave[0] + self.leave[1]);
        let Some(last) = self.last else { return share };
        share + (state(last) - share) * self.memory(time_s - last.time_s)
    }
}

/// FreMEn (Krajník et al., 2017): the mean and the `order` strongest harmonics of a week, down to one hour.
pub(crate) struct FreMEn {
    order: usize,
    mean: f64,
    /// Angular frequency, and the cosine and sine amplitudes.
    harmonics: Vec<[f64; 3]>,
}

impl FreMEn {
    pub(crate) fn new(order: usize) -> Self {
        Self { order, mean: 0.5, harmonics: Vec::new() }
    }
}

impl Model for FreMEn {
    fn learn(&mut self, looks: &[Look]) {
        self.mean = mean(looks);
        let mut harmonics: Vec<[f64; 3]> = (1..=168)
            .map(|per_week| {
                let frequency = std::f64::consts::TAU * f64::from(per_week) / (7.0 * DAY_S);
                let mut sums = [0.0; 2];
                for look in looks {
                    let (sin, cos) = (frequency * look.time_s).sin_cos();
                    let apart = state(*look) - self.mean;
                    sums = [sums[0] + apart * cos, sums[1] + apart * sin];
                }
                let scale = 2.0 / looks.len().max(1) as f64;
                [frequency, scale * sums[0], scale * sums[1]]
            })
            .collect();
        let power = |harmonic: &[f64; 3]| harmonic[1] * harmonic[1] + harmonic[2] * harmonic[2];
        harmonics.sort_by(|a, b| power(b).total_cmp(&power(a)));
        harmonics.truncate(self.order);
        self.harmonics = harmonics;
    }

    fn look(&mut self, _: Look) {}

    fn predict(&self, time_s: f64) -> f64 {
        let harmonic = |[frequency, cosine, sine]: &[f64; 3]| {
            let (sin, cos) = (frequency * time_s).sin_cos();
            cosine * cos + sine * sin
        };
        self.mean + self.harmonics.iter().map(harmonic).sum::<f64>()
    }
}

/// Persistence filter (Rosen, Mason and Leonard, 2016) with an exponential prior of the survival and perfect looks: a
/// blocked thing survives with its rate; what was seen to have gone does not come back.
pub(crate) struct Persistence(Chain);

impl Model for Persistence {
    fn learn(&mut self, looks: &[Look]) {
        self.0.learn(looks);
    }

    fn look(&mut self, look: Look) {
        self.0.look(look);
    }

    fn predict(&self, time_s: f64) -> f64 {
        match self.0.last {
            Some(last) if last.is_blocked => (-self.0.leave[1] * (time_s - last.time_s)).exp(),
            _ => 0.0,
        }
    }
}

/// A model with its name.
pub(crate) struct Named {
    pub(crate) name: String,
    /// Whether it is a simple baseline.
    pub(crate) is_baseline: bool,
    pub(crate) model: Box<dyn Model>,
}

/// Every model; the first is the clock.
pub(crate) fn all(calendar: &Calendar) -> Vec<Named> {
    let named = |name: &str, is_baseline, model| Named { name: name.to_owned(), is_baseline, model };
    let chain = |is_paced| Chain::new(EstimatorChoice::default(), is_paced);
    let profile = |kind, fades| Box::new(Profile::new(kind, fades));
    let mut models = vec![
        named("clock", false, Box::new(TheClock(Clock::default(), calendar.clone()))),
        named("mean", true, profile(Kind::Mean, false)),
        named("last seen", true, Box::<LastSeen>::default()),
        named("chain", true, Box::new(chain(false))),
        named("chain with pace", true, Box::new(chain(true))),
        named("daily", true, profile(Kind::Daily, false)),
        named("daily with memory", true, profile(Kind::Daily, true)),
        named("weekly", true, profile(Kind::Weekly, false)),
        named("weekly with memory", true, profile(Kind::Weekly, true)),
        named("persistence filter", true, Box::new(Persistence(chain(false)))),
    ];
    for order in 1..=4 {
        models.push(named(&format!("FreMEn {order}"), true, Box::new(FreMEn::new(order))));
    }
    for estimator in EstimatorChoice::all().into_iter().filter(|one| *one != EstimatorChoice::default()) {
        let name = format!("chain of {}", estimator.name());
        models.push(named(&name, false, Box::new(Chain::new(estimator, false))));
    }
    models
}

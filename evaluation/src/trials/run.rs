use super::{Sample, Trial, TrialError, TrialSettings, TrialStrategy, TrialWorld};
use crate::known_things::{KnownThings, KnownThingsScores};
use crate::metrics::{
    ChangingAccuracy, DevianceScores, Forecasts, PassageScores, Prediction, RateScores, map_scores,
    passage_scores, rate_scores,
};
use crate::observer::map_hash;
use agent::Features;
use interfaces::{CellReading, GroundTruth, Reading, TrueState};
use mapper::Mapper;
use robot::{GoalSelector, Pilot, Tour};

/// Runs one trial. `goes_on` is called at every reading; when it returns false, the trial is canceled and there is no result.
///
/// # Errors
/// When the trial cannot run.
pub fn run_trial<W: TrialWorld>(
    trial: &TrialSettings<W>,
    goes_on: impl FnMut() -> bool,
) -> Result<Option<Trial>, TrialError> {
    let own = trial.world.in_own_frame(&trial.experiment.robot, trial.seed);
    let world = own.as_ref().unwrap_or(trial.world);
    let trial = &TrialSettings { world, ..*trial };
    match trial.strategy {
        TrialStrategy::Agent(policy) => run(trial, W::agent(trial, policy)?, goes_on),
        TrialStrategy::FullObservation => run(trial, Tour::new(Vec::new(), false), goes_on),
    }
}

/// Runs a trial whose robot drives to the goals of `selector`.
fn run<W: TrialWorld, G: GoalSelector>(
    trial: &TrialSettings<W>,
    selector: G,
    mut goes_on: impl FnMut() -> bool,
) -> Result<Option<Trial>, TrialError> {
    let mut world = trial.world.start(trial.seed);
    let mut robot = W::robot(trial, &mut world, selector)?;
    let sees_all = *trial.strategy == TrialStrategy::FullObservation;
    let mut full_map = sees_all.then(|| robot.mapper.clone());
    let mut sampler = Sampler::new(trial.experiment.length);
    let (mut collisions, mut rates) = (None, None);
    let mut command = None;
    while rates.is_none() {
        let turn = robot::turn(&mut world, &mut robot, &mut command)?;
        let truth = W::truth(&world);
        if let Some(map) = &mut full_map {
            map.update(&observed(truth, &turn.reading))?;
        }
        let mapper = full_map.as_ref().unwrap_or(&robot.mapper);
        if let Some(world) = W::physics(&world) {
            let own = world.contacts().iter().filter(|contact| contact.moving);
            *collisions.get_or_insert(0) += own.count() as u64;
        }
        sampler.update::<W>(mapper, &world);
        if sampler.is_complete(mapper.time()) {
            rates = Some(rate_scores(mapper, truth));
        }
        robot.pilot.take_messages(); // they must not accumulate
        if !goes_on() {
            break;
        }
    }
    let Some(rates) = rates else { return Ok(None) };
    let mut mapper = full_map.unwrap_or(robot.mapper);
    let strategies = robot.pilot.strategies(Features::of(&mut mapper)).into_iter();
    Ok(Some(Trial {
        world: trial.world.name().to_owned(),
        estimator: trial.estimator.name().to_owned(),
        strategy: trial.strategy.name().to_owned(),
        seed: trial.seed,
        samples: sampler.samples,
        strategy_share: strategies.map(|strategy| (strategy.name, strategy.share)).collect(),
        false_change_events: rates.false_change_events,
        false_map_changes: rates.false_map_changes,
        collisions,
        map_hash: map_hash(&mapper),
    }))
}

/// The true state of every cell, except of cells that are partly covered, at the time and the pose of a reading. A map of these
/// readings has the errors of the estimator alone: it bounds what exploration can reach.
fn observed(truth: &impl GroundTruth, of_sensors: &impl Reading) -> CellReading {
    let frame = truth.frame();
    let cells = (0..frame.len()).filter_map(|index| match truth.state(index) {
        TrueState::PartlyCovered => None,
        state => Some((frame.cell(index), state == TrueState::Blocked)),
    });
    CellReading { time: of_sensors.time(), pose: *of_sensors.pose(), cells: cells.collect() }
}

/// The number of samples of a trial.
const SAMPLES: u64 = 80;
/// Times are sums of steps of a physics world, s.
const SLACK: f64 = 1e-6;

/// Measures a trial at every reading, and samples the metrics.
#[derive(Default)]
struct Sampler {
    length: u64,
    /// The time of the next sample.
    due: u64,
    samples: Vec<Sample>,
    readings: usize,
    /// The number of checks whether a swept cell is in view, and of those that found one.
    views: usize,
    views_of_changes: usize,
    /// Since the last sample.
    accuracy: ChangingAccuracy,
    /// Since the last sample.
    prediction: Prediction,
    /// Since the last sample.
    prediction_of_all: Prediction,
    forecasts: Forecasts,
    known_things: KnownThings,
}

impl Sampler {
    /// A sampler for a trial of a length.
    fn new(length: u64) -> Self {
        Self { length, due: sample_time(0, length), ..Self::default() }
    }

    /// Measures one reading, and takes a sample if one is due.
    fn update<W: TrialWorld>(&mut self, mapper: &Mapper, world: &W::World) {
        let truth = W::truth(world);
        let physics = W::physics(world);
        physics.into_iter().for_each(|world| self.known_things.sample(world, mapper));
        let is_due = has_come(mapper.time(), self.due);
        self.forecasts.observe(mapper, truth, None);
        if is_due || self.readings.is_multiple_of(W::COMPARE_EVERY) {
            self.accuracy.sample(mapper, truth);
            self.prediction.sample(mapper, truth, None, |index| !mapper.is_in_view(index));
            self.prediction_of_all.sample(mapper, truth, None, |_| true);
        }
        if self.readings.is_multiple_of(W::VIEW_EVERY) {
            self.views += 1;
            self.views_of_changes += usize::from(truth.swept().iter().any(|&index| mapper.is_in_view(index)));
        }
        self.readings += 1;
        if is_due {
            let things = physics.map(|world| self.known_things.rows(world, mapper)).unwrap_or_default();
            let sample = self.sample(mapper, truth, KnownThingsScores::of(&things));
            self.samples.push(sample);
            self.due = sample_time(self.samples.len() as u64, self.length);
        }
    }

    /// Whether the trial is complete at a time.
    fn is_complete(&self, time: f64) -> bool {
        has_come(time, self.length)
    }

    fn sample(
        &mut self,
        mapper: &Mapper,
        truth: &impl GroundTruth,
        things: Option<KnownThingsScores>,
    ) -> Sample {
        let (rates, map) = (rate_scores(mapper, truth), map_scores(mapper, truth));
        let RateScores { rate_error_all, log_error, log_error_of_range, rate_auc, false_rate_hz, .. } = rates;
        let PassageScores { log_error_busy, busiest_tenth_hit } = passage_scores(mapper, truth);
        let DevianceScores { predictive_deviance, predictive_deviance_known, .. } =
            self.forecasts.scores().rates;
        let brier = std::mem::take(&mut self.prediction).scores();
        let things = things.and_then(|things| things.all.now);
        let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
        Sample {
            time: self.due,
            rate_error: or_nan(rate_error_all),
            log_error: or_nan(log_error),
            log_error_of_range: or_nan(log_error_of_range),
            map_quality: map.map_quality,
            map_quality_changing: or_nan(std::mem::take(&mut self.accuracy).scores().all),
            coverage: map.coverage,
            false_rate: false_rate_hz,
            changing_share: self.views_of_changes as f64 / self.views as f64,
            brier: or_nan(brier.brier),
            brier_of_all: or_nan(std::mem::take(&mut self.prediction_of_all).scores().brier),
            brier_last_seen: or_nan(brier.brier_last_seen),
            brier_mean: or_nan(brier.brier_mean),
            rate_auc: or_nan(rate_auc),
            predictive_deviance: or_nan(predictive_deviance),
            predictive_deviance_known: or_nan(predictive_deviance_known),
            passages_log_error: or_nan(log_error_busy),
            busiest_tenth_hit: or_nan(busiest_tenth_hit),
            things_by_nominal: or_nan(things.map(|things| things.by_nominal)),
            things_by_floor: or_nan(things.map(|things| things.by_floor)),
        }
    }
}

fn has_come(time: f64, due: u64) -> bool {
    time >= due as f64 - SLACK
}

/// The time of the sample of a number: denser early, the last one at the end.
fn sample_time(number: u64, length: u64) -> u64 {
    let part = (number + 1) as f64 / SAMPLES as f64;
    // Every time later than the one before, also in a short trial.
    let time = (length as f64 * part * part.sqrt()).round() as u64;
    if number >= SAMPLES { u64::MAX } else { time.max(number + 1).min(length) }
}

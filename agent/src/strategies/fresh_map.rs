use super::{Pick, Stay, Strategy};
use crate::settings::AgentSettings;
use crate::situation::Situation;
use crate::visibility::ViewHistory;
use interfaces::{Cell, CellState, Values};
use mapper::Mapper;

/// The duration of the stop at a goal, in the time unit of the readings: one look, or a watch over what changes too fast for a look.
const LOOK: f64 = 1.0;
const WATCH: f64 = 5.0;

/// The number of events that is assumed for a cell that never changed: one half, as in the Jeffreys posterior of a
/// Poisson rate.
const UNSEEN_EVENTS: f64 = 0.5;

/// Keeps the predicted map right: goes where a look takes most away from its Brier score, per time.
///
/// The Brier score of a cell that is blocked with the probability p is its variance p (1 − p). A look removes it, and what was
/// seen fades with ρ(τ) = e^(−sτ), where s is the sum of the rates at which the cell leaves and enters its state. So a look is worth
/// p (1 − p) ∫ρ² dτ until the next one, which is expected to come as late as the last one was. What changes too fast is worth
/// little: the look is soon of no use. But as long as the robot stays, the score of the cells in view is 0 instead of the variance that
/// each of them has in the long run. The value of a goal is the sum of both over the cells in view from there, per time to get there
/// and to stay; the robot stays for one look or longer, whichever is worth more.
///
/// The rate of a cell that never changed is not known. Such a cell is worth as much as a cell with half an event in
/// its observation time, times the share of cells that ever changed. A cell that was never seen is blocked with a probability of
/// one half.
///
/// The gain of the crate `days`, here for the cells of a map.
#[derive(Clone, Debug)]
pub struct FreshMap {
    history: ViewHistory,
    /// How long the robot stays at the goal that was weighed highest.
    stay: f64,
}

impl FreshMap {
    /// The strategy of a robot whose sensor has the range `settings.sensor_radius_m`.
    pub fn new(settings: &AgentSettings) -> Self {
        Self { history: ViewHistory::new(settings.sensor_radius_m), stay: LOOK }
    }
}

/// What a look takes away from the Brier score until the next look, a time `until_next` later, of a cell whose probability of being
/// blocked has this variance and whose state is forgotten at the rate `sum`.
fn gain(variance: f64, sum: f64, until_next: f64) -> f64 {
    let twice = 2.0 * sum;
    if twice * until_next < 1e-9 {
        return variance * until_next;
    }
    variance * -libm::expm1(-twice * until_next) / twice
}

impl Strategy for FreshMap {
    fn name(&self) -> &'static str {
        "fresh-map"
    }

    fn end(&mut self, situation: &Situation) {
        self.history.end(situation);
    }

    fn values(&mut self, mapper: &Mapper) -> Values<'_> {
        self.history.values(mapper)
    }

    fn weigh(&mut self, situation: &Situation, weights: &mut [f64]) {
        let mapper = situation.mapper;
        let regions = self.history.update(mapper);
        let states = mapper.states().cells();
        let candidates = (0..states.len()).filter(|&cell| mapper.is_candidate(cell));
        let known = candidates.filter(|&cell| states[cell] != CellState::Unknown).count();
        // Without this share, a robot would stay with the first moving thing.
        let changing = (mapper.changed().count() as f64 + UNSEEN_EVENTS) / (known as f64 + 1.0);
        // What a look is worth, and what each unit of time in view.
        let (mut looks, mut views) = (vec![0.0; regions.count()], vec![0.0; regions.count()]);
        for cell in (0..weights.len()).filter(|&cell| mapper.is_candidate(cell)) {
            let elapsed = self.history.elapsed(mapper, cell);
            let (look, view) = match (states[cell], mapper.transition_rates(cell)) {
                (CellState::Unknown, _) => (gain(0.25, 0.0, elapsed), 0.0),
                (_, Some((block, free))) => {
                    let (blocked, sum) = (mapper.blocked_probability(cell), block + free);
                    let view = if sum > 0.0 { block / sum * (free / sum) } else { 0.0 };
                    (gain(blocked * (1.0 - blocked), sum, elapsed), view)
                }
                (_, None) => {
                    let seen = mapper.statistics(cell);
                    let rate = UNSEEN_EVENTS / (seen.watched_free + seen.watched_blocked + 1.0);
                    let probability = if seen.events() > 0 { 1.0 } else { changing.min(1.0) };
                    let changed = probability * -0.5 * libm::expm1(-2.0 * rate * elapsed);
                    (gain(changed * (1.0 - changed), 2.0 * rate, elapsed), 0.0)
                }
            };
            looks[regions.of(cell)] += look;
            views[regions.of(cell)] += view;
        }
        let mut best = f64::NEG_INFINITY;
        for stay in [LOOK, WATCH] {
            let worth: Vec<f64> = looks.iter().zip(&views).map(|(look, view)| look + view * stay).collect();
            let mut found = vec![0.0; weights.len()];
            self.history.weigh(situation, &regions, &worth, stay, &mut found);
            let highest = found.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            if highest > best {
                (best, self.stay) = (highest, stay);
                weights.copy_from_slice(&found);
            }
        }
    }

    fn pick(&self) -> Pick {
        Pick::Best
    }

    fn stay(&mut self, goal: Cell) -> Stay {
        self.history.go_to(goal);
        Stay::Watch(self.stay)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum of the variances of a chain without and with a look, step by step.
    #[test]
    fn the_gain_is_what_a_look_takes_away() {
        let (block, free, until_next) = (0.01, 0.03, 40.0);
        let sum: f64 = block + free;
        let mean = block / sum;
        let variance = |p: f64| p * (1.0 - p);
        let before: f64 = 0.4;
        let (mut lost, step) = (0.0, 0.01);
        for at in 0..(until_next / step) as usize {
            let fade = (-sum * (at as f64 + 0.5) * step).exp();
            let later = |p: f64| mean + (p - mean) * fade;
            let after = before * variance(later(1.0)) + (1.0 - before) * variance(later(0.0));
            lost += (variance(later(before)) - after) * step;
        }
        let found = gain(variance(before), sum, until_next);
        assert!((found / lost - 1.0).abs() < 1e-3, "{found} against {lost}");
        assert_eq!(gain(0.25, 0.0, 8.0), 2.0);
    }
}

use super::cells::Run;
use crate::calendar::{Habit, Law, Matrix, PHASES, Phases, advanced};
use crate::{Model, STEP_S};

/// Points of the grid of the probability that the present stay is a long one, for each state.
pub(super) const POINTS: usize = 5;
/// Beliefs after a look: both states, with each probability of a long stay.
pub(super) const BELIEFS: usize = 2 * POINTS;

/// The probability of a long stay at a point of the grid.
pub(super) fn long_share(point: usize) -> f64 {
    point as f64 / (POINTS - 1) as f64
}

/// A look: the probability of a state that it may show, and the place of the belief after it on the grid: the lower point
/// and the share of the upper one.
pub(super) fn seen(law: &Phases, is_blocked: bool) -> (f64, usize, f64) {
    let first = 2 * usize::from(is_blocked);
    let probability = law[first] + law[first + 1];
    if probability < 1e-300 {
        return (0.0, 0, 0.0);
    }
    let place = (law[first + 1] / probability).clamp(0.0, 1.0) * (POINTS - 1) as f64;
    let point = (place as usize).min(POINTS - 2);
    (probability, point, place - point as f64)
}

/// What happens to a thing in the runs of a time grid.
pub(super) struct Chain {
    pub(super) start: Phases,
    /// The transitions in a step, in quiet and in active hours.
    pub(super) steps: [Matrix; 2],
    pub(super) runs: Vec<Passage>,
}

/// What happens in a run of steps.
pub(super) struct Passage {
    transitions: Matrix,
    /// The sum over its steps of the probability of being blocked, for each phase in which it begins.
    blocked: Phases,
    /// The sum over its steps of the products of these probabilities for two phases.
    products: Matrix,
    /// Where the belief at its end is, for each belief after a look at its beginning, if the thing is watched at every step.
    /// The value of beliefs is concave, so that reading it off between two points is a lower bound.
    watched: Vec<f64>,
}

/// The sums of probabilities of being blocked, and of their products, over the steps since a look, for two laws.
#[derive(Clone, Copy, Default)]
pub(super) struct Sums {
    blocked: [f64; 2],
    products: [f64; 3],
}

impl Sums {
    /// The sum of the variances of the state, where the second law has this share.
    pub(super) fn variance(&self, share: f64) -> f64 {
        let other = 1.0 - share;
        let [first, both, second] = self.products;
        other * self.blocked[0] + share * self.blocked[1]
            - (other * other * first + 2.0 * other * share * both + share * share * second)
    }
}

impl Chain {
    pub(super) fn new(habit: &Habit, runs: &[Run]) -> Self {
        let steps = [false, true].map(|is_active| habit.transitions(is_active, STEP_S));
        let powers = steps.map(|step| {
            let mut powers = vec![watched_step(&step)];
            for power in 0..longest(runs).checked_ilog2().unwrap_or(0) as usize {
                powers.push(product(&powers[power], &powers[power]));
            }
            powers
        });
        let passage = |run: &Run| {
            let regime = usize::from(run.is_active);
            Passage::new(&steps[regime], &powers[regime], run.steps)
        };
        Self { start: *Model::of(habit).start(), steps, runs: runs.iter().map(passage).collect() }
    }
}

fn longest(runs: &[Run]) -> usize {
    runs.iter().map(|run| run.steps).max().unwrap_or(0)
}

impl Passage {
    fn new(step: &Matrix, watched_powers: &[Vec<f64>], steps: usize) -> Self {
        let identity: Matrix =
            std::array::from_fn(|row| std::array::from_fn(|at| f64::from(u8::from(row == at))));
        let mut all = Self {
            transitions: identity,
            blocked: [0.0; PHASES],
            products: [[0.0; PHASES]; PHASES],
            watched: Vec::new(),
        };
        // The number of steps bit by bit: twice as many, or one more.
        for bit in (0..usize::BITS - steps.leading_zeros()).rev() {
            all.double();
            if steps >> bit & 1 == 1 {
                all.add_one(step);
            }
        }
        let mut factors = (0..watched_powers.len()).filter(|bit| steps >> bit & 1 == 1);
        all.watched = factors.next().map_or_else(watched_nothing, |bit| watched_powers[bit].clone());
        for bit in factors {
            all.watched = product(&all.watched, &watched_powers[bit]);
        }
        all
    }

    fn double(&mut self) {
        let before = self.transitions;
        let later = before.map(|row| dot(&row, &self.blocked));
        self.blocked = std::array::from_fn(|phase| self.blocked[phase] + later[phase]);
        let later = sandwich(&before, &self.products);
        self.products = std::array::from_fn(|row| {
            std::array::from_fn(|column| self.products[row][column] + later[row][column])
        });
        self.transitions = before.map(|row| advanced(&row, &before));
    }

    /// One more step, before the others.
    fn add_one(&mut self, step: &Matrix) {
        let blocked = |phase: usize| f64::from(u8::from(phase >= PHASES / 2));
        self.blocked = std::array::from_fn(|phase| blocked(phase) + dot(&step[phase], &self.blocked));
        let later = sandwich(step, &self.products);
        self.products = std::array::from_fn(|row| {
            std::array::from_fn(|column| blocked(row) * blocked(column) + later[row][column])
        });
        self.transitions = step.map(|row| advanced(&row, &self.transitions));
    }

    /// The run passes without a look.
    pub(super) fn pass(&self, laws: &mut [Phases; 2], sums: &mut Sums) {
        let [first, second] = *laws;
        let half = |law: &Phases| self.products.map(|row| dot(law, &row));
        let (half_first, half_second) = (half(&first), half(&second));
        sums.blocked[0] += dot(&first, &self.blocked);
        sums.blocked[1] += dot(&second, &self.blocked);
        sums.products[0] += dot(&first, &half_first);
        sums.products[1] += dot(&second, &half_first);
        sums.products[2] += dot(&second, &half_second);
        *laws = [advanced(&first, &self.transitions), advanced(&second, &self.transitions)];
    }

    /// The expected values of the beliefs at the end, from beliefs at the beginning, if the thing is watched in between.
    /// There are as many values for each belief as there are lists of prices.
    pub(super) fn watch(&self, values: &[f64], before: &mut [f64]) {
        let lists = values.len() / BELIEFS;
        before.fill(0.0);
        for (row, before) in self.watched.chunks_exact(BELIEFS).zip(before.chunks_exact_mut(lists)) {
            for (share, values) in
                row.iter().zip(values.chunks_exact(lists)).filter(|(share, _)| **share > 0.0)
            {
                before.iter_mut().zip(values).for_each(|(before, value)| *before += share * value);
            }
        }
    }
}

fn dot(left: &Phases, right: &Phases) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

/// `step` × `products` × `step` transposed.
fn sandwich(step: &Matrix, products: &Matrix) -> Matrix {
    let half = step.map(|row| advanced(&row, products));
    half.map(|row| std::array::from_fn(|column| dot(&row, &step[column])))
}

/// Where the belief after a look is after a step and one more look.
fn watched_step(step: &Matrix) -> Vec<f64> {
    let mut watched = vec![0.0; BELIEFS * BELIEFS];
    for (belief, row) in watched.chunks_exact_mut(BELIEFS).enumerate() {
        let (state, long) = (belief / POINTS, long_share(belief % POINTS));
        let law = std::array::from_fn(|phase| {
            (1.0 - long) * step[2 * state][phase] + long * step[2 * state + 1][phase]
        });
        for is_blocked in [false, true] {
            let (probability, point, share) = seen(&law, is_blocked);
            let first = usize::from(is_blocked) * POINTS + point;
            row[first] += probability * (1.0 - share);
            row[first + 1] += probability * share;
        }
    }
    watched
}

fn watched_nothing() -> Vec<f64> {
    let mut identity = vec![0.0; BELIEFS * BELIEFS];
    identity.iter_mut().step_by(BELIEFS + 1).for_each(|value| *value = 1.0);
    identity
}

fn product(left: &[f64], right: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; BELIEFS * BELIEFS];
    for (left, row) in left.chunks_exact(BELIEFS).zip(product.chunks_exact_mut(BELIEFS)) {
        for (factor, right) in
            left.iter().zip(right.chunks_exact(BELIEFS)).filter(|(factor, _)| **factor > 0.0)
        {
            row.iter_mut().zip(right).for_each(|(value, right)| *value += factor * right);
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calendar::{Hours, Stays, blocked_probability};

    #[test]
    fn a_run_is_its_steps() {
        let stays = |short_s, long_s| Stays { short_s, long_s, long_share: 0.3 };
        let habit = Habit {
            hours: Hours::always(),
            active: [stays(60.0, 900.0), stays(30.0, 700.0)],
            quiet: [Stays::of_mean(90.0), Stays::of_mean(50.0)],
        };
        for (steps, is_active) in [(0, true), (1, true), (13, true), (100, false)] {
            let chain = Chain::new(&habit, &[Run { is_active, steps }]);
            let start = [[0.7, 0.3, 0.0, 0.0], [0.0, 0.0, 0.1, 0.9]];
            let (mut laws, mut sums) = (start, Sums::default());
            chain.runs[0].pass(&mut laws, &mut sums);
            let (mut slow, mut variance) = (start, 0.0);
            for _ in 0..steps {
                let p = 0.75 * blocked_probability(&slow[0]) + 0.25 * blocked_probability(&slow[1]);
                variance += p * (1.0 - p);
                slow = slow.map(|law| advanced(&law, &chain.steps[usize::from(is_active)]));
            }
            assert!((sums.variance(0.25) - variance).abs() < 1e-10, "{steps}");
            assert!(laws.iter().flatten().zip(slow.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-12));
            // Watching only tells more: the probability of each state at the end is that of the law.
            let blocked: Vec<f64> =
                (0..BELIEFS).map(|belief| f64::from(u8::from(belief >= POINTS))).collect();
            let mut before = vec![0.0; BELIEFS];
            chain.runs[0].watch(&blocked, &mut before);
            let mut law = [0.0, 1.0, 0.0, 0.0];
            (0..steps).for_each(|_| law = advanced(&law, &chain.steps[usize::from(is_active)]));
            assert!((before[POINTS - 1] - blocked_probability(&law)).abs() < 0.01, "{}", before[POINTS - 1]);
        }
    }
}

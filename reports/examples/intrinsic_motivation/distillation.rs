//! Random network distillation (Burda et al. 2018): how badly a network predicts what a fixed random network makes of an
//! observation. The error falls where the robot was often.

use crate::motives::Motive;
use crate::view::View;
use interfaces::RandomStream;

/// The view around the robot: a square of this side, cells.
const SIDE: i32 = 9;
/// The waves over the map that stand for the robot's place, per axis, and the longest one, cells.
const WAVES: usize = 4;
const LONGEST: f64 = 64.0;
/// The numbers of inputs, hidden units and outputs.
const INPUTS: usize = (SIDE * SIDE) as usize + 4 * WAVES;
const HIDDEN: usize = 64;
const OUTPUTS: usize = 16;
/// The step size of gradient descent.
const STEP: f32 = 0.05;

/// Two layers: rectified linear units, then linear outputs. Weights are stored by input.
#[derive(Clone, Debug)]
struct Network {
    first: Vec<[f32; HIDDEN]>,
    second: Vec<[f32; OUTPUTS]>,
}

impl Network {
    fn random(rng: &mut RandomStream) -> Self {
        let mut draw = |inputs: usize, gain: f64| (rng.normal() * (gain / inputs as f64).sqrt()) as f32;
        let first = (0..INPUTS).map(|_| std::array::from_fn(|_| draw(INPUTS, 2.0))).collect();
        let second = (0..HIDDEN).map(|_| std::array::from_fn(|_| draw(HIDDEN, 2.0))).collect();
        Self { first, second }
    }

    fn run(&self, input: &[f32]) -> ([f32; HIDDEN], [f32; OUTPUTS]) {
        let mut hidden = [0.0; HIDDEN];
        for (weights, &x) in self.first.iter().zip(input).filter(|(_, x)| **x != 0.0) {
            hidden.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * x);
        }
        let mut output = [0.0; OUTPUTS];
        for (weights, unit) in self.second.iter().zip(&mut hidden) {
            *unit = unit.max(0.0);
            output.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += weight * *unit);
        }
        (hidden, output)
    }
}

/// The two networks.
#[derive(Debug)]
pub(crate) struct Distillation {
    target: Network,
    predictor: Network,
    input: Vec<f32>,
}

impl Distillation {
    pub(crate) fn new(rng: &mut RandomStream) -> Self {
        let (target, predictor) = (Network::random(rng), Network::random(rng));
        Self { target, predictor, input: vec![0.0; INPUTS] }
    }

    /// The mean squared error for an observation, before one step of gradient descent on the observation.
    fn learn(&mut self) -> f64 {
        let Self { target, predictor, input } = self;
        let (_, wanted) = target.run(input);
        let (hidden, output) = predictor.run(input);
        let errors: [f32; OUTPUTS] = std::array::from_fn(|unit| output[unit] - wanted[unit]);
        let mut back = [0.0; HIDDEN];
        for ((weights, &unit), back) in predictor.second.iter_mut().zip(&hidden).zip(&mut back) {
            if unit > 0.0 {
                *back = weights.iter().zip(&errors).map(|(weight, error)| weight * error).sum();
                let step = STEP * unit / OUTPUTS as f32;
                weights.iter_mut().zip(&errors).for_each(|(weight, error)| *weight -= step * error);
            }
        }
        for (weights, &x) in predictor.first.iter_mut().zip(&*input).filter(|(_, x)| **x != 0.0) {
            let step = STEP * x / OUTPUTS as f32;
            weights.iter_mut().zip(&back).for_each(|(weight, back)| *weight -= step * back);
        }
        f64::from(errors.iter().map(|error| error * error).sum::<f32>()) / OUTPUTS as f64
    }

    /// Cells around the robot: 1 blocked, −1 free, 0 not in view. Then sine and cosine of the place, by wave.
    fn observe(&mut self, view: &View) {
        self.input.fill(0.0);
        let reach = SIDE / 2;
        for &(index, is_blocked) in &view.cells {
            let cell = view.frame.cell(index);
            let (dx, dy) = (cell.x - view.robot.x + reach, cell.y - view.robot.y + reach);
            if (0..SIDE).contains(&dx) && (0..SIDE).contains(&dy) {
                self.input[(dy * SIDE + dx) as usize] = if is_blocked { 1.0 } else { -1.0 };
            }
        }
        let place = &mut self.input[(SIDE * SIDE) as usize..];
        for (wave, inputs) in place.chunks_mut(4).enumerate() {
            let per_cell = std::f64::consts::TAU * f64::from(1 << wave) / LONGEST;
            let [x, y] = [view.robot.x, view.robot.y].map(|along| libm::sincos(per_cell * f64::from(along)));
            inputs.copy_from_slice(&[x.0, x.1, y.0, y.1].map(|value| 2.0 * value as f32));
        }
    }
}

impl Motive for Distillation {
    fn reward(&mut self, view: &View) -> f64 {
        self.observe(view);
        self.learn()
    }
}

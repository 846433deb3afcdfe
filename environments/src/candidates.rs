//! What a learner sees of a candidate goal: what can be seen from there, by the map.

use agent::Goal;
use interfaces::{Cell, CellState};
use mapper::Mapper;
use nalgebra::{Point2, Vector2};
use std::f64::consts::TAU;

/// The features of a candidate, each from 0 to 1.
pub(crate) const FEATURES: [(&str, usize); 9] = [
    // The travel time, a share of a minute; 1 without a path.
    ("travel", 1),
    // The distance as the crow flies, a share of 10 m.
    ("distance", 1),
    // The unknown area that may come into view: u / (u + 5 m²).
    ("unseen", 1),
    // The known free area in view: a / (a + 20 m²).
    ("area", 1),
    // How long ago this area was seen, the mean of 1 − e^(−time / 60 s).
    ("age", 1),
    // The cells in view that have probably changed since they were seen: n / (n + 20).
    ("expected_changes", 1),
    // The changes per minute in view, by the learned rates: n / (n + 20).
    ("rate", 1),
    // Whether the goal is in view now.
    ("in_view", 1),
    // The goal is that of the last choice, or within half a meter of it.
    ("same", 1),
];

/// The rays from a goal, their greatest length and their steps, m.
const RAYS: usize = 48;
const RAY_M: f64 = 6.0;
const STEP_M: f64 = 0.1;
/// How far a ray goes on in unknown space, m: behind that, walls may be.
const UNKNOWN_M: f64 = 1.5;

/// A goal that can be chosen.
#[derive(Clone, Copy, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Candidate {
    /// The position, m.
    pub(crate) at: [f64; 2],
    /// How long the robot stops there, s; `None`: it explores around the goal.
    pub(crate) watch: Option<f64>,
    pub(crate) features: [f32; FEATURES.len()],
}

impl Candidate {
    pub(crate) fn position(&self) -> Point2<f64> {
        self.at.into()
    }

    /// The candidate for a goal; the robot is at `from` and needs `travel_s`. `last` is the goal of the last choice.
    pub(crate) fn new(
        mapper: &Mapper,
        goal: &Goal,
        from: &Point2<f64>,
        travel_s: f64,
        last: Option<[f64; 2]>,
    ) -> Self {
        let at = mapper.frame().center(goal.cell);
        let view = View::from(mapper, &at);
        let is_in_view = mapper.frame().index(goal.cell).is_some_and(|index| mapper.is_in_view(index));
        let is_same = last.is_some_and(|last| nalgebra::distance(&last.into(), &at) <= 0.5);
        let share = |value: f64, half: f64| value / (value + half);
        let features = [
            if travel_s.is_finite() { travel_s / 60.0 } else { 1.0 },
            nalgebra::distance(from, &at) / 10.0,
            share(view.unknown_m2, 5.0),
            share(view.known_m2, 20.0),
            view.age / view.known_m2.max(1e-9),
            share(view.changes, 20.0),
            share(60.0 * view.rate, 20.0),
            f64::from(u8::from(is_in_view)),
            f64::from(u8::from(is_same)),
        ];
        let watch = match goal.stay {
            agent::Stay::Explore => None,
            agent::Stay::Watch(duration_s) => Some(duration_s),
        };
        Self { at: at.into(), watch, features: features.map(|value| value.clamp(0.0, 1.0) as f32) }
    }
}

/// Sums over what rays from a point meet in the map.
#[derive(Clone, Copy, Debug, Default)]
struct View {
    unknown_m2: f64,
    known_m2: f64,
    /// The sum of 1 − e^(−time / 60 s) over the known area, m².
    age: f64,
    /// The expected number of changed cells.
    changes: f64,
    /// The changes per second.
    rate: f64,
}

impl View {
    fn from(mapper: &Mapper, at: &Point2<f64>) -> Self {
        let mut view = Self::default();
        (0..RAYS).for_each(|ray| view.cast(mapper, at, TAU * ray as f64 / RAYS as f64));
        view
    }

    fn cast(&mut self, mapper: &Mapper, at: &Point2<f64>, angle_rad: f64) {
        let (frame, (sin, cos)) = (mapper.frame(), libm::sincos(angle_rad));
        let cell_m2 = frame.resolution_m().powi(2);
        let mut unknown_m = 0.0;
        for step in 0..(RAY_M / STEP_M) as usize {
            let along_m = (step as f64 + 0.5) * STEP_M;
            let cell: Cell = frame.cell_at(&(at + Vector2::new(cos, sin) * along_m));
            let Some(index) = frame.index(cell) else { return };
            let m2 = along_m * STEP_M * TAU / RAYS as f64;
            let state = mapper.states().cells()[index];
            if state == CellState::Unknown {
                unknown_m += STEP_M;
                if unknown_m > UNKNOWN_M {
                    return;
                }
                self.unknown_m2 += m2;
                continue;
            }
            self.changes += mapper.change_probability(index) * m2 / cell_m2;
            self.rate += mapper.acting_rate(index) * m2 / cell_m2;
            if state == CellState::Blocked && along_m > 0.3 {
                return;
            }
            self.known_m2 += m2;
            self.age += m2 * (1.0 - libm::exp(-mapper.recency(index) / 60.0));
        }
    }
}

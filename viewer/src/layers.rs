//! The maps as a person looks at them: every cell gets a class, and every class a colour and a
//! meaning. The recording and the pictures share them, so that a colour means the same in both.

use crate::view::TimeUnit;
pub use evaluation::drawing::{CURIOUS, Rgb};
use interfaces::CellState;
use mapper::Mapper;

/// The colour of the other robots: green, as in Figure 4.
pub const OTHERS: Rgb = [26, 158, 64];

/// A map to look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Unknown, free or blocked.
    Occupancy,
    /// Mean time of a cycle, T of equation 1.
    Interval,
    /// Probability of a change since the cell was last seen, equation 2.
    ChangeProbability,
    /// Time since the cell was last seen.
    Recency,
}

/// A cell that was never seen.
const UNKNOWN: u8 = 1;
/// A free cell about which the layer has nothing to tell.
const FREE: u8 = 2;
/// A blocked cell about which the layer has nothing to tell.
const BLOCKED: u8 = 3;
/// The class of the lowest value on a layer's scale. Class 0 stays unused: the viewer draws it as
/// nothing.
const FIRST: u8 = 4;
/// The number of steps of a scale: finer than an eye can tell apart.
const STEPS: u8 = 64;

/// How a layer turns a value into a place on its colour bar, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The value at the lower end.
    pub low: f64,
    /// The value at the upper end.
    pub high: f64,
    /// Whether equal ratios, and not equal differences, are equally long.
    pub is_log: bool,
}

impl Scale {
    /// The place of `value` on the colour bar, cut to [0, 1].
    pub fn place(&self, value: f64) -> f64 {
        let at = |value: f64| if self.is_log { libm::log(value) } else { value };
        ((at(value) - at(self.low)) / (at(self.high) - at(self.low))).clamp(0.0, 1.0)
    }

    /// The value at a place of the colour bar; the inverse of [`Scale::place`].
    fn value(&self, place: f64) -> f64 {
        if self.is_log {
            self.low * libm::pow(self.high / self.low, place)
        } else {
            self.low + (self.high - self.low) * place
        }
    }

    fn class(&self, value: f64) -> u8 {
        FIRST + ((self.place(value) * f64::from(STEPS)) as u8).min(STEPS - 1)
    }
}

impl Layer {
    /// Every layer, in the order in which they are shown.
    pub const ALL: [Self; 4] = [Self::Occupancy, Self::Interval, Self::ChangeProbability, Self::Recency];

    /// The name in entity paths and file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Occupancy => "occupancy",
            Self::Interval => "interval",
            Self::ChangeProbability => "change_probability",
            Self::Recency => "recency",
        }
    }

    /// The title above the map.
    pub fn title(self, unit: TimeUnit) -> String {
        match self {
            Self::Occupancy => "Occupancy".into(),
            Self::Interval => format!("Change interval: {} per cycle", unit.plural()),
            Self::ChangeProbability => "Probability of a change since last seen".into(),
            Self::Recency => format!("Recency: {} since last seen", unit.plural()),
        }
    }

    /// The scale of the colour bar; `None` for the occupancy.
    pub fn scale(self, unit: TimeUnit) -> Option<Scale> {
        match (self, unit) {
            (Self::Occupancy, _) => None,
            // A door, a robot passing, a chair: two decades around half a minute.
            (Self::Interval, TimeUnit::Second) => Some(Scale { low: 5.0, high: 500.0, is_log: true }),
            // A cell's way of a block that moves in every step, or one that stands for hundreds.
            (Self::Interval, TimeUnit::Step) => Some(Scale { low: 5.0, high: 2000.0, is_log: true }),
            (Self::ChangeProbability, _) => Some(Scale { low: 0.0, high: 1.0, is_log: false }),
            (Self::Recency, TimeUnit::Second) => Some(Scale { low: 1.0, high: 1000.0, is_log: true }),
            (Self::Recency, TimeUnit::Step) => Some(Scale { low: 1.0, high: 5000.0, is_log: true }),
        }
    }

    /// The marks of the colour bar: value and text.
    pub fn ticks(self, unit: TimeUnit) -> &'static [(f64, &'static str)] {
        match (self, unit) {
            (Self::Occupancy, _) => &[],
            (Self::Interval, TimeUnit::Second) => &[
                (5.0, "5"),
                (10.0, "10"),
                (20.0, "20"),
                (50.0, "50"),
                (100.0, "100"),
                (200.0, "200"),
                (500.0, "500"),
            ],
            (Self::Interval, TimeUnit::Step) => {
                &[(5.0, "5"), (20.0, "20"), (50.0, "50"), (200.0, "200"), (500.0, "500"), (2000.0, "2000")]
            }
            (Self::ChangeProbability, _) => {
                &[(0.0, "0"), (0.25, "0.25"), (0.5, "0.5"), (0.75, "0.75"), (1.0, "1")]
            }
            (Self::Recency, _) => &[(1.0, "1"), (10.0, "10"), (100.0, "100"), (1000.0, "1000")],
        }
    }

    /// The class of every cell of the mapper's frame in row-major order.
    pub fn classes(self, mapper: &Mapper, unit: TimeUnit) -> Vec<u8> {
        let states = mapper.states().cells();
        let Some(scale) = self.scale(unit) else {
            return states.iter().map(|&state| plain(state)).collect();
        };
        if self == Self::Recency {
            // Every cell that was seen has one.
            let class = |index| {
                if mapper.was_ever_seen(index) { scale.class(mapper.recency(index)) } else { UNKNOWN }
            };
            return (0..states.len()).map(class).collect();
        }
        let mut classes: Vec<u8> = states.iter().map(|&state| plain(state)).collect();
        for index in mapper.changed() {
            let interval = mapper.interval(index);
            if interval.is_finite() {
                classes[index] = scale.class(match self {
                    Self::Interval => interval,
                    _ => mapper.change_probability(index),
                });
            }
        }
        classes
    }

    /// The colour of a class.
    pub fn colour(self, class: u8) -> Rgb {
        let place = (f64::from(class.saturating_sub(FIRST)) + 0.5) / f64::from(STEPS);
        let gradient = |gradient: colorous::Gradient, place: f64| {
            let colour = gradient.eval_continuous(place.min(1.0));
            [colour.r, colour.g, colour.b]
        };
        match (self, class) {
            (_, 0..=UNKNOWN) => [211, 219, 232],
            (_, FREE) => [255, 255, 255],
            (Self::Occupancy, BLOCKED) => [32, 36, 44],
            (_, BLOCKED) => [158, 160, 165],
            (Self::Interval, _) => gradient(colorous::TURBO, 0.95 - 0.9 * place), // short is red, as in Fig. 5
            (Self::ChangeProbability, _) => gradient(colorous::YELLOW_ORANGE_RED, 0.1 + 0.9 * place),
            (Self::Recency | Self::Occupancy, _) => gradient(colorous::VIRIDIS, 1.0 - place),
        }
    }

    /// The colour at a place of the colour bar, 0 to 1.
    pub fn colour_at(self, place: f64) -> Rgb {
        self.colour(FIRST + ((place * f64::from(STEPS)) as u8).min(STEPS - 1))
    }

    /// The classes along the colour bar, from its lower end on.
    pub fn scale_classes(self) -> Vec<u8> {
        (FIRST..FIRST + STEPS).collect()
    }

    /// A mark of the colour bar with its unit.
    pub fn with_unit(self, mark: &str, unit: TimeUnit) -> String {
        match self {
            Self::Interval | Self::Recency => format!("{mark} {}", unit.symbol()),
            Self::Occupancy | Self::ChangeProbability => mark.into(),
        }
    }

    /// The classes beside the colour bar, with what they mean.
    pub fn plain_legend(self) -> Vec<(u8, String)> {
        let plain = |states: &[(u8, &str)]| {
            states.iter().map(|&(class, meaning)| (class, meaning.to_owned())).collect()
        };
        match self {
            Self::Occupancy => plain(&[(FREE, "free"), (BLOCKED, "blocked"), (UNKNOWN, "never seen")]),
            Self::Recency => plain(&[(UNKNOWN, "never seen")]),
            Self::Interval | Self::ChangeProbability => {
                plain(&[(FREE, "free, no change"), (BLOCKED, "blocked, no change"), (UNKNOWN, "never seen")])
            }
        }
    }

    /// Every class that a cell can have, with what it means.
    pub fn legend(self, unit: TimeUnit) -> Vec<(u8, String)> {
        let mut legend = self.plain_legend();
        if let Some(scale) = self.scale(unit) {
            let symbol = unit.symbol();
            legend.extend((0..STEPS).map(|step| {
                let edge = |step: u8| scale.value(f64::from(step) / f64::from(STEPS));
                let (from, to) = (edge(step), edge(step + 1));
                let text = match self {
                    Self::ChangeProbability => format!("{:.0}–{:.0} %", 100.0 * from, 100.0 * to),
                    _ if step == STEPS - 1 => format!("{from:.0} {symbol} or more"),
                    _ if to < 20.0 => format!("{from:.1}–{to:.1} {symbol}"),
                    _ => format!("{from:.0}–{to:.0} {symbol}"),
                };
                (FIRST + step, text)
            }));
        }
        legend
    }
}

fn plain(state: CellState) -> u8 {
    match state {
        CellState::Unknown => UNKNOWN,
        CellState::Free => FREE,
        CellState::Blocked => BLOCKED,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNITS: [TimeUnit; 2] = [TimeUnit::Second, TimeUnit::Step];

    fn all() -> impl Iterator<Item = (Layer, TimeUnit)> {
        Layer::ALL.into_iter().flat_map(|layer| UNITS.map(|unit| (layer, unit)))
    }

    #[test]
    fn a_scale_and_its_inverse_agree() {
        for (layer, unit) in all() {
            let Some(scale) = layer.scale(unit) else { continue };
            for step in 0..=20 {
                let place = f64::from(step) / 20.0;
                assert!((scale.place(scale.value(place)) - place).abs() < 1e-12);
            }
            assert_eq!(scale.place(f64::INFINITY), 1.0);
            assert_eq!(scale.class(f64::INFINITY), FIRST + STEPS - 1);
            assert_eq!(scale.class(-1.0), FIRST);
        }
    }

    #[test]
    fn a_cycle_of_27_s_looks_unlike_half_and_double() {
        let interval = Layer::Interval;
        let scale = interval.scale(TimeUnit::Second).unwrap();
        let colour = |seconds: f64| interval.colour(scale.class(seconds)).map(i32::from);
        let apart = |a: [i32; 3], b: [i32; 3]| (0..3).map(|i| (a[i] - b[i]).abs()).max().unwrap();
        assert!(apart(colour(27.0), colour(13.5)) > 60, "{:?} {:?}", colour(27.0), colour(13.5));
        assert!(apart(colour(27.0), colour(54.0)) > 60, "{:?} {:?}", colour(27.0), colour(54.0));
    }

    #[test]
    fn every_class_has_one_meaning() {
        let mut run = crate::fake::FakeRun::new();
        (0..600).for_each(|_| run.step());
        for (layer, unit) in all() {
            let mut classes: Vec<u8> = layer.legend(unit).iter().map(|(class, _)| *class).collect();
            classes.sort_unstable();
            assert!(classes.windows(2).all(|pair| pair[0] < pair[1]));
            assert!(layer.classes(&run.mapper, unit).iter().all(|class| classes.contains(class)));
        }
    }

    #[test]
    fn ticks_lie_on_their_scale() {
        for (layer, unit) in all() {
            for (value, _) in layer.ticks(unit) {
                let scale = layer.scale(unit).unwrap();
                assert!((scale.low..=scale.high).contains(value));
            }
        }
    }
}

//! The layers of a map for display: every cell has a class, and every class has a color and a meaning. The
//! recording and the pictures use the same layers, so that a color has the same meaning in both.

use crate::palette::{self, Rgb};
use interfaces::{CellState, Grid};
use mapper::Mapper;

/// A layer of the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Unknown, free or blocked.
    Occupancy,
    /// The cycle time T of equation 1 (mean duration of blocked → free → blocked), s.
    Interval,
    /// The probability of a change since the cell was last seen (equation 2).
    ChangeProbability,
    /// The time since the cell was last seen, s.
    Recency,
    /// The probability that the cell is blocked now, or this time ahead, s, for cells that change: the map as predicted.
    Predicted(u16),
    /// For how long a look at the cell says more than its usual hours, h.
    Expiry,
}

/// A cell that was never seen. Class 0 stays unused: the viewer draws nothing for it.
pub const UNKNOWN: u8 = 1;
/// A free cell without a value in the layer.
pub const FREE: u8 = 2;
/// A blocked cell without a value in the layer.
pub const BLOCKED: u8 = 3;
/// The class of the lowest value on the scale of a layer.
const FIRST: u8 = 4;
/// The number of classes of a scale: enough that the eye does not distinguish neighboring classes.
const STEPS: u8 = 64;

/// The scale of a layer: from values to positions on the color bar, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The value at the lower end.
    pub low: f64,
    /// The value at the upper end.
    pub high: f64,
    /// Whether the scale is logarithmic.
    pub is_log: bool,
    /// The values that are marked.
    pub ticks: &'static [f64],
}

impl Scale {
    /// The position of `value` on the color bar, limited to [0, 1].
    pub fn position(&self, value: f64) -> f64 {
        let at = |value: f64| if self.is_log { libm::log(value) } else { value };
        ((at(value) - at(self.low)) / (at(self.high) - at(self.low))).clamp(0.0, 1.0)
    }

    /// The value at a position of the color bar; the inverse of [`Scale::position`].
    fn value(&self, position: f64) -> f64 {
        if self.is_log {
            self.low * libm::pow(self.high / self.low, position)
        } else {
            self.low + (self.high - self.low) * position
        }
    }

    fn class(&self, value: f64) -> u8 {
        FIRST + ((self.position(value) * f64::from(STEPS)) as u8).min(STEPS - 1)
    }
}

impl Layer {
    /// Every layer of a run, in the order in which they are shown.
    pub const ALL: [Self; 8] = [
        Self::Occupancy,
        Self::Interval,
        Self::ChangeProbability,
        Self::Recency,
        Self::PREDICTED[0],
        Self::PREDICTED[1],
        Self::PREDICTED[2],
        Self::PREDICTED[3],
    ];
    /// The predicted maps, now and at three times ahead.
    pub const PREDICTED: [Self; 4] =
        [Self::Predicted(0), Self::Predicted(60), Self::Predicted(600), Self::Predicted(3600)];

    /// The name in entity paths and file names, and the title above the map.
    fn words(self) -> [&'static str; 2] {
        match self {
            Self::Occupancy => ["occupancy", "Occupancy"],
            Self::Interval => ["interval", "Cycle time: seconds per cycle"],
            Self::ChangeProbability => ["change_probability", "Probability of a change since last seen"],
            Self::Recency => ["recency", "Recency: seconds since last seen"],
            Self::Predicted(0) => ["predicted", "Probability of being blocked now"],
            Self::Predicted(60) => ["predicted_60", "Probability of being blocked in 1 min"],
            Self::Predicted(600) => ["predicted_600", "Probability of being blocked in 10 min"],
            Self::Predicted(_) => ["predicted_3600", "Probability of being blocked in 1 h"],
            Self::Expiry => ["expiry", "Expiry: hours for which a look counts"],
        }
    }

    /// The name in entity paths and file names.
    pub fn name(self) -> &'static str {
        self.words()[0]
    }

    /// The title above the map.
    pub fn title(self) -> &'static str {
        self.words()[1]
    }

    /// The scale of the color bar; `None` for the occupancy.
    pub fn scale(self) -> Option<Scale> {
        let (low, high, is_log, ticks): (_, _, _, &[f64]) = match self {
            Self::Occupancy => return None,
            // Typical causes are a door, a passing robot, a chair: two decades around half a minute.
            Self::Interval => (5.0, 500.0, true, &[5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0]),
            Self::ChangeProbability | Self::Predicted(_) => (0.0, 1.0, false, &[0.0, 0.25, 0.5, 0.75, 1.0]),
            Self::Expiry => (0.01, 672.0, true, &[0.01, 0.1, 1.0, 10.0, 100.0]),
            Self::Recency => (1.0, 1000.0, true, &[1.0, 10.0, 100.0, 1000.0]),
        };
        Some(Scale { low, high, is_log, ticks })
    }

    /// The class of every cell of the map.
    pub fn classes(self, mapper: &Mapper) -> Grid<u8> {
        if let Some(scale) = self.scale().filter(|_| self == Self::Recency) {
            // Every cell that was seen has a value.
            let mut classes = Grid::filled(*mapper.frame(), UNKNOWN);
            for index in mapper.seen() {
                classes.cells_mut()[index] = scale.class(mapper.recency(index));
            }
            return classes;
        }
        self.classes_of(mapper, |index| {
            let interval = mapper.interval(index);
            interval.is_finite().then(|| match self {
                Self::Interval => interval,
                Self::Predicted(ahead_s) => mapper.blocked_probability_later(index, f64::from(ahead_s)),
                Self::Expiry => f64::NAN,
                _ => mapper.change_probability(index),
            })
        })
    }

    /// The class of every cell, by the values of those that ever changed.
    pub fn classes_of(self, mapper: &Mapper, value: impl Fn(usize) -> Option<f64>) -> Grid<u8> {
        let mut classes = mapper.states().map(|state| plain(*state));
        let Some(scale) = self.scale() else { return classes };
        for index in mapper.changed() {
            if let Some(value) = value(index) {
                classes.cells_mut()[index] = scale.class(value);
            }
        }
        classes
    }

    /// The color of a class. The scales have a lightness that only rises or only falls, so that
    /// color-blind readers and gray prints show the same order.
    pub fn color(self, class: u8) -> Rgb {
        let position = (f64::from(class.saturating_sub(FIRST)) + 0.5) / f64::from(STEPS);
        let gradient = |gradient: colorous::Gradient, position: f64| {
            let color = gradient.eval_continuous(position.clamp(0.0, 1.0));
            [color.r, color.g, color.b]
        };
        match (self, class) {
            (_, 0..=UNKNOWN) => palette::UNKNOWN,
            (_, FREE) => palette::FREE,
            (Self::Occupancy, BLOCKED) => palette::BLOCKED,
            (_, BLOCKED) => palette::BLOCKED_FAINT,
            // Short cycle times are dark, and long ones light, but dark enough to be seen on white.
            (Self::Interval, _) => gradient(colorous::INFERNO, 0.12 + 0.78 * position),
            // Without the lightest part, which is similar to a free cell, and without grays, as those of a wall.
            (Self::ChangeProbability, _) => gradient(colorous::YELLOW_ORANGE_RED, 0.25 + 0.75 * position),
            (Self::Predicted(_), _) => gradient(colorous::RED_PURPLE, 0.3 + 0.7 * position),
            (Self::Recency | Self::Occupancy | Self::Expiry, _) => {
                gradient(colorous::VIRIDIS, 1.0 - position)
            }
        }
    }

    /// The classes along the color bar, from its lower end on.
    pub fn scale_classes(self) -> Vec<u8> {
        (FIRST..FIRST + STEPS).collect()
    }

    /// The classes beside the color bar, with their meanings.
    pub fn plain_legend(self) -> Vec<(u8, &'static str)> {
        match self {
            Self::Occupancy => vec![(FREE, "free"), (BLOCKED, "blocked"), (UNKNOWN, "never seen")],
            Self::Recency => vec![(UNKNOWN, "never seen")],
            Self::Interval | Self::ChangeProbability | Self::Predicted(_) | Self::Expiry => {
                vec![(FREE, "free, no change"), (BLOCKED, "blocked, no change"), (UNKNOWN, "never seen")]
            }
        }
    }

    /// What a reader must know about the unit of the scale; `None` if the title says it all.
    pub fn note(self) -> Option<&'static str> {
        (self == Self::Interval).then_some("one cycle: blocked, then free, then blocked again")
    }

    /// Every class that a cell can have, with its meaning.
    pub fn legend(self) -> Vec<(u8, String)> {
        let plain = self.plain_legend().into_iter();
        let mut legend: Vec<(u8, String)> = plain.map(|(class, text)| (class, text.into())).collect();
        if let Some(scale) = self.scale() {
            legend.extend((0..STEPS).map(|step| {
                let edge = |step: u8| scale.value(f64::from(step) / f64::from(STEPS));
                let (from, to) = (edge(step), edge(step + 1));
                let text = match self {
                    Self::ChangeProbability | Self::Predicted(_) => {
                        format!("{:.0}–{:.0} %", 100.0 * from, 100.0 * to)
                    }
                    _ if step == STEPS - 1 => format!("{from:.0} s or more"),
                    _ if to < 20.0 => format!("{from:.1}–{to:.1} s"),
                    _ => format!("{from:.0}–{to:.0} s"),
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

    #[test]
    fn a_scale_and_its_inverse_agree() {
        for scale in Layer::ALL.into_iter().filter_map(Layer::scale) {
            assert!(scale.ticks.iter().all(|tick| (scale.low..=scale.high).contains(tick)));
            for step in 0..=20 {
                let position = f64::from(step) / 20.0;
                assert!((scale.position(scale.value(position)) - position).abs() < 1e-12);
            }
            assert_eq!(scale.position(f64::INFINITY), 1.0);
            assert_eq!(scale.class(f64::INFINITY), FIRST + STEPS - 1);
            assert_eq!(scale.class(-1.0), FIRST);
        }
    }

    /// Lightness of a color, 0 to 100 (CIE L*).
    fn lightness([red, green, blue]: Rgb) -> f64 {
        let linear = |part: u8| {
            let part = f64::from(part) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        };
        let luminance = 0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue);
        if luminance > 0.008856 { 116.0 * luminance.cbrt() - 16.0 } else { 903.3 * luminance }
    }

    #[test]
    fn a_cycle_of_27_s_looks_unlike_half_and_double_also_without_hues() {
        let interval = Layer::Interval;
        let scale = interval.scale().unwrap();
        let shade = |seconds: f64| lightness(interval.color(scale.class(seconds)));
        assert!(shade(27.0) - shade(13.5) > 9.0, "{} {}", shade(27.0), shade(13.5));
        assert!(shade(54.0) - shade(27.0) > 9.0, "{} {}", shade(54.0), shade(27.0));
    }

    #[test]
    fn lightness_gives_the_order_of_every_scale() {
        for layer in &Layer::ALL[1..] {
            let shades: Vec<f64> =
                layer.scale_classes().iter().map(|&class| lightness(layer.color(class))).collect();
            let rises = shades.windows(2).filter(|pair| pair[0] < pair[1]).count();
            assert!(rises == 0 || rises == shades.len() - 1, "{layer:?}: {shades:?}");
        }
    }

    #[test]
    fn no_value_looks_like_a_cell_without_a_value() {
        for layer in &Layer::ALL[1..] {
            for (plain, meaning) in layer.plain_legend() {
                for class in layer.scale_classes() {
                    let [a, b] = [plain, class].map(|class| layer.color(class));
                    let distance =
                        a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(b)).powi(2)).sum::<f64>().sqrt();
                    assert!(distance > 70.0, "{layer:?}: class {class} is {b:?}, {meaning} is {a:?}");
                }
            }
        }
        let lowest = |layer: Layer| lightness(layer.color(FIRST));
        assert!(lowest(Layer::ChangeProbability) < 90.0, "{}", lowest(Layer::ChangeProbability));
    }

    #[test]
    fn every_class_has_one_meaning() {
        let mut run = crate::fake_run::FakeRun::new();
        (0..600).for_each(|_| run.step());
        for layer in Layer::ALL {
            let mut classes: Vec<u8> = layer.legend().iter().map(|(class, _)| *class).collect();
            classes.sort_unstable();
            assert!(classes.windows(2).all(|pair| pair[0] < pair[1]));
            assert!(layer.classes(&run.mapper).cells().iter().all(|class| classes.contains(class)));
        }
    }
}

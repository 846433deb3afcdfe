//! The values of keys: their number, their units, their range.

use super::lexer::Kind;
use super::pictures::Pictures;
use super::place::Place;
use super::sources::Sources;
use super::tree::{Property, Thing};
use interfaces::pose;
use nalgebra::Isometry2;
use std::ops::RangeInclusive;
use std::rc::Rc;

/// No length, speed or angle may be larger.
const MOST: f64 = 1e5;

/// A place above the floor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub(super) flat: Isometry2<f64>,
    pub(super) z_m: f64,
}

impl Pose {
    pub(super) fn origin() -> Self {
        Self { flat: Isometry2::identity(), z_m: 0.0 }
    }

    /// The place that is `other` as seen from this one.
    pub(super) fn then(&self, other: &Self) -> Self {
        Self { flat: self.flat * other.flat, z_m: self.z_m + other.z_m }
    }
}

/// Asks things for the values of their keys, in the units of the file. Whatever is wrong becomes
/// an error, and the key counts as left out.
pub(super) struct Reader<'a, 'b> {
    pub(super) sources: &'a mut Sources<'b>,
    /// Metres per unit of length.
    pub(super) length_m: f64,
    /// Radians per unit of angle.
    pub(super) angle_rad: f64,
    /// Stage's own step, ms.
    pub(super) interval_sim_ms: u32,
    pub(super) pictures: Pictures<'a>,
}

impl Reader<'_, '_> {
    /// The key, if the thing has it. From now on it counts as used.
    pub(super) fn property(&self, thing: &Thing, name: &str) -> Option<Rc<Property>> {
        let property = thing.properties.get(name)?;
        property.is_used.set(true);
        Some(Rc::clone(property))
    }

    /// The numbers of a key, `least` to `most` of them.
    pub(super) fn numbers(
        &mut self,
        thing: &Thing,
        name: &str,
        counts: RangeInclusive<usize>,
    ) -> Option<(Vec<f64>, Place)> {
        let property = self.property(thing, name)?;
        let place = property.place();
        let number = |value: &super::lexer::Token| match value.kind {
            Kind::Number(number) if number.abs() <= MOST => Some(number),
            _ => None,
        };
        let numbers: Option<Vec<f64>> = property.values.iter().map(number).collect();
        match numbers {
            Some(numbers) if counts.contains(&numbers.len()) => Some((numbers, place)),
            _ => {
                let (least, most) = (counts.start(), counts.end());
                let count = if least == most { least.to_string() } else { format!("{least} to {most}") };
                let what = format!("`{name}` has the wrong values");
                self.sources.error(
                    place,
                    &what,
                    "",
                    &format!("it takes {count} numbers of at most {MOST} each"),
                );
                None
            }
        }
    }

    /// The number of a key, in `range`.
    pub(super) fn number(&mut self, thing: &Thing, name: &str, range: RangeInclusive<f64>) -> Option<f64> {
        let (numbers, place) = self.numbers(thing, name, 1..=1)?;
        if range.contains(&numbers[0]) {
            return Some(numbers[0]);
        }
        let what = format!("`{name}` is {}, which is out of range", numbers[0]);
        let help = format!("it must be a number from {} to {}", range.start(), range.end());
        self.sources.error(place, &what, "", &help);
        None
    }

    /// Whether a key is not 0.
    pub(super) fn flag(&mut self, thing: &Thing, name: &str) -> Option<bool> {
        self.number(thing, name, -MOST..=MOST).map(|number| number != 0.0)
    }

    /// The text of a key.
    pub(super) fn text(&mut self, thing: &Thing, name: &str) -> Option<(String, Place)> {
        let property = self.property(thing, name)?;
        match property.values.as_slice() {
            [value] if value.kind == Kind::Text => {
                Some((self.sources.text(value.place).to_owned(), value.place))
            }
            _ => {
                let what = format!("`{name}` has the wrong values");
                self.sources.error(property.place(), &what, "", "it takes one text in quotes");
                None
            }
        }
    }

    /// `[x y z heading]` in m and rad.
    pub(super) fn pose(&mut self, thing: &Thing, name: &str) -> Option<Pose> {
        let (mut numbers, place) = self.numbers(thing, name, 2..=4)?;
        if numbers.len() < 4 {
            let count = numbers.len();
            let what = format!("`{name}` has {count} numbers");
            if numbers.get(2).is_some_and(|third| *third != 0.0) {
                // Old files mean the heading by it, newer ones the height.
                let help = "it takes 4: x, y, z, and the heading, which is the fourth";
                self.sources.error(place, &what, "", help);
                return None;
            }
            let help = "it takes 4: x, y, z and heading; Stage 4.3 refuses this, here the others are 0";
            self.sources.warning(place, &what, "", help);
            numbers.resize(4, 0.0);
        }
        let (m, rad) = (self.length_m, self.angle_rad);
        Some(Pose { flat: pose(numbers[0] * m, numbers[1] * m, numbers[3] * rad), z_m: numbers[2] * m })
    }

    /// `[x y z]` in m, all positive but for z; what is left out of z is `default_z_m`.
    pub(super) fn size(&mut self, thing: &Thing, default_m: [f64; 3]) -> [f64; 3] {
        let Some((numbers, place)) = self.numbers(thing, "size", 2..=3) else {
            return default_m;
        };
        let mut size_m = default_m;
        for (size, number) in size_m.iter_mut().zip(&numbers) {
            *size = number * self.length_m;
        }
        if size_m[..2].iter().any(|side| *side < 1e-4) || size_m[2] < 0.0 {
            self.sources.error(
                place,
                "`size` is not positive",
                "",
                "it takes x, y and z, each above 0.0001 m",
            );
            return default_m;
        }
        size_m
    }
}

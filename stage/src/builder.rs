//! Reads the values of keys: their number, their units, their range.

use super::lexer::{Kind, Span, Token};
use super::pictures::Pictures;
use super::sources::Sources;
use super::tree::Entity;
use super::{StageRobot, StageWall};
use interfaces::{is_printable, pose};
use nalgebra::{Isometry2, Point2, Vector2};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

/// The maximum absolute value of lengths, speeds and angles.
const MAX_NUMBER: f64 = 1e5;

/// Makes walls and robots from entities, and reads their keys in the units of the file. If a value is invalid, an
/// error is added and the key counts as missing.
pub(super) struct Builder<'a, 'b> {
    pub(super) sources: &'a mut Sources<'b>,
    /// Meters per unit of length.
    pub(super) length_m: f64,
    /// Radians per unit of angle.
    pub(super) angle_rad: f64,
    /// Stage's own step, ms.
    pub(super) interval_sim_ms: u32,
    pub(super) pictures: Pictures,
    pub(super) names: BTreeSet<String>,
    /// The number of names that were generated, by what they begin with.
    pub(super) generated: BTreeMap<String, usize>,
    pub(super) walls: Vec<StageWall>,
    /// The walls that have a tag, with their position and the place of the tag in the file.
    pub(super) tagged: Vec<(usize, Point2<f64>, Span)>,
    pub(super) robots: Vec<StageRobot>,
}

impl Builder<'_, '_> {
    /// The numbers of a key.
    pub(super) fn numbers(
        &mut self,
        entity: &Entity,
        name: &str,
        counts: RangeInclusive<usize>,
    ) -> Option<(Vec<f64>, Span)> {
        let property = entity.get(name)?;
        let number = |value: &Token| match value.kind {
            Kind::Number(number) if number.abs() <= MAX_NUMBER => Some(number),
            _ => None,
        };
        let numbers: Option<Vec<f64>> = property.values.iter().map(number).collect();
        if let Some(numbers) = numbers.filter(|numbers| counts.contains(&numbers.len())) {
            return Some((numbers, property.place()));
        }
        let (least, most) = (counts.start(), counts.end());
        let count = if least == most { least.to_string() } else { format!("{least} to {most}") };
        let help = format!("it takes {count} numbers of at most {MAX_NUMBER} each");
        self.sources.error(property.place(), format!("`{name}` has the wrong values"), help);
        None
    }

    /// The numbers of a key that are lengths, m.
    pub(super) fn lengths_m(&mut self, entity: &Entity, name: &str, count: usize) -> Option<Vec<f64>> {
        let (numbers, _) = self.numbers(entity, name, count..=count)?;
        Some(numbers.iter().map(|number| number * self.length_m).collect())
    }

    /// The number of a key, in `range`.
    pub(super) fn number(&mut self, entity: &Entity, name: &str, range: RangeInclusive<f64>) -> Option<f64> {
        let (numbers, place) = self.numbers(entity, name, 1..=1)?;
        if range.contains(&numbers[0]) {
            return Some(numbers[0]);
        }
        let what = format!("`{name}` is {}, which is out of range", numbers[0]);
        let help = format!("it must be a number from {} to {}", range.start(), range.end());
        self.sources.error(place, what, help);
        None
    }

    /// The number of a key that is a length of 0 or more, m.
    pub(super) fn length_m(&mut self, entity: &Entity, name: &str) -> Option<f64> {
        self.number(entity, name, 0.0..=MAX_NUMBER).map(|length| length * self.length_m)
    }

    /// Whether a key is not 0.
    pub(super) fn flag(&mut self, entity: &Entity, name: &str) -> Option<bool> {
        self.number(entity, name, -MAX_NUMBER..=MAX_NUMBER).map(|number| number != 0.0)
    }

    /// The text of a key.
    pub(super) fn text(&mut self, entity: &Entity, name: &str) -> Option<(String, Span)> {
        let property = entity.get(name)?;
        if let [Token { kind: Kind::Text, place }] = property.values.as_slice() {
            let text = self.sources.text(*place);
            if text.chars().all(is_printable) {
                return Some((text.to_owned(), *place));
            }
            let what = format!("`{name}` has a character that is not printable");
            self.sources.error(*place, what, "it takes one line of printable text");
            return None;
        }
        let what = format!("`{name}` has the wrong values");
        self.sources.error(property.place(), what, "it takes one text in quotes");
        None
    }

    /// The meaning of a key that is one of some texts. `what`: what the text names.
    pub(super) fn choice<T: Copy>(
        &mut self,
        entity: &Entity,
        (name, what, help): (&str, &str, &str),
        choices: &[(&str, T)],
    ) -> Option<T> {
        let (text, place) = self.text(entity, name)?;
        let chosen = choices.iter().find(|(choice, _)| *choice == text);
        if chosen.is_none() {
            self.sources.error(place, format!("there is no {what} `{text}`"), help);
        }
        chosen.map(|(_, meaning)| *meaning)
    }

    /// `[x y z heading]` in m and rad, without z; the identity where it is not given.
    pub(super) fn pose(&mut self, entity: &Entity, name: &str) -> Isometry2<f64> {
        let Some((mut numbers, place)) = self.numbers(entity, name, 2..=4) else {
            return Isometry2::identity();
        };
        let count = numbers.len();
        if count < 4 {
            let what = format!("`{name}` has {count} numbers");
            if numbers.get(2).is_some_and(|third| *third != 0.0) {
                // Old files mean the heading by it, newer ones the height.
                let help = "it takes 4: x, y, z, and the heading, which is the fourth";
                self.sources.error(place, what, help);
                return Isometry2::identity();
            }
            let help = "it takes 4: x, y, z and heading; Stage 4.3 refuses this, here the others are 0";
            self.sources.warning(place, what, help);
            numbers.resize(4, 0.0);
        }
        if numbers[2] != 0.0 {
            self.sources.has_no_effect(place, "pose z");
        }
        let (m, rad) = (self.length_m, self.angle_rad);
        pose(numbers[0] * m, numbers[1] * m, numbers[3] * rad)
    }

    /// `[x y z]` in m, without z, which may be left out.
    pub(super) fn size_m(&mut self, entity: &Entity, default_m: f64) -> Vector2<f64> {
        let Some((numbers, place)) = self.numbers(entity, "size", 2..=3) else {
            return Vector2::repeat(default_m);
        };
        let size_m = Vector2::new(numbers[0], numbers[1]) * self.length_m;
        if size_m.min() < 1e-4 {
            let help = "it takes x, y and z, each above 0.0001 m";
            self.sources.error(place, "`size` is not positive", help);
            return Vector2::repeat(default_m);
        }
        size_m
    }
}

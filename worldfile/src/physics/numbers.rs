//! Single values: in range or not.

use super::file::{Number, Pair};
use crate::error::{Source, WorldError};
use crate::together::Together;
use nalgebra::Point2;
use serde_spanned::Spanned;
use std::fmt;
use std::ops::RangeInclusive;

/// A number as one would write it: 1e300 has no 300 digits.
struct Figure(f64);

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plain = self.0 == 0.0 || !self.0.is_finite() || (1e-5..1e7).contains(&self.0.abs());
        if plain { write!(f, "{}", self.0) } else { write!(f, "{:e}", self.0) }
    }
}

/// From where to where a map of `size` (m) reaches; infinite: its size is wrong.
pub(super) fn extent(size: &Point2<f64>) -> String {
    match size.x.is_finite() {
        true => format!("[0, 0] to [{}, {}]", size.x, size.y),
        false => "[0, 0] to its `size_m`".to_owned(),
    }
}

/// A table of the file, named as in `robot.laser`.
pub(super) struct Table<'a> {
    pub(super) source: &'a Source<'a>,
    pub(super) path: &'static str,
}

impl Table<'_> {
    /// The value, if it is in `range`; NaN never is.
    pub(super) fn number(
        &self,
        key: &str,
        value: &Number,
        range: RangeInclusive<f64>,
    ) -> Result<f64, WorldError> {
        let number = *value.get_ref();
        if range.contains(&number) {
            return Ok(number);
        }
        let what = format!("`{}.{key}` is {}, which is out of range", self.path, Figure(number));
        let help = format!("it must be a number from {} to {}", Figure(*range.start()), Figure(*range.end()));
        Err(self.source.error(&what, (value.span(), "out of range"), &[], &help))
    }

    /// The same where the key may be left out.
    pub(super) fn number_or(
        &self,
        key: &str,
        value: &Option<Number>,
        default: f64,
        range: RangeInclusive<f64>,
    ) -> Result<f64, WorldError> {
        value.as_ref().map_or(Ok(default), |value| self.number(key, value, range))
    }

    /// The same for a key that has no default.
    pub(super) fn number_if(
        &self,
        key: &str,
        value: &Option<Number>,
        range: RangeInclusive<f64>,
    ) -> Result<Option<f64>, WorldError> {
        value.as_ref().map(|value| self.number(key, value, range)).transpose()
    }

    /// A count, if it is in `range`.
    pub(super) fn count(
        &self,
        key: &str,
        value: &Spanned<u32>,
        range: RangeInclusive<u32>,
    ) -> Result<usize, WorldError> {
        let count = *value.get_ref();
        if range.contains(&count) {
            return Ok(count as usize);
        }
        let what = format!("`{}.{key}` is {count}, which is out of range", self.path);
        let help = format!("it must be a whole number from {} to {}", range.start(), range.end());
        Err(self.source.error(&what, (value.span(), "out of range"), &[], &help))
    }

    /// Two values, if both are in `range`.
    pub(super) fn pair(
        &self,
        key: &str,
        value: &Pair,
        range: RangeInclusive<f64>,
    ) -> Result<Point2<f64>, WorldError> {
        let [x, y] = *value.get_ref();
        if range.contains(&x) && range.contains(&y) {
            return Ok(Point2::new(x, y));
        }
        let what = format!("`{}.{key}` is [{}, {}], which is out of range", self.path, Figure(x), Figure(y));
        let help = format!("both must be numbers from {} to {}", range.start(), range.end());
        Err(self.source.error(&what, (value.span(), "out of range"), &[], &help))
    }

    /// One of some words; the first if it is left out.
    pub(super) fn choice<T: Copy>(
        &self,
        key: &str,
        value: &Option<Spanned<String>>,
        choices: &[(&str, T)],
    ) -> Result<T, WorldError> {
        let Some(value) = value else { return Ok(choices[0].1) };
        let found = choices.iter().find(|(word, _)| word == value.get_ref());
        found.map(|(_, choice)| *choice).ok_or_else(|| {
            let what = format!("`{}.{key}` is `{}`", self.path, value.get_ref());
            let words: Vec<String> = choices.iter().map(|(word, _)| format!("\"{word}\"")).collect();
            let help = format!("it must be {}", words.join(" or "));
            self.source.error(&what, (value.span(), "not known"), &[], &help)
        })
    }

    /// A point (m) in the map of `size` (m).
    pub(super) fn point(
        &self,
        key: &str,
        value: &Pair,
        size: &Point2<f64>,
    ) -> Result<Point2<f64>, WorldError> {
        let [x, y] = *value.get_ref();
        if (0.0..=size.x).contains(&x) && (0.0..=size.y).contains(&y) {
            return Ok(Point2::new(x, y));
        }
        let what =
            format!("`{}.{key}` is [{}, {}], which is outside of the map", self.path, Figure(x), Figure(y));
        let help = format!("the map reaches from {}", extent(size));
        Err(self.source.error(&what, (value.span(), "outside of the map"), &[], &help))
    }

    /// A list of points (m) in the map of `size` (m).
    pub(super) fn points(
        &self,
        key: &str,
        list: &[Pair],
        size: &Point2<f64>,
    ) -> Result<Vec<Point2<f64>>, WorldError> {
        list.iter().map(|point| self.point(key, point, size)).collect::<Vec<_>>().together()
    }

    /// A list of numbers, if all are in `range`.
    pub(super) fn numbers(
        &self,
        key: &str,
        list: &[Number],
        range: RangeInclusive<f64>,
    ) -> Result<Vec<f64>, WorldError> {
        list.iter().map(|number| self.number(key, number, range.clone())).collect::<Vec<_>>().together()
    }
}

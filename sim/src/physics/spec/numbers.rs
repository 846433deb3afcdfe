//! Single values: in range or not.

use super::file::{Number, Pair};
use crate::error::{Source, WorldError};
use nalgebra::Point2;
use std::ops::RangeInclusive;

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
        let what = format!("`{}.{key}` is {number}, which is out of range", self.path);
        let help = format!("it must be a number from {} to {}", range.start(), range.end());
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
        let what = format!("`{}.{key}` is [{x}, {y}], which is out of range", self.path);
        let help = format!("both must be numbers from {} to {}", range.start(), range.end());
        Err(self.source.error(&what, (value.span(), "out of range"), &[], &help))
    }

    /// A point (m) in the map of `size` (m).
    pub(super) fn point(&self, key: &str, value: &Pair, size: &Point2<f64>) -> Result<Point2<f64>, WorldError> {
        let [x, y] = *value.get_ref();
        if (0.0..=size.x).contains(&x) && (0.0..=size.y).contains(&y) {
            return Ok(Point2::new(x, y));
        }
        let what = format!("`{}.{key}` is [{x}, {y}], which is outside of the map", self.path);
        let help = format!("the map reaches from [0, 0] to [{}, {}]", size.x, size.y);
        Err(self.source.error(&what, (value.span(), "outside of the map"), &[], &help))
    }

    /// A name, if it is not empty.
    pub(super) fn name(&self, value: &serde_spanned::Spanned<String>) -> Result<String, WorldError> {
        if !value.get_ref().trim().is_empty() {
            return Ok(value.get_ref().clone());
        }
        let what = match self.path {
            "" => "`name` is empty".to_owned(),
            path => format!("`{path}.name` is empty"),
        };
        Err(self.source.error(&what, (value.span(), "empty"), &[], "give it a name, as in `name = \"curious\"`"))
    }
}

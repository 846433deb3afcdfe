//! The values of world files as TOML, for code that writes world files.

use interfaces::heading_rad;
use nalgebra::{Isometry2, Point2};
use toml::Value;

/// A number to a billionth: without the rounding errors of sums and of units, and without −0.
pub fn short(value: f64) -> f64 {
    let rounded = (value * 1e9).round() / 1e9;
    if rounded == 0.0 { 0.0 } else { rounded }
}

/// A [`short`] number.
pub fn number(value: f64) -> Value {
    short(value).into()
}

/// An angle in degrees, from rad.
pub fn degrees(angle_rad: f64) -> Value {
    number(angle_rad.to_degrees())
}

/// The heading of a pose in degrees.
pub fn heading(pose: &Isometry2<f64>) -> Value {
    degrees(heading_rad(pose))
}

/// A point as a list of two numbers.
pub fn point(point: &Point2<f64>) -> Value {
    vec![number(point.x), number(point.y)].into()
}

/// Keys with their values, one a line.
pub fn lines<'a>(keys: impl IntoIterator<Item = (&'a str, Value)>) -> String {
    keys.into_iter().map(|(key, value)| format!("{key} = {value}\n")).collect()
}

//! Values of a file: their types and ranges.

use super::Table;
use nalgebra::Point2;
use std::fmt;
use std::ops::{Range, RangeInclusive};
use toml::Spanned;
use toml::de::{DeFloat, DeInteger, DeValue};

/// The maximum number of points of a path.
const MAX_POINTS: usize = 1000;

/// A number as one would write it: 1e300 has no 300 digits.
pub(crate) struct Figure(pub(crate) f64);

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let plain = self.0 == 0.0 || !self.0.is_finite() || (1e-5..1e7).contains(&self.0.abs());
        if plain { write!(f, "{}", self.0) } else { write!(f, "{:e}", self.0) }
    }
}

/// The number, unless it is NaN, as invalid ones are.
pub(crate) fn valid(number: f64) -> Option<f64> {
    (!number.is_nan()).then_some(number)
}

/// From where to where a map of `size` (m) reaches; infinite: its size is invalid.
pub(crate) fn extent(size: &Point2<f64>) -> String {
    match size.x.is_finite() {
        true => format!("[0, 0] to [{}, {}]", size.x, size.y),
        false => "[0, 0] to its `size_m`".to_owned(),
    }
}

/// The value of a key, or an item of its list.
#[derive(Clone, Copy)]
pub(crate) struct Value<'t, 'a> {
    pub(super) table: &'t Table<'a>,
    pub(super) key: &'static str,
    pub(super) found: &'a Spanned<DeValue<'a>>,
}

impl<'t, 'a> Value<'t, 'a> {
    /// The place of the value in the file.
    pub(crate) fn span(&self) -> Range<usize> {
        self.found.span()
    }

    fn mistyped<T>(&self, expected: &str) -> Option<T> {
        let what = format!("`{}` has the wrong type", self.table.path(self.key));
        let label = format!("this is {}", description(self.found.get_ref(), expected));
        self.error(&what, &label, &format!("it must be {expected}"))
    }

    /// Records an error about the value, for example `robot.laser.beams` **is 0, which is out of range**.
    pub(crate) fn invalid<T>(&self, is: &str, label: &str, help: &str) -> Option<T> {
        self.error(&format!("`{}` {is}", self.table.path(self.key)), label, help)
    }

    pub(crate) fn error<T>(&self, what: &str, label: &str, help: &str) -> Option<T> {
        self.table.file.error(what, (self.span(), label), &[], help)
    }

    /// `None`: not a number, or one that is too large.
    pub(crate) fn number(&self) -> Option<f64> {
        let number = match self.found.get_ref() {
            DeValue::Integer(number) => integer(number).map(|number| number as f64),
            DeValue::Float(number) => float(number),
            _ => None,
        };
        number.or_else(|| self.mistyped("a number"))
    }

    /// A number in `range`; NaN never is.
    pub(crate) fn within(&self, range: &RangeInclusive<f64>) -> Option<f64> {
        let number = self.number()?;
        if range.contains(&number) {
            return Some(number);
        }
        let help = format!("it must be a number from {} to {}", Figure(*range.start()), Figure(*range.end()));
        self.invalid(&format!("is {}, which is out of range", Figure(number)), "out of range", &help)
    }

    pub(crate) fn integer(&self) -> Option<i64> {
        let number = self.found.get_ref().as_integer().and_then(integer);
        number.or_else(|| self.mistyped("a whole number"))
    }

    /// A whole number in `range`.
    pub(crate) fn integer_within(&self, range: &RangeInclusive<u32>) -> Option<u32> {
        let number = self.integer()?;
        let found = u32::try_from(number).ok().filter(|number| range.contains(number));
        found.or_else(|| {
            let help = format!("it must be a whole number from {} to {}", range.start(), range.end());
            self.invalid(&format!("is {number}, which is out of range"), "out of range", &help)
        })
    }

    pub(crate) fn flag(&self) -> Option<bool> {
        self.found.get_ref().as_bool().or_else(|| self.mistyped("`true` or `false`"))
    }

    pub(crate) fn text(&self) -> Option<&'a str> {
        self.found.get_ref().as_str().or_else(|| self.mistyped("a text in quotes"))
    }

    /// One of several words.
    pub(crate) fn choice<T: Copy>(&self, choices: &[(&str, T)]) -> Option<T> {
        let text = self.text()?;
        let found = choices.iter().find(|(word, _)| *word == text).map(|(_, choice)| *choice);
        found.or_else(|| {
            let words: Vec<String> = choices.iter().map(|(word, _)| format!("\"{word}\"")).collect();
            let help = format!("it must be {}", words.join(" or "));
            self.invalid(&format!("is `{text}`"), "not known", &help)
        })
    }

    /// Two numbers.
    pub(crate) fn pair(&self) -> Option<[f64; 2]> {
        match self.found.get_ref().as_array().map(|list| &list[..]) {
            Some([x, y]) => {
                let [x, y] = [x, y].map(|found| Self { found, ..*self }.number());
                Some([x?, y?])
            }
            _ => self.mistyped("two numbers, as in `[1.0, 2.0]`"),
        }
    }

    /// Two numbers in `range`.
    pub(crate) fn pair_within(&self, range: &RangeInclusive<f64>) -> Option<Point2<f64>> {
        let [x, y] = self.pair()?;
        if range.contains(&x) && range.contains(&y) {
            return Some(Point2::new(x, y));
        }
        let is = format!("is [{}, {}], which is out of range", Figure(x), Figure(y));
        let help = format!("both must be numbers from {} to {}", range.start(), range.end());
        self.invalid(&is, "out of range", &help)
    }

    /// A point (m) in the map of `size` (m).
    pub(crate) fn point(&self, size: &Point2<f64>) -> Option<Point2<f64>> {
        let [x, y] = self.pair()?;
        if (0.0..=size.x).contains(&x) && (0.0..=size.y).contains(&y) {
            return Some(Point2::new(x, y));
        }
        let is = format!("is [{}, {}], which is outside of the map", Figure(x), Figure(y));
        self.invalid(&is, "outside of the map", &format!("the map reaches from {}", extent(size)))
    }

    /// Whether the value is a list.
    /// 1 to 1000 points in a map of a size.
    pub(crate) fn points(&self, size: &Point2<f64>) -> Option<Vec<Point2<f64>>> {
        let count = self.items()?.len();
        if !(1..=MAX_POINTS).contains(&count) {
            let help = format!("it must have 1 to {MAX_POINTS}, as in `[[1.0, 2.0], [3.0, 2.0]]`");
            return self.invalid(&format!("has {count} points"), "these points", &help);
        }
        self.list(|point| point.point(size))
    }

    pub(crate) fn is_list(&self) -> bool {
        matches!(self.found.get_ref(), DeValue::Array(_))
    }

    /// The items of a list.
    pub(crate) fn items(&self) -> Option<Vec<Self>> {
        if let DeValue::Array(list) = self.found.get_ref() {
            return Some(list.iter().map(|found| Self { found, ..*self }).collect());
        }
        self.mistyped(&match self.key {
            "hours" | "busy" => "a list of texts, as in `[\"Mon-Fri 8:00-18:00\"]`".to_owned(),
            "path" => "a list of cells, as in `[[1, 2], [5, 2]]`".to_owned(),
            key if key.ends_with("_m") => "a list of points, as in `[[1.0, 2.0], [3.0, 2.0]]`".to_owned(),
            key if key.ends_with("_s") => "a list of numbers, as in `[1.0, 2.0]`".to_owned(),
            key => format!("a list of tables, as in `[[{}]]`", self.table.path(key)),
        })
    }

    /// The items of a list, each as `read` reads it; all of them are read.
    pub(crate) fn list<T>(&self, read: impl FnMut(&Self) -> Option<T>) -> Option<Vec<T>> {
        let items: Vec<Option<T>> = self.items()?.iter().map(read).collect();
        items.into_iter().collect()
    }

    pub(crate) fn table(&self, keys: &'static str) -> Option<Table<'a>> {
        let DeValue::Table(entries) = self.found.get_ref() else { return self.mistyped("a table of keys") };
        Some(Table::open(self.table.file, self.table.path(self.key), keys, Some(entries), self.span()))
    }

    /// A table, or a list of tables.
    pub(crate) fn table_or_tables(&self, keys: &'static str) -> Option<Vec<Table<'a>>> {
        match self.found.get_ref() {
            DeValue::Array(_) => self.list(|item| item.table(keys)),
            DeValue::Table(_) => Some(vec![self.table(keys)?]),
            _ => self.mistyped("a table of keys, or a list of them"),
        }
    }
}

/// Keys with one value. If a number or a flag is invalid, the table is not [`Table::sound`], and the answer is NaN, 0
/// or `false`.
impl Table<'_> {
    pub(crate) fn number(&self, key: &'static str, range: RangeInclusive<f64>) -> f64 {
        self.or_invalid(self.needed(key).and_then(|value| value.within(&range)), f64::NAN)
    }

    /// The number, or `default` if the key is not given.
    pub(crate) fn number_or(&self, key: &'static str, default: f64, range: RangeInclusive<f64>) -> f64 {
        self.number_if(key, range).unwrap_or(default)
    }

    /// The number, `None` if the key is not given.
    pub(crate) fn number_if(&self, key: &'static str, range: RangeInclusive<f64>) -> Option<f64> {
        self.get(key).map(|value| self.or_invalid(value.within(&range), f64::NAN))
    }

    pub(crate) fn count(&self, key: &'static str, range: RangeInclusive<u32>) -> usize {
        let count = self.needed(key).and_then(|value| value.integer_within(&range));
        self.or_invalid(count, 0) as usize
    }

    pub(crate) fn flag(&self, key: &'static str) -> bool {
        self.get(key).is_some_and(|value| self.or_invalid(value.flag(), false))
    }

    /// The value; without one, the table is not sound, and the answer is `instead`.
    pub(crate) fn or_invalid<T>(&self, value: Option<T>, instead: T) -> T {
        self.is_valid.set(self.is_valid.get() && value.is_some());
        value.unwrap_or(instead)
    }

    /// The first choice if the key is not given.
    pub(crate) fn choice<T: Copy>(&self, key: &'static str, choices: &[(&str, T)]) -> Option<T> {
        self.get(key).map_or(Some(choices[0].1), |value| value.choice(choices))
    }

    pub(crate) fn description(&self) -> Option<String> {
        self.get("description").map_or(Some(""), |value| value.text()).map(str::to_owned)
    }
}

fn integer(number: &DeInteger<'_>) -> Option<i64> {
    i64::from_str_radix(number.as_str(), number.radix()).ok()
}

/// The number, unless it is too large.
fn float(number: &DeFloat<'_>) -> Option<f64> {
    let value: f64 = number.as_str().parse().ok()?;
    (value.is_finite() || !number.as_str().contains(|c: char| c.is_ascii_digit())).then_some(value)
}

/// A value in everyday words.
fn description(value: &DeValue<'_>, expected: &str) -> String {
    let is_number = expected.starts_with("a number") || expected.starts_with("a whole number");
    match value {
        DeValue::String(text) => format!("the text {text:?}"),
        DeValue::Integer(number) if is_number && !number.as_str().starts_with('-') => {
            format!("the number `{number}`, which is too large")
        }
        DeValue::Integer(number) => format!("the number `{number}`"),
        DeValue::Float(number) if expected == "a number" => {
            format!("the number `{number}`, which is too large")
        }
        DeValue::Float(number) => format!("the number `{number}`"),
        DeValue::Boolean(truth) => format!("`{truth}`"),
        DeValue::Datetime(_) => "a date or a time".to_owned(),
        DeValue::Array(list) if expected.starts_with("two") => format!("a list of {}", list.len()),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a single table".to_owned(),
    }
}

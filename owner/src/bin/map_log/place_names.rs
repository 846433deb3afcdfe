//! The file of `--places`: names for places and doors.
//!
//! ```toml
//! [[place]]
//! name = "Kitchen door"
//! x_m = 3.2
//! y_m = -1.0
//! radius_m = 1.5   # 1 without it
//! ```

use anyhow::{Context, Result, anyhow, bail};
use interfaces::printable;
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::path::Path;
use survey::PlaceName;

/// The largest distance of a place from its point, if the file gives none, m.
const RADIUS_M: f64 = 1.0;
const MAX_LETTERS: usize = 60;
/// The longest file, bytes.
const MAX_BYTES: u64 = 1 << 20;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    place: Vec<Entry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    #[serde(deserialize_with = "name")]
    name: String,
    #[serde(deserialize_with = "coordinate")]
    x_m: f64,
    #[serde(deserialize_with = "coordinate")]
    y_m: f64,
    #[serde(deserialize_with = "radius", default = "default_radius")]
    radius_m: f64,
}

fn name<'a, D: Deserializer<'a>>(from: D) -> Result<String, D::Error> {
    let name = String::deserialize(from)?.trim().to_owned();
    let letters = name.chars().count();
    let why =
        || D::Error::custom(format!("a name has 1 to {MAX_LETTERS} letters, and this one has {letters}"));
    (1..=MAX_LETTERS).contains(&letters).then(|| printable(&name).into_owned()).ok_or_else(why)
}

fn coordinate<'a, D: Deserializer<'a>>(from: D) -> Result<f64, D::Error> {
    number(from, -1e6..=1e6)
}

fn radius<'a, D: Deserializer<'a>>(from: D) -> Result<f64, D::Error> {
    number(from, 0.05..=100.0)
}

fn default_radius() -> f64 {
    RADIUS_M
}

fn number<'a, D: Deserializer<'a>>(from: D, range: RangeInclusive<f64>) -> Result<f64, D::Error> {
    let (found, [low, high]) = (f64::deserialize(from)?, [range.start(), range.end()]);
    let why = || D::Error::custom(format!("must be a number from {low} to {high} m, and not {found}"));
    range.contains(&found).then_some(found).ok_or_else(why)
}

/// The names in a file.
pub(crate) fn read(path: &Path) -> Result<Vec<PlaceName>> {
    let text = files::read_text(path, MAX_BYTES)
        .with_context(|| format!("--places {}: cannot read it", path.display()))?;
    names(&text).with_context(|| path.display().to_string())
}

fn names(text: &str) -> Result<Vec<PlaceName>> {
    let File { place: entries } = toml::from_str(text).map_err(|error| {
        anyhow!(error.to_string().trim_end().replace("expected f64", "expected a number"))
    })?;
    let mut names = BTreeSet::new();
    if let Some(Entry { name, .. }) = entries.iter().find(|entry| !names.insert(&entry.name)) {
        bail!("two places have the `name` {name:?}: give each its own");
    }
    let place = |Entry { name, x_m, y_m, radius_m }: Entry| PlaceName { name, x_m, y_m, radius_m };
    Ok(entries.into_iter().map(place).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_a_point_and_a_radius() {
        let text = "[[place]]\nname = \" Kitchen \"\nx_m = 3\ny_m = -1.5\n\n[[place]]\nname = \"Door\"\nx_m = 0\ny_m = 0\nradius_m = 2\n";
        let found = names(text).unwrap();
        assert_eq!(found[0], PlaceName { name: "Kitchen".to_owned(), x_m: 3.0, y_m: -1.5, radius_m: 1.0 });
        assert_eq!((&found[1].name[..], found[1].radius_m, found.len()), ("Door", 2.0, 2));
    }

    #[test]
    fn errors_show_the_line_and_say_what_is_right() {
        let error = |lines: &str| names(&format!("[[place]]\n{lines}")).unwrap_err().to_string();
        insta::assert_snapshot!(error("name = \"a\"\nx = 1\ny_m = 2\n"), @"
        TOML parse error at line 3, column 1
          |
        3 | x = 1
          | ^
        unknown field `x`, expected one of `name`, `x_m`, `y_m`, `radius_m`
        ");
        insta::assert_snapshot!(error("name = \"a\"\nx_m = \"1\"\ny_m = 2\n"), @r#"
        TOML parse error at line 3, column 7
          |
        3 | x_m = "1"
          |       ^^^
        invalid type: string "1", expected a number
        "#);
        insta::assert_snapshot!(error("name = \"a\"\nx_m = 1\n"), @"
        TOML parse error at line 1, column 1
          |
        1 | [[place]]
          | ^^^^^^^^^
        missing field `y_m`
        ");
        insta::assert_snapshot!(error("name = \"a\nx_m = 1\n"), @r#"
        TOML parse error at line 2, column 10
          |
        2 | name = "a
          |          ^
        invalid basic string, expected `"`
        "#);
        insta::assert_snapshot!(error("name = \" \"\nx_m = 1\ny_m = 2\n"), @r#"
        TOML parse error at line 2, column 8
          |
        2 | name = " "
          |        ^^^
        a name has 1 to 60 letters, and this one has 0
        "#);
        insta::assert_snapshot!(error("name = \"a\"\nx_m = inf\ny_m = 2\n"), @"
        TOML parse error at line 3, column 7
          |
        3 | x_m = inf
          |       ^^^
        must be a number from -1000000 to 1000000 m, and not inf
        ");
        insta::assert_snapshot!(error("name = \"a\"\nx_m = 1\ny_m = 2\nradius_m = 0\n"), @"
        TOML parse error at line 5, column 12
          |
        5 | radius_m = 0
          |            ^
        must be a number from 0.05 to 100 m, and not 0
        ");
        insta::assert_snapshot!(error("name = \"a\"\nx_m = 1\ny_m = 2\n[[place]]\nname = \" a\"\nx_m = 1\ny_m = 2\n"), @r#"two places have the `name` "a": give each its own"#);
        assert!(names("").unwrap_err().to_string().ends_with("missing field `place`"));
    }
}

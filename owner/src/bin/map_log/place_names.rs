//! The file of `--places`: names for places and doors.
//!
//! ```toml
//! [[place]]
//! name = "Kitchen door"
//! x_m = 3.2
//! y_m = -1.0
//! radius_m = 1.5   # 1 without it
//! ```

use anyhow::{Context, Result, anyhow, bail, ensure};
use interfaces::printable;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::Path;
use survey::PlaceName;
use toml::Spanned;

/// The largest distance of a place from its point, if the file gives none, m.
const RADIUS_M: f64 = 1.0;
const RADII_M: RangeInclusive<f64> = 0.05..=100.0;
const COORDINATES_M: RangeInclusive<f64> = -1e6..=1e6;
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
    name: Spanned<String>,
    x_m: Spanned<f64>,
    y_m: Spanned<f64>,
    radius_m: Option<Spanned<f64>>,
}

/// The names in a file.
pub(crate) fn read(path: &Path) -> Result<Vec<PlaceName>> {
    let text = files::read_text(path, MAX_BYTES)
        .with_context(|| format!("--places {}: cannot read it", path.display()))?;
    names(&path.display().to_string(), &text)
}

fn names(file: &str, text: &str) -> Result<Vec<PlaceName>> {
    let line_of =
        |at: usize| 1 + text.as_bytes()[..at.min(text.len())].iter().filter(|byte| **byte == b'\n').count();
    let File { place: entries } = toml::from_str(text).map_err(|error| {
        let line = line_of(error.span().map_or(0, |span| span.start));
        anyhow!(
            "{file}, line {line}{}: {}",
            key(text, line),
            error.message().replace('\n', ", ").replace("expected f64", "expected a number")
        )
    })?;
    let mut lines = BTreeMap::new();
    for Entry { name, .. } in &entries {
        let line = line_of(name.span().start);
        let letters = name.get_ref().trim().chars().count();
        ensure!(
            (1..=MAX_LETTERS).contains(&letters),
            "{file}, line {line}, `name`: a name has 1 to {MAX_LETTERS} letters, and this one has {letters}"
        );
        if let Some(other) = lines.insert(name.get_ref().trim(), line) {
            bail!(
                "{file}, line {line}, `name`: the place in line {other} has the same name; give each its own"
            );
        }
    }
    let number = |key: &str, value: &Spanned<f64>, range: RangeInclusive<f64>| {
        let (line, found) = (line_of(value.span().start), *value.get_ref());
        ensure!(
            range.contains(&found),
            "{file}, line {line}, `{key}`: must be a number from {} to {} m, and not {found}",
            range.start(),
            range.end()
        );
        Ok(found)
    };
    let name = |entry: &Entry| {
        Ok(PlaceName {
            name: printable(entry.name.get_ref().trim()).into_owned(),
            x_m: number("x_m", &entry.x_m, COORDINATES_M)?,
            y_m: number("y_m", &entry.y_m, COORDINATES_M)?,
            radius_m: match &entry.radius_m {
                Some(radius_m) => number("radius_m", radius_m, RADII_M)?,
                None => RADIUS_M,
            },
        })
    };
    entries.iter().map(name).collect()
}

/// The key in a line, for an error.
fn key(text: &str, line: usize) -> String {
    let key = text.lines().nth(line - 1).and_then(|line| line.split_once('=')).map(|(key, _)| key.trim());
    key.map(|key| format!(", `{key}`")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_a_point_and_a_radius() {
        let text = "[[place]]\nname = \" Kitchen \"\nx_m = 3\ny_m = -1.5\n\n[[place]]\nname = \"Door\"\nx_m = 0\ny_m = 0\nradius_m = 2\n";
        let found = names("places.toml", text).unwrap();
        assert_eq!(found[0], PlaceName { name: "Kitchen".to_owned(), x_m: 3.0, y_m: -1.5, radius_m: 1.0 });
        assert_eq!((&found[1].name[..], found[1].radius_m, found.len()), ("Door", 2.0, 2));
    }

    #[test]
    fn errors_name_file_line_and_key() {
        let error =
            |lines: &str| names("places.toml", &format!("[[place]]\n{lines}")).unwrap_err().to_string();
        insta::assert_snapshot!(error("name = \"a\"\nx = 1\ny_m = 2\n"), @"places.toml, line 3, `x`: unknown field `x`, expected one of `name`, `x_m`, `y_m`, `radius_m`");
        insta::assert_snapshot!(error("name = \"a\"\nx_m = \"1\"\ny_m = 2\n"), @r#"places.toml, line 3, `x_m`: invalid type: string "1", expected a number"#);
        insta::assert_snapshot!(error("name = \"a\"\nx_m = 1\n"), @"places.toml, line 1: missing field `y_m`");
        insta::assert_snapshot!(error("name = \"a\nx_m = 1\n"), @r#"places.toml, line 2, `name`: invalid basic string, expected `"`"#);
        insta::assert_snapshot!(error("name = \" \"\nx_m = 1\ny_m = 2\n"), @"places.toml, line 2, `name`: a name has 1 to 60 letters, and this one has 0");
        insta::assert_snapshot!(error("name = \"a\"\nx_m = inf\ny_m = 2\n"), @"places.toml, line 3, `x_m`: must be a number from -1000000 to 1000000 m, and not inf");
        insta::assert_snapshot!(error("name = \"a\"\nx_m = 1\ny_m = 2\nradius_m = 0\n"), @"places.toml, line 5, `radius_m`: must be a number from 0.05 to 100 m, and not 0");
        insta::assert_snapshot!(error("name = \"a\"\nx_m = 1\ny_m = 2\n[[place]]\nname = \"a\"\nx_m = 1\ny_m = 2\n"), @"places.toml, line 6, `name`: the place in line 2 has the same name; give each its own");
        insta::assert_snapshot!(names("places.toml", "").unwrap_err().to_string(), @"places.toml, line 1: missing field `place`");
    }
}

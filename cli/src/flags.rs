//! Parsers of the values of flags: an invalid value is refused before anything is read or written, and its flag is named.

use anyhow::bail;
use clap::builder::{PathBufValueParser, TypedValueParser};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// An invalid value of a flag, which is named unless the message points at a place in a file.
pub fn value_of(flag: &'static str, error: impl Into<anyhow::Error>) -> anyhow::Error {
    let error = error.into();
    if format!("{error:#}").contains("--> ") { error } else { error.context(flag) }
}

/// A parser of a number in a range.
pub fn number(range: RangeInclusive<f64>) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync {
    move |text| {
        let number = text.parse::<f64>().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| format!("must be a number from {} to {}", range.start(), range.end()))
    }
}

/// The IANA name of a time zone.
///
/// # Errors
///
/// When there is no such zone; the error has the name that was perhaps meant.
pub fn time_zone(name: &str) -> Result<String, String> {
    if let Ok(zone) = jiff::tz::db().get(name) {
        return Ok(zone.iana_name().unwrap_or(name).to_owned());
    }
    let lower = name.to_lowercase();
    let likeness = |zone: &str| strsim::jaro_winkler(&lower, &zone.to_lowercase());
    let nearest =
        jiff::tz::db().available().max_by(|a, b| likeness(a.as_str()).total_cmp(&likeness(b.as_str())));
    let nearest = nearest.map(|zone| format!(", perhaps {zone}")).unwrap_or_default();
    Err(format!("no time zone is called so{nearest}; names are those of the IANA, as Europe/Berlin or UTC"))
}

/// A parser of the path of a file that is read: it must be a regular one.
pub fn input_file() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| match files::open(&path) {
        Ok(_) => Ok(path),
        Err(why) => Err(format!("cannot read this file: {why}")),
    })
}

/// A parser of the path of a file that is written.
pub fn output_file() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| match path.is_dir() {
        true => Err("it is a folder, not a file"),
        false => Ok(path),
    })
}

/// Checks that flags name different files: of one file for two purposes, one would be lost.
///
/// # Errors
///
/// When two are the same.
pub fn check_distinct(files: &[(&str, Option<&Path>)]) -> anyhow::Result<()> {
    let place = |path: &Path| {
        let path = std::path::absolute(path).ok()?;
        Some((path.parent()?.canonicalize().ok()?, path.file_name()?.to_owned()))
    };
    let mut known = BTreeMap::new();
    for (flag, path) in files.iter().filter_map(|(flag, path)| Some((flag, (*path)?))) {
        if let Some(other) = place(path).and_then(|place| known.insert(place, flag)) {
            bail!("{other} and {flag} name the same file {}: give each its own", path.display());
        }
    }
    Ok(())
}

/// A parser of the path of a folder, which may be missing.
pub fn folder() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| {
        let file =
            path.ancestors().find(|path| path.symlink_metadata().is_ok()).filter(|found| !found.is_dir());
        file.map_or(Ok(()), |file| Err(format!("{} is a file, not a folder", file.display())))
            .map(|()| path.clone())
    })
}

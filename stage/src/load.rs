//! From a Stage world to one that runs here.

use super::StageWorld;
use super::check::check;
use super::sources::Sources;
use nalgebra::Point2;
use sim::physics::FleetSpec;
use std::path::Path;
use worldfile::Severity;
use worldfile::physics::parse_fleet;
use worldfile::toml_value::short;

/// Makes a fleet of a Stage world. An error names the line of the Stage file.
pub(super) fn load(sources: &mut Sources<'_>, path: &Path, world: &StageWorld) -> Option<FleetSpec> {
    check(sources, world);
    if sources.findings.errors() > 0 {
        return None;
    }
    let low = world.map_origin();
    if low != Point2::origin() {
        let (x, y) = (short(low.x), short(low.y));
        let what = format!("[0, 0] of the world that runs is [{x}, {y}] of this file");
        let help = "it is the lower left corner of all that is there; headings are as in the file";
        sources.add_file(Severity::Note, what, help);
    }
    let name = format!("{}, made from {}", path.with_extension("toml").display(), path.display());
    let text = world.to_toml();
    let error = match parse_fleet(&name, &text) {
        Ok(spec) => return Some(spec),
        Err(error) => error,
    };
    for message in &error.messages() {
        let (what, help, place) = in_stage(&text, message);
        sources.findings.add_file(Severity::Error, place.map_or(path, Path::new), what, help);
    }
    None
}

/// The first line of a message about the made file, its help, and the place in the Stage file that
/// its table names: the user has not seen the made file.
fn in_stage<'a>(made: &'a str, message: &'a str) -> (&'a str, &'a str, Option<&'a str>) {
    let what = message.lines().next().unwrap_or_default();
    let help = message.rsplit_once("= help: ").map_or("", |(_, help)| help);
    // As in `--> made.toml:12:3`.
    let arrow = message.lines().find(|line| line.trim_start().starts_with("--> "));
    let line: usize = arrow.and_then(|arrow| arrow.rsplit(':').nth(1)?.parse().ok()).unwrap_or(0);
    let tables = made.lines().take(line).filter(|line| line.starts_with('['));
    let place = tables.last().and_then(|table| table.split_once("  # ")).map(|(_, place)| place);
    (what, help, place)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_of_the_made_file_names_the_line_that_it_comes_from() {
        let made = "name = \"x\"\n\n[[robot]]  # a.world:3\nname = \"a\"\nradius_m = 99.0\n";
        let message = parse_fleet("made.toml", made).unwrap_err();
        let messages = message.messages();
        let places: Vec<_> = messages.iter().map(|message| in_stage(made, message).2).collect();
        assert!(places.contains(&Some("a.world:3")), "{message}");
        assert_eq!(in_stage(made, "odd"), ("odd", "", None));
    }
}

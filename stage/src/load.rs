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
    let name = format!("{}, made from {}", path.with_extension("toml").display(), path.display());
    let made = world.made();
    let spec = parse_fleet(&name, &made.text).map_err(|error| {
        // The user has not seen the made file: its errors are reported where its tables and keys come from.
        for finding in error.findings().iter() {
            match made.origin(finding.line) {
                Some(at) => sources.error(at, &finding.what, &finding.help),
                None => sources.add_file(Severity::Error, &finding.what, &finding.help),
            }
        }
    });
    let low = world.map_origin();
    if spec.is_ok() && low != Point2::origin() {
        let (x, y) = (short(low.x), short(low.y));
        let what = format!("[0, 0] of the world that runs is [{x}, {y}] of this file");
        let help = "it is the lower left corner of all that is there; headings are as in the file";
        sources.add_file(Severity::Note, what, help);
    }
    spec.ok()
}

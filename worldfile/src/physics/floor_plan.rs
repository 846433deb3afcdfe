//! Walls from a picture.

use super::file::FloorPlanFile;
use super::numbers::Table;
use super::space::inside;
use crate::error::{Source, WorldError, Wrong};
use crate::files::Files;
use crate::findings::{Findings, Severity};
use crate::floor_plan::{Bitmap, FloorPlan, MAX_FILE_BYTES};
use crate::ros_map;
use crate::together::Together;
use interfaces::{heading_rad, pose};
use nalgebra::{Point2, Vector2};
use serde_spanned::Spanned;
use sim::physics::Rectangle;
use std::path::Path;

/// More pieces of wall than this are refused: looking for what hides what takes their square.
pub const MAX_PIECES: usize = 20_000;

/// The walls of a floor plan: solid rectangles, which overlap.
pub(super) fn walls(
    source: &Source<'_>,
    files: &dyn Files,
    file: &Spanned<FloorPlanFile>,
    size: &Point2<f64>,
) -> Result<Vec<Rectangle>, WorldError> {
    let table = Table { source, path: "floor_plan" };
    let corner = match &file.get_ref().corner_m {
        Some(corner) => table.point("corner_m", corner, size),
        None => Ok(Point2::origin()),
    };
    let (plan, named) = match file.get_ref() {
        FloorPlanFile { image: Some(image), map: None, pixel_m: Some(pixel), .. } => {
            let pixel_m = table.number("pixel_m", pixel, 0.001..=10.0);
            let heading_deg =
                table.number_or("heading_deg", &file.get_ref().heading_deg, 0.0, -360.0..=360.0);
            let below = table.number_or("blocked_below", &file.get_ref().blocked_below, 0.5, 0.0..=1.0);
            let bytes = files.read(&beside(source, image), MAX_FILE_BYTES).map_err(|error| error.to_string());
            // A threshold that is wrong has its own message.
            let below_or = *below.as_ref().unwrap_or(&0.5);
            let bitmap = bytes
                .and_then(|bytes| Bitmap::decode_dark(&bytes, below_or).map_err(|error| error.to_string()));
            let bitmap = bitmap.map_err(|error| {
                let what = format!("cannot read the picture `{}`: {error}", image.get_ref());
                let help = "`image` names a PNG or PGM picture, in the folder of this file";
                source.error(&what, (image.span(), "this picture"), &[], help)
            });
            let (corner, pixel_m, heading_deg, bitmap, _) =
                (corner, pixel_m, heading_deg, bitmap, below).together()?;
            let origin = pose(corner.x, corner.y, heading_deg.to_radians());
            (FloorPlan { bitmap: bitmap.into(), pixel_m: Vector2::repeat(pixel_m), origin }, image)
        }
        FloorPlanFile {
            image: None,
            map: Some(map),
            pixel_m: None,
            heading_deg: None,
            blocked_below: None,
            ..
        } => {
            let (corner, plan) = (corner, read_map(source, files, map)).together()?;
            let origin = pose(corner.x, corner.y, heading_rad(&plan.origin));
            (FloorPlan { origin, ..plan }, map)
        }
        _ => {
            let help = "give either `image` and `pixel_m`, and `heading_deg` and `blocked_below` if need be, or \
                        the `map` of ROS, which has these itself";
            return Err(source.error(
                "a floor plan needs one picture",
                (file.span(), "this floor plan"),
                &[],
                help,
            ));
        }
    };
    let walls: Vec<Rectangle> = plan.rectangles().collect();
    if walls.len() > MAX_PIECES {
        let what = format!("this floor plan makes {} pieces of wall", walls.len());
        let help =
            format!("{MAX_PIECES} are the most: take a coarser picture, or one with fewer rough edges");
        return Err(source.error(&what, (named.span(), "too ragged"), &[], &help));
    }
    for wall in &walls {
        inside(source, "a floor plan reaches out of the map", named.span(), wall, size)?;
    }
    Ok(walls)
}

/// The map of ROS that the world file names. Everything that is wrong with it is told. A world file has
/// no warnings: what is one for a map alone, a key that may be misspelt and change the walls, is an error here.
fn read_map(source: &Source<'_>, files: &dyn Files, map: &Spanned<String>) -> Result<FloorPlan, WorldError> {
    let mut findings = Findings::default();
    let plan = ros_map::read_floor_plan(&beside(source, map), files, &mut findings);
    let mut wrong = Wrong::default();
    for finding in findings.iter().filter(|finding| finding.severity >= Severity::Warning) {
        let line = if finding.line == 0 { String::new() } else { format!("line {}: ", finding.line) };
        let what = format!("cannot use the map `{}`: {line}{}", map.get_ref(), finding.what);
        wrong.keep::<()>(Err(source.error(&what, (map.span(), "this map"), &[], &finding.help)));
    }
    plan.filter(|_| wrong.is_empty()).ok_or_else(|| wrong.into_part())
}

/// The path of a file that the world file names.
fn beside(source: &Source<'_>, name: &Spanned<String>) -> std::path::PathBuf {
    Path::new(source.name).parent().unwrap_or(Path::new("")).join(name.get_ref())
}

//! Walls from a picture.

use super::space::inside;
use crate::files::Files;
use crate::findings::{Findings, Severity};
use crate::floor_plan::{Bitmap, FloorPlan, MAX_FILE_BYTES, MAX_PIXELS};
use crate::reader::Table;
use crate::ros_map;
use interfaces::{heading_rad, pose};
use nalgebra::{Point2, Vector2};
use sim::physics::Rectangle;

/// More pieces of wall than this in one file are refused: the search for hidden surfaces takes their square.
pub const MAX_PIECES: usize = 20_000;
/// The maximum number of pixels of all floor plans of a file together.
const MAX_ALL_PIXELS: u64 = 2 * MAX_PIXELS;

pub(super) const KEYS: &str = "image, map, pixel_m, corner_m, heading_deg, blocked_below";

/// Reads the floor plans of a file, as far as they are not too large together.
pub(super) struct FloorPlans<'a> {
    files: &'a dyn Files,
    /// The pixels and the pieces of wall of the plans read so far.
    pixels: u64,
    pieces: usize,
}

impl<'a> FloorPlans<'a> {
    pub(super) fn new(files: &'a dyn Files) -> Self {
        Self { files, pixels: 0, pieces: 0 }
    }

    /// The walls of a floor plan: solid rectangles, which overlap.
    pub(super) fn walls(&mut self, table: &Table<'_>, size: &Point2<f64>) -> Option<Vec<Rectangle>> {
        let corner = table.get("corner_m").map_or(Some(Point2::origin()), |corner| corner.point(size));
        let key = if table.has("map") { "map" } else { "image" };
        if key == "map" {
            table.has_none_of(&["image", "pixel_m", "heading_deg", "blocked_below"], "map", "floor_plan")?;
        }
        if self.pixels > MAX_ALL_PIXELS || self.pieces > MAX_PIECES {
            return None;
        }
        let plan =
            if key == "map" { map(table, self.files, corner) } else { picture(table, self.files, corner) };
        let plan = plan?;
        self.pixels += u64::from(plan.bitmap.width()) * u64::from(plan.bitmap.height());
        if self.pixels > MAX_ALL_PIXELS {
            let what = format!("the floor plans have {} pixels together", self.pixels);
            let help = format!("{MAX_ALL_PIXELS} are the most in one file: take coarser pictures");
            return table.error(&what, (table.at(key), "with this one"), &[], &help);
        }
        let walls: Vec<Rectangle> = plan.rectangles().collect();
        self.pieces += walls.len();
        if self.pieces > MAX_PIECES {
            let what = format!("the floor plans make {} pieces of wall together", self.pieces);
            let help =
                format!("{MAX_PIECES} are the most: take a coarser picture, or one with fewer rough edges");
            return table.error(&what, (table.at(key), "too ragged"), &[], &help);
        }
        for wall in &walls {
            inside(table.file, "a floor plan reaches out of the map", table.at(key), wall, size)?;
        }
        table.sound(walls)
    }
}

/// The plan that an `image` shows.
fn picture(table: &Table<'_>, files: &dyn Files, corner: Option<Point2<f64>>) -> Option<FloorPlan> {
    let pixel_m = table.number("pixel_m", 0.001..=10.0);
    let heading_deg = table.number_or("heading_deg", 0.0, -360.0..=360.0);
    let below = table.number_or("blocked_below", 0.5, 0.0..=1.0);
    let image = table.needed("image")?.text()?;
    let bytes = files.read(&table.file.beside(image), MAX_FILE_BYTES).map_err(|error| error.to_string());
    let bitmap = bytes.and_then(|bytes| Bitmap::decode_dark(&bytes, below));
    let bitmap = bitmap.map_err(|error| {
        let what = format!("cannot read the picture `{image}`: {error}");
        let help = "`image` names a PNG or PGM picture, in the folder of this file";
        table.error::<()>(&what, (table.at("image"), "this picture"), &[], help)
    });
    let origin = pose(corner?.x, corner?.y, heading_deg.to_radians());
    table.sound(FloorPlan { bitmap: bitmap.ok()?.into(), pixel_m: Vector2::repeat(pixel_m), origin })
}

/// The plan of a ROS `map`. Everything that is invalid in it is noted. A world file has no warnings: what is a
/// warning for a map alone, a key that may be misspelled and change the walls, is an error here.
fn map(table: &Table<'_>, files: &dyn Files, corner: Option<Point2<f64>>) -> Option<FloorPlan> {
    let name = table.needed("map")?.text()?;
    let mut findings = Findings::default();
    let plan = ros_map::read_floor_plan(&table.file.beside(name), files, &mut findings);
    let mut is_valid = true;
    for finding in findings.iter().filter(|finding| finding.severity >= Severity::Warning) {
        let line = if finding.line == 0 { String::new() } else { format!("line {}: ", finding.line) };
        let what = format!("cannot use the map `{name}`: {line}{}", finding.what);
        table.file.error::<()>(&what, (table.at("map"), "this map"), &[], &finding.help);
        is_valid = false;
    }
    let (plan, corner) = (plan.filter(|_| is_valid)?, corner?);
    Some(FloorPlan { origin: pose(corner.x, corner.y, heading_rad(&plan.origin)), ..plan })
}

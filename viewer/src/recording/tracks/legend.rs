//! The legend below the map of the occupancy: the meaning of lines and areas.

use super::{Tracks, WORLD, color, labels, position};
use draw::legend::{self, Mark};
use draw::palette;
use draw::scene::extent;
use nalgebra::Vector2;
use rerun::{LineStrips2D, Radius, RecordingStreamResult};

/// The height of the strip below the map that holds the legend, as a share of the height of the map.
pub(in crate::recording) const SHARE: f64 = 0.16;
/// The number of entries side by side.
const COLUMNS: usize = 6;

/// Logs the legend, an entry for everything that can be seen in this run.
pub(super) fn add(tracks: &Tracks) -> RecordingStreamResult<()> {
    let scene = tracks.scene;
    let mut entries = legend::of_run(scene, tracks.view);
    entries.extend(legend::entries([
        (true, Mark::Line(palette::WALL), "walls"),
        (scene.has_obstacle(true), Mark::Line(palette::FURNITURE), "furniture"),
    ]));
    let (origin, size) = extent(&scene.frame);
    let at = |index: usize, right: f64, down: f64| {
        let column = (index % COLUMNS) as f64 + 0.5 + right;
        let row = 0.2 + (index / COLUMNS) as f64 * 0.45 + down;
        let share = Vector2::new(column / COLUMNS as f64, -SHARE * row);
        position(&(origin + size.component_mul(&share)))
    };
    let lines = (0..entries.len()).map(|index| [at(index, -0.2, 0.0), at(index, 0.2, 0.0)]);
    // Colors and half the widths, in points of the viewer.
    let marks: Vec<_> = entries
        .iter()
        .map(|(mark, _)| match *mark {
            Mark::Line(color) => (color, 1.5),
            Mark::Area(color) | Mark::Cross(color) | Mark::Dot(color) => (color, 5.0),
        })
        .collect();
    // A dark rim shows white areas on a light ground.
    for (part, rim) in [("rims", 0.75), ("lines", 0.0)] {
        let colors = marks.iter().map(|mark| if rim > 0.0 { palette::BLOCKED_FAINT } else { mark.0 });
        let lines = LineStrips2D::new(lines.clone())
            .with_colors(colors.map(|own| color(own, 255)))
            .with_radii(marks.iter().map(|mark| Radius::new_ui_points(mark.1 + rim)))
            .with_draw_order(1.0 - rim);
        tracks.always(&format!("{WORLD}/legend/{part}"), &lines)?;
    }
    let texts = labels(entries.iter().map(|(_, text)| text.as_str()));
    let texts = texts.with_positions((0..entries.len()).map(|index| at(index, 0.0, 0.08)));
    tracks.always(&format!("{WORLD}/legend/texts"), &texts)
}

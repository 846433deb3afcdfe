//! The legend below the map of the occupancy: what the lines and the areas mean.

use super::{LABEL, Start, color};
use crate::recording::path;
use evaluation::palette::{self, Rgb};
use rerun::{LineStrips2D, Points2D, Radius, RecordingStreamResult};

/// The height of the strip below the map that holds the legend, as a share of the height of the map.
pub(in crate::recording) const SHARE: f64 = 0.16;
/// The number of entries side by side.
const COLUMNS: usize = 6;
/// Half the width of the drawn entries, in points of the viewer.
const LINE: f32 = 1.5;
const AREA: f32 = 5.0;

/// Logs the legend, an entry for everything that can be seen in this run.
pub(super) fn log(start: Start) -> RecordingStreamResult<()> {
    let Start { stream, scene, view, .. } = start;
    let has_others = scene.robots.iter().any(|robot| !robot.is_driven);
    let has_fixed = scene.obstacles.iter().any(|obstacle| obstacle.is_fixed());
    let has_moving = scene.obstacles.iter().any(|obstacle| !obstacle.is_fixed());
    let entries = [
        (true, palette::CURIOUS, LINE, "curious robot"),
        (has_others, palette::OTHER_ROBOT, LINE, "other robots"),
        (!view.strategies.is_empty() || view.goal.is_some(), palette::PATH, LINE, "planned path"),
        (!view.strategies.is_empty() || view.goal.is_some(), palette::GOAL, AREA, "goal"),
        (view.sight().is_some(), palette::SENSOR, AREA, "field of view"),
        (true, palette::WALL, LINE, "walls"),
        (has_fixed, palette::FURNITURE, LINE, "furniture"),
        (has_moving, palette::MOVING, LINE, "what moves"),
        (true, palette::FREE, AREA, "free"),
        (true, palette::BLOCKED, AREA, "blocked"),
        (true, palette::UNKNOWN, AREA, "never seen"),
    ];
    let entries: Vec<(Rgb, f32, &str)> = entries
        .into_iter()
        .filter(|entry| entry.0)
        .map(|(_, own, radius, text)| (own, radius, text))
        .collect();

    let frame = view.mapper.frame();
    let [width_m, height_m] =
        [frame.width(), frame.height()].map(|cells| cells as f64 * frame.resolution_m());
    let column_m = width_m / COLUMNS as f64;
    let at = |index: usize| {
        let x = frame.origin().x + (0.5 + (index % COLUMNS) as f64) * column_m;
        let y = frame.origin().y - (0.2 + (index / COLUMNS) as f64 * 0.45) * SHARE * height_m;
        [x as f32, y as f32]
    };
    let half = 0.2 * column_m as f32;
    let line = |index: usize| {
        let [x, y] = at(index);
        [[x - half, y], [x + half, y]]
    };
    // A dark rim shows white areas on a light ground.
    for (part, rim) in [("rims", 0.75), ("lines", 0.0)] {
        let colors = entries.iter().map(|entry| if rim > 0.0 { palette::BLOCKED_FAINT } else { entry.0 });
        let lines = LineStrips2D::new((0..entries.len()).map(line))
            .with_colors(colors.map(|own| color(own, 255)))
            .with_radii(entries.iter().map(|entry| Radius::new_ui_points(entry.1 + rim)))
            .with_draw_order(1.0 - rim);
        stream.log_static(format!("{}/{part}", path::LEGEND), &lines)?;
    }
    let below = |index: usize| [at(index)[0], at(index)[1] - (0.08 * SHARE * height_m) as f32];
    let texts = Points2D::new((0..entries.len()).map(below))
        .with_labels(entries.iter().map(|entry| entry.2))
        .with_show_labels(true)
        .with_radii([Radius::new_ui_points(0.0)])
        .with_colors([color(LABEL, 255)]);
    stream.log_static(format!("{}/texts", path::LEGEND), &texts)
}

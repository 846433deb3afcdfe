//! The field of view of the laser of the curious robot.

use super::coarse::Coarse;
use super::maps::{Picture, images};
use super::{Tracks, WORLD, class, color, every, line, order, position, strips};
use draw::outline::field_of_view;
use draw::palette;
use draw::view::View;
use interfaces::{Cell, GridFrame};
use nalgebra::Point2;
use rerun::{AnnotationContext, RecordingStreamResult};

/// The class of the cells in the field of view.
const IN_VIEW: u8 = 1;

/// Adds what the robot sees; nothing if no robot sees in the first view.
pub(super) fn add(tracks: &mut Tracks) -> RecordingStreamResult<()> {
    if tracks.view.sight().is_none() {
        return Ok(());
    }
    let path = format!("{WORLD}/field_of_view");
    let (cells, outline) = (format!("{path}/cells"), format!("{path}/outline"));
    let frame = frame(&tracks.scene.frame);
    let when = every(&frame, 0.2);
    let classes = [("out of view", 0), ("in view", 255)];
    let classes =
        (0..).zip(classes).map(|(id, (label, alpha))| class(id, label, color(palette::SENSOR, alpha)));
    tracks.always(&cells, &AnnotationContext::new(classes))?;
    Picture::of_frame(&frame).log(tracks, &cells, order::FIELD_OF_VIEW, 0.25)?;
    tracks.always(&outline, &line(color(palette::SENSOR, 220), 0.75, order::SIGHT_OUTLINE))?;
    let strip = |corners: Vec<Point2<f64>>| corners.iter().map(position).collect();
    tracks.add(outline, when, move |view| corners(view).map(strip).collect(), strips);
    let cells_of = move |corners: Vec<Point2<f64>>| fill(&corners, &frame, IN_VIEW);
    tracks.add(cells, when, move |view| corners(view).map(cells_of).collect(), images);
    Ok(())
}

/// The cells that fill the field of view, with twice the side of the map's cells, because there are five images per second.
fn frame(map: &GridFrame) -> GridFrame {
    let map = Coarse::new(map).frame;
    let (width, height) = (map.width().div_ceil(2), map.height().div_ceil(2));
    GridFrame::new(map.origin(), 2.0 * map.resolution_m(), width, height).unwrap_or(map)
}

/// The corners of the field of view, m; none where no robot sees.
fn corners(view: &View) -> impl Iterator<Item = Vec<Point2<f64>>> {
    view.sight().map(field_of_view).into_iter()
}

/// Fills a closed outline: `class` for every cell of `frame` whose center is inside, 0 for the others.
fn fill(outline: &[Point2<f64>], frame: &GridFrame, class: u8) -> Vec<u8> {
    let mut cells = vec![0; frame.len()];
    let mut crossings = Vec::new();
    for (row, cells) in cells.chunks_mut(frame.width()).enumerate() {
        let y_m = frame.center(Cell::new(0, row as i32)).y;
        crossings.clear();
        for side in outline.windows(2) {
            let (a, b) = (side[0], side[1]);
            if (a.y <= y_m) != (b.y <= y_m) {
                let x_m = a.x + (y_m - a.y) / (b.y - a.y) * (b.x - a.x);
                crossings.push((x_m - frame.origin().x) / frame.resolution_m() - 0.5);
            }
        }
        crossings.sort_by(f64::total_cmp);
        for inside in crossings.chunks_exact(2) {
            let column = |at: f64| (at.ceil().max(0.0) as usize).min(frame.width());
            cells[column(inside[0])..column(inside[1])].fill(class);
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filling_follows_the_outline() {
        let frame = GridFrame::new(Point2::new(-1.0, 1.0), 1.0, 8, 5).unwrap();
        let outline = [(0.1, 1.1), (4.9, 1.1), (4.9, 4.9), (3.1, 4.9), (3.1, 2.2), (0.1, 2.2), (0.1, 1.1)];
        let cells = fill(&outline.map(|(x, y)| Point2::new(x, y)), &frame, 1);
        let rows: Vec<String> = cells
            .chunks(8)
            .rev()
            .map(|row| row.iter().map(|&class| if class == 1 { '#' } else { '.' }).collect())
            .collect();
        assert_eq!(rows, ["........", "....##..", "....##..", "....##..", ".#####.."]);
    }

    #[test]
    fn filling_stays_in_the_frame() {
        let frame = GridFrame::new(Point2::origin(), 1.0, 3, 2).unwrap();
        let outline = [(-5.0, -5.0), (50.0, -5.0), (50.0, 50.0), (-5.0, 50.0), (-5.0, -5.0)];
        assert_eq!(fill(&outline.map(|(x, y)| Point2::new(x, y)), &frame, 7), [7; 6]);
        assert_eq!(fill(&[], &frame, 7), [0; 6]);
    }
}

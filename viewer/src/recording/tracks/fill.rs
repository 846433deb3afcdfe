//! From an outline to the cells inside.

use interfaces::{Cell, GridFrame};
use nalgebra::Point2;

/// Fills a closed outline: `class` for every cell of `frame` whose center is inside, 0 for the others.
pub(super) fn fill(outline: &[Point2<f64>], frame: &GridFrame, class: u8) -> Vec<u8> {
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

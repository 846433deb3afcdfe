//! Named lines on a map.

use crate::canvas::{Area, ink, why};
use crate::palette;
use crate::panel::{Chart, Panel, pair};
use crate::pictures::NamedLine;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

/// The space between a line and its name, in points.
const GAP: u32 = 4;

/// Left, top, right and bottom, in pixels to draw with.
type Label = [i32; 4];

/// Draws the lines, then the names on a white ground: beside the middle of each line, and below another name that is there.
pub(crate) fn draw(panel: &Panel, area: &Area, chart: &Chart, lines: &[NamedLine]) -> Result<(), String> {
    for line in lines {
        let ends = line.ends.map(|end| pair(&end));
        chart
            .plotting_area()
            .draw(&PathElement::new(ends, panel.line(ink(palette::CURIOUS), 5)))
            .map_err(why)?;
    }
    let (columns, _) = area.dim_in_pixel();
    let mut labels: Vec<Label> = Vec::new();
    for NamedLine { ends, name } in lines {
        let (x, y) = chart.backend_coord(&pair(&nalgebra::center(&ends[0], &ends[1])));
        let ([width, height], gap) = (panel.text_size(area, name)?, panel.px(GAP));
        // A name that has no room at the right of its line is at the left of it.
        let left = if x + gap + width < columns as i32 { x + gap } else { (x - gap - width).max(0) };
        let label = free_of(&labels, [left, y - height / 2, left + width, y + height / 2]);
        let [left, top, right, bottom] = label;
        let ground =
            Rectangle::new([(left - gap / 2, top), (right + gap / 2, bottom)], WHITE.mix(0.8).filled());
        area.draw(&ground).map_err(why)?;
        panel.write(area, (left, i32::midpoint(top, bottom)), HPos::Left, name)?;
        labels.push(label);
    }
    Ok(())
}

/// The label, moved down until it covers none of the others.
fn free_of(labels: &[Label], [left, mut top, right, mut bottom]: Label) -> Label {
    let covers = |label: &&Label, top: i32, bottom: i32| {
        left < label[2] && label[0] < right && top < label[3] && label[1] < bottom
    };
    while let Some(other) = labels.iter().find(|label| covers(label, top, bottom)) {
        let height = bottom - top;
        (top, bottom) = (other[3], other[3] + height);
    }
    [left, top, right, bottom]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_do_not_cover_each_other() {
        let first = free_of(&[], [10, 10, 50, 20]);
        let second = free_of(&[first], [30, 12, 70, 22]);
        let third = free_of(&[first, second], [30, 12, 70, 22]);
        assert_eq!((first, second, third), ([10, 10, 50, 20], [30, 20, 70, 30], [30, 30, 70, 40]));
        assert_eq!(free_of(&[first], [60, 10, 90, 20]), [60, 10, 90, 20]);
    }
}

//! The plan of a grid world: walls, the paths of blocks, the start and the range of the sensor.

use super::{Entry, Mark, dot};
use crate::figure::pen::{Pen, Sheet};
use interfaces::Cell;
use plotters::prelude::*;
use results::drawing::palette::{self, CURIOUS};
use results::drawing::{INK, ink, why};
use sim::grid::GridSpec;
use std::f64::consts::TAU;
use std::ops::Range;

/// The maximum number of named blocks.
const BLOCKS: usize = 8;
const GRID: RGBColor = RGBColor(232, 234, 238);

/// The entries of the legend.
pub(super) fn legend(world: &GridSpec) -> Vec<Entry> {
    let mut entries = vec![(Mark::Square(INK), "wall".to_owned())];
    for (index, block) in world.blocks.iter().take(BLOCKS).enumerate() {
        entries.push((Mark::Square(ink(palette::thing(index))), block.name.clone()));
    }
    if world.blocks.len() > BLOCKS {
        entries.push((Mark::Nothing, format!("and {} more blocks", world.blocks.len() - BLOCKS)));
    }
    entries.push((Mark::Dot, "start of the robot".to_owned()));
    entries.push((Mark::Ring, format!("range of its sensor: {}", world.sensor_radius)));
    entries
}

/// Draws the cells of a world as large as they fit, from the upper left corner. Returns the right end of the plan.
pub(super) fn draw<DB: DrawingBackend>(
    sheet: &Sheet<DB>,
    pen: &Pen,
    world: &GridSpec,
) -> Result<i32, String> {
    let (columns, rows) = (world.frame().width(), world.frame().height());
    let (width, height) = sheet.dim_in_pixel();
    let side = (f64::from(width) / columns.max(1) as f64).min(f64::from(height) / rows.max(1) as f64);
    // Borders of cells, rounded so that neighbors neither overlap nor leave a gap; in an SVG file, neighboring rows
    // overlap by a tenth of a pixel, since a viewer would blend their border with the background.
    let x = |column: f64| (column * side).round() as i32;
    let y = |row: f64| ((rows as f64 - row) * side).round() as i32;
    let fill = |columns: Range<usize>, row: usize, color: RGBColor| {
        let upper_left = (x(columns.start as f64), y(row as f64 + 1.0));
        let lower_right = (x(columns.end as f64), y(row as f64) + pen.px(1) / 10);
        sheet.draw(&Rectangle::new([upper_left, lower_right], color.filled())).map_err(why)
    };
    for (index, block) in world.blocks.iter().enumerate() {
        for &Cell { x, y } in &block.path {
            fill(x as usize..x as usize + 1, y as usize, ink(palette::thing(index)))?;
        }
    }
    let (right, bottom) = (x(columns as f64), y(0.0));
    if side >= f64::from(pen.px(7)) {
        let upright = (0..=columns).map(|column| [(x(column as f64), 0), (x(column as f64), bottom)]);
        let level = (0..=rows).map(|row| [(0, y(row as f64)), (right, y(row as f64))]);
        let thin = pen.line(GRID, 1);
        upright.chain(level).try_for_each(|line| sheet.draw(&PathElement::new(line, thin)).map_err(why))?;
    }
    for (row, cells) in world.walls.rows().enumerate() {
        let cells: Vec<bool> = cells.copied().collect();
        let mut end = 0;
        for run in cells.chunk_by(|a, b| a == b) {
            end += run.len();
            if run[0] {
                fill(end - run.len()..end, row, INK)?;
            }
        }
    }

    let start = (f64::from(world.start.x) + 0.5, f64::from(world.start.y) + 0.5);
    let reach = f64::from(world.sensor_radius);
    let ring: Vec<(f64, f64)> = (0..=180)
        .map(|part| TAU * f64::from(part) / 180.0)
        .map(|angle_rad| (start.0 + reach * libm::cos(angle_rad), start.1 + reach * libm::sin(angle_rad)))
        .collect();
    let is_in = |&(column, row): &(f64, f64)| {
        (0.0..=columns as f64).contains(&column) && (0.0..=rows as f64).contains(&row)
    };
    for arc in ring.chunk_by(|a, b| is_in(a) == is_in(b)).filter(|arc| is_in(&arc[0])) {
        let line: Vec<(i32, i32)> = arc.iter().map(|&(column, row)| (x(column), y(row))).collect();
        sheet.draw(&PathElement::new(line, pen.line(ink(CURIOUS), 2))).map_err(why)?;
    }
    let radius = (0.35 * side / f64::from(pen.px(1))).round().clamp(2.0, 6.0);
    dot(sheet, pen, (x(start.0), y(start.1)), radius as i32)?;
    Ok(right)
}

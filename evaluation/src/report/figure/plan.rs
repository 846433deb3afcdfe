//! The plan of a world, or of several.

use super::pen::{Pen, Sheet};
use crate::drawing::{INK, ink, why};
use crate::palette::{self, CURIOUS};
use interfaces::Cell;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;
use sim::grid::GridSpec;
use std::f64::consts::TAU;
use std::ops::Range;

/// The width of the legend beside a plan, in pixels of the finished picture.
const LEGEND: i32 = 190;
const ROW: i32 = 24;
/// The maximum number of named blocks, and of drawn worlds.
const BLOCKS: usize = 8;
const WORLDS: usize = 12;
const GRID: RGBColor = RGBColor(232, 234, 238);

/// Draws a world with a legend.
pub(super) fn one<DB: DrawingBackend>(sheet: &Sheet<DB>, pen: &Pen, world: &GridSpec) -> Result<(), String> {
    pen.write(sheet, (16, 18), HPos::Left, 17, "The world")?;
    let (width, _) = sheet.dim_in_pixel();
    let below = sheet.margin(pen.px(34), pen.px(14), pen.px(16), 0);
    let (left, _) = below.split_horizontally(width as i32 - pen.px(LEGEND + 16));
    let right = cells(&left, pen, world)?;
    let (_, legend) = below.split_horizontally(right + pen.px(14));

    let mut middle = 12;
    let mut row = |mark: &dyn Fn(i32) -> Result<(), String>, text: &str| {
        mark(middle)?;
        pen.write(&legend, (26, middle), HPos::Left, 15, text)?;
        middle += ROW;
        Ok::<_, String>(())
    };
    let square = |color: RGBColor| {
        let legend = &legend;
        move |middle: i32| pen.bar(legend, [4, middle - 7], [14, 14], &color)
    };
    row(&square(INK), "wall")?;
    for (index, block) in world.blocks.iter().take(BLOCKS).enumerate() {
        row(&square(ink(palette::thing(index))), &block.name)?;
    }
    if world.blocks.len() > BLOCKS {
        row(&|_| Ok(()), &format!("and {} more blocks", world.blocks.len() - BLOCKS))?;
    }
    let center = |middle: i32| (pen.px(11), pen.px(middle));
    row(&|middle| dot(&legend, pen, center(middle), 5), "start of the robot")?;
    let ring = pen.line(ink(CURIOUS), 2);
    row(
        &|middle| legend.draw(&Circle::new(center(middle), pen.px(7), ring)).map_err(why),
        &format!("range of its sensor: {}", world.sensor_radius),
    )
}

/// Draws worlds side by side, as many as fit.
pub(super) fn many<DB: DrawingBackend>(
    sheet: &Sheet<DB>,
    pen: &Pen,
    worlds: &[&GridSpec],
) -> Result<(), String> {
    let title = match worlds.len() {
        0 => return Ok(()),
        count if count > WORLDS => format!("{WORLDS} of the worlds"),
        _ => "The worlds".into(),
    };
    pen.write(sheet, (16, 18), HPos::Left, 17, &title)?;
    let below = sheet.margin(pen.px(34), pen.px(8), pen.px(12), 0);
    let shown = worlds.len().min(WORLDS);
    let columns = match shown {
        ..=2 => shown,
        3..=6 => 3,
        _ => 4,
    };
    let areas = below.split_evenly((shown.div_ceil(columns), columns));
    for (area, world) in areas.iter().zip(worlds) {
        cells(&area.margin(0, pen.px(16), pen.px(6), pen.px(6)), pen, world)?;
    }
    Ok(())
}

/// Draws the cells of a world as large as they fit, from the upper left corner. Returns the right end of the plan.
fn cells<DB: DrawingBackend>(sheet: &Sheet<DB>, pen: &Pen, world: &GridSpec) -> Result<i32, String> {
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
    for (row, cells) in world.walls.cells().chunks(columns).enumerate() {
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

/// Draws the start of the robot: a filled circle with a white rim.
fn dot<DB: DrawingBackend>(sheet: &Sheet<DB>, pen: &Pen, at: (i32, i32), radius: i32) -> Result<(), String> {
    sheet.draw(&Circle::new(at, pen.px(radius + 1), WHITE.filled())).map_err(why)?;
    sheet.draw(&Circle::new(at, pen.px(radius), ink(CURIOUS).filled())).map_err(why)
}

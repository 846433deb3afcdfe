//! The plan of a world.

mod grid;
mod physics;

use super::pen::{Pen, Sheet};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;
use results::drawing::palette::CURIOUS;
use results::drawing::{ink, why};
use sim::grid::GridSpec;
use sim::physics::WorldSpec;

/// The width of the legend beside a plan, in pixels of the finished picture.
const LEGEND: i32 = 190;
const ROW: i32 = 24;
/// A world whose plan is drawn beside the curves.
#[derive(Clone, Copy, Debug)]
pub enum Plan<'a> {
    /// A grid world.
    Grid(&'a GridSpec),
    /// A physics world.
    Physics(&'a WorldSpec),
}

impl<'a> From<&'a GridSpec> for Plan<'a> {
    fn from(world: &'a GridSpec) -> Self {
        Self::Grid(world)
    }
}

impl<'a> From<&'a WorldSpec> for Plan<'a> {
    fn from(world: &'a WorldSpec) -> Self {
        Self::Physics(world)
    }
}

/// The mark of an entry of a legend.
enum Mark {
    Square(RGBColor),
    Dot,
    Ring,
    Nothing,
}

/// An entry of a legend.
type Entry = (Mark, String);

impl Plan<'_> {
    /// The name of the world.
    pub(super) fn name(&self) -> &str {
        match self {
            Self::Grid(world) => &world.name,
            Self::Physics(world) => &world.name,
        }
    }

    fn legend(&self) -> Vec<Entry> {
        match self {
            Self::Grid(world) => grid::legend(world),
            Self::Physics(world) => physics::legend(world),
        }
    }

    /// Draws the plan as large as it fits, from the upper left corner. Returns its right end.
    fn draw<DB: DrawingBackend>(&self, sheet: &Sheet<DB>, pen: &Pen) -> Result<i32, String> {
        match self {
            Self::Grid(world) => grid::draw(sheet, pen, world),
            Self::Physics(world) => physics::draw(sheet, pen, world),
        }
    }
}

/// Draws a world with a legend.
pub(super) fn draw<DB: DrawingBackend>(sheet: &Sheet<DB>, pen: &Pen, world: &Plan) -> Result<(), String> {
    pen.write(sheet, (16, 18), HPos::Left, 17, "The world")?;
    let (width, _) = sheet.dim_in_pixel();
    let below = sheet.margin(pen.px(34), pen.px(14), pen.px(16), 0);
    let (left, _) = below.split_horizontally(width as i32 - pen.px(LEGEND + 16));
    let right = world.draw(&left, pen)?;
    let (_, legend) = below.split_horizontally(right + pen.px(14));
    for (row, entry) in (0..).zip(world.legend()) {
        draw_entry(&legend, pen, (0, 12 + row * ROW), &entry)?;
    }
    Ok(())
}

/// Draws an entry of a legend; `at` is the middle of its left side.
fn draw_entry<DB: DrawingBackend>(
    sheet: &Sheet<DB>,
    pen: &Pen,
    (left, middle): (i32, i32),
    (mark, text): &Entry,
) -> Result<(), String> {
    let center = (pen.px(left + 11), pen.px(middle));
    match mark {
        Mark::Square(color) => pen.bar(sheet, [left + 4, middle - 7], [14, 14], color)?,
        Mark::Dot => dot(sheet, pen, center, 5)?,
        Mark::Ring => sheet.draw(&Circle::new(center, pen.px(7), pen.line(ink(CURIOUS), 2))).map_err(why)?,
        Mark::Nothing => {}
    }
    pen.write(sheet, (left + 26, middle), HPos::Left, 15, text)
}

/// Draws the start of the robot: a filled circle with a white rim.
fn dot<DB: DrawingBackend>(sheet: &Sheet<DB>, pen: &Pen, at: (i32, i32), radius: i32) -> Result<(), String> {
    sheet.draw(&Circle::new(at, pen.px(radius + 1), WHITE.filled())).map_err(why)?;
    sheet.draw(&Circle::new(at, pen.px(radius), ink(CURIOUS).filled())).map_err(why)
}

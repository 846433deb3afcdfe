//! Lengths, lines, marks and text, in pictures of pixels and of vectors.

use crate::canvas::{Drawn, FONT, INK, ink, px, register_fonts, why};
use crate::legend::Mark;
use crate::palette::Rgb;
use interfaces::printable;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::TextStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A part of a picture to draw on.
pub type Sheet<DB> = DrawingArea<DB, Shift>;

/// The radius of a filled circle, without its rim.
const DOT: i32 = 5;

/// Converts lengths to the units of a backend.
#[derive(Clone, Copy, Debug)]
pub struct Pen {
    scale: i32,
    /// The library puts the middle of a letter a quarter of its height too high, but only there.
    is_bitmap: bool,
}

impl Pen {
    /// Lengths in pixels of the finished picture.
    pub const BITMAP: Self = Self::of_points(1);
    /// The library's lengths are whole numbers: a tenth of a pixel keeps curves smooth.
    pub const VECTOR: Self = Self { scale: 10, is_bitmap: false };

    /// Lengths in points, of which each has this number of pixels of the finished picture.
    pub const fn of_points(pixels: u32) -> Self {
        Self { scale: px(pixels), is_bitmap: true }
    }

    /// A length.
    pub fn px(&self, length: i32) -> i32 {
        length * self.scale
    }

    /// A line of a width.
    pub fn line(&self, color: impl Color, width: u32) -> ShapeStyle {
        color.stroke_width(width * self.scale as u32)
    }

    /// Text of a height.
    pub fn text(&self, height: i32) -> TextStyle<'static> {
        (FONT, self.px(height)).into_font().color(&INK)
    }

    /// Writes a line of text; `at`, in the units of the backend, is the middle of the side that `anchor` gives.
    ///
    /// # Errors
    ///
    /// As of the plotting library.
    pub fn write<DB: DrawingBackend>(
        &self,
        sheet: &Sheet<DB>,
        at: (i32, i32),
        anchor: HPos,
        height: i32,
        text: &str,
    ) -> Drawn {
        let style = self.text(height).pos(Pos::new(anchor, VPos::Center));
        let lower = if self.is_bitmap { self.px(height) / 4 } else { 0 };
        // XML forbids some characters, and names can have any.
        sheet.draw(&Text::new(printable(text), (at.0, at.1 + lower), style)).map_err(why)
    }

    /// Fills a rectangle.
    ///
    /// # Errors
    ///
    /// As of the plotting library.
    pub fn bar<DB: DrawingBackend>(
        &self,
        sheet: &Sheet<DB>,
        [left, top]: [i32; 2],
        [width, height]: [i32; 2],
        color: &impl Color,
    ) -> Drawn {
        let corners = [(self.px(left), self.px(top)), (self.px(left + width), self.px(top + height))];
        sheet.draw(&Rectangle::new(corners, color.filled())).map_err(why)
    }

    /// Draws a filled circle with a white rim; `center` in the units of the backend.
    ///
    /// # Errors
    ///
    /// As of the plotting library.
    pub fn dot<DB: DrawingBackend>(&self, sheet: &Sheet<DB>, center: (i32, i32), color: Rgb) -> Drawn {
        sheet.draw(&Circle::new(center, self.px(DOT + 1), WHITE.filled())).map_err(why)?;
        sheet.draw(&Circle::new(center, self.px(DOT), ink(color).filled())).map_err(why)
    }

    /// Draws the mark of an entry of a legend, of this size; (`x`, `y`), in the units of the backend, is the middle of its left side.
    pub(crate) fn mark<DB: DrawingBackend>(
        &self,
        sheet: &Sheet<DB>,
        mark: Mark,
        (x, y): (i32, i32),
        size: i32,
    ) -> Drawn {
        let half = self.px(size) / 2;
        let middle = (x + half, y);
        match mark {
            Mark::Area(color) => {
                let corners = [(x, y - half), (x + 2 * half, y + half)];
                sheet.draw(&Rectangle::new(corners, ink(color).filled())).map_err(why)?;
                sheet.draw(&Rectangle::new(corners, INK.stroke_width(1))).map_err(why)
            }
            Mark::Line(color) => {
                let ends = [(x, y), (x + 2 * half, y)];
                sheet.draw(&PathElement::new(ends, self.line(ink(color), 2))).map_err(why)
            }
            Mark::Cross(color) => {
                let style = ink(color).stroke_width((3 * self.scale / 2) as u32);
                sheet.draw(&Cross::new(middle, half * 2 / 3, style)).map_err(why)
            }
            Mark::Dot(color) => self.dot(sheet, middle, color),
        }
    }
}

/// The text of an SVG file of `size` with what `draw` puts on it.
///
/// # Errors
///
/// When the drawing fails.
pub fn svg(size: [u32; 2], draw: impl FnOnce(&Sheet<SVGBackend>) -> Drawn) -> Drawn<String> {
    register_fonts()?;
    let drawn @ [width, height] = size.map(|length| length * Pen::VECTOR.scale as u32);
    let mut text = String::new();
    let sheet = SVGBackend::with_string(&mut text, drawn.into()).into_drawing_area();
    draw(&sheet)?;
    sheet.present().map_err(why)?;
    drop(sheet);
    // Drawn large, shown in its size. Sharp corners of thick lines would show as spikes.
    let shown = format!("width=\"{}\" height=\"{}\" stroke-linejoin=\"round\"", size[0], size[1]);
    Ok(text.replacen(&format!("width=\"{width}\" height=\"{height}\""), &shown, 1))
}

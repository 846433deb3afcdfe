//! Lengths, lines and text for PNG and SVG figures.

use interfaces::printable;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::TextStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use results::drawing::{FONT, INK, px, register_fonts, why};

/// A part of a figure to draw on.
pub(super) type Sheet<DB> = DrawingArea<DB, Shift>;

/// Converts lengths in pixels of the finished picture to the units of a backend.
pub(super) struct Pen {
    scale: i32,
    /// The library puts the middle of a letter a quarter of its height too high, but only there.
    is_bitmap: bool,
}

impl Pen {
    pub(super) const BITMAP: Self = Self { scale: px(1), is_bitmap: true };
    /// The library's lengths are whole numbers: a tenth of a pixel keeps curves smooth.
    pub(super) const VECTOR: Self = Self { scale: 10, is_bitmap: false };

    /// A length.
    pub(super) fn px(&self, length: i32) -> i32 {
        length * self.scale
    }

    /// A line of a width.
    pub(super) fn line(&self, color: impl Color, width: u32) -> ShapeStyle {
        color.stroke_width(width * self.scale as u32)
    }

    /// Text of a height.
    pub(super) fn text(&self, height: i32) -> TextStyle<'static> {
        (FONT, self.px(height)).into_font().color(&INK)
    }

    /// Writes a line of text; `at` is the middle of the side that `anchor` gives.
    pub(super) fn write<DB: DrawingBackend>(
        &self,
        sheet: &Sheet<DB>,
        at: (i32, i32),
        anchor: HPos,
        height: i32,
        text: &str,
    ) -> Result<(), String> {
        let style = self.text(height).pos(Pos::new(anchor, VPos::Center));
        let lower = if self.is_bitmap { self.px(height) / 4 } else { 0 };
        // XML forbids some characters, and names can have any.
        sheet.draw_text(&printable(text), &style, (self.px(at.0), self.px(at.1) + lower)).map_err(why)
    }

    /// Fills a rectangle.
    pub(super) fn bar<DB: DrawingBackend>(
        &self,
        sheet: &Sheet<DB>,
        [left, top]: [i32; 2],
        [width, height]: [i32; 2],
        color: &impl Color,
    ) -> Result<(), String> {
        let corners = [(self.px(left), self.px(top)), (self.px(left + width), self.px(top + height))];
        sheet.draw(&Rectangle::new(corners, color.filled())).map_err(why)
    }
}

/// The text of an SVG file of `size` with what `draw` puts on it.
pub(super) fn svg(
    size: [u32; 2],
    draw: impl FnOnce(&Sheet<SVGBackend>) -> Result<(), String>,
) -> Result<String, String> {
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

//! An SVG file to draw into. Letters are drawn as their outlines, so that a figure looks the same
//! wherever it is shown, also where there are no fonts.

use ab_glyph::{Font, FontRef, OutlineCurve, Point, ScaleFont};
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
};
use std::convert::Infallible;
use std::fmt::Write;

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

/// Writes SVG elements, one per line.
pub(super) struct Vector<'a> {
    size: (u32, u32),
    font: FontRef<'static>,
    elements: &'a mut String,
}

impl<'a> Vector<'a> {
    /// A picture of `size`, width and height, whose elements are appended to `elements`.
    pub(super) fn new(size: (u32, u32), font: FontRef<'static>, elements: &'a mut String) -> Self {
        Self { size, font, elements }
    }

    fn element(&mut self, element: std::fmt::Arguments) -> Drawn {
        // Infallible: this writes to a string.
        writeln!(self.elements, "<{element}/>").ok();
        Ok(())
    }
}

/// A colour as the attributes of what is filled or lined with it.
fn paint(what: &str, colour: BackendColor) -> String {
    let (red, green, blue) = colour.rgb;
    let paint = format!("{what}=\"#{red:02x}{green:02x}{blue:02x}\"");
    if colour.alpha < 1.0 { format!("{paint} {what}-opacity=\"{}\"", colour.alpha) } else { paint }
}

/// The attributes of a figure that is filled, or of which only the border is drawn.
fn filled_or_lined(style: &impl BackendStyle, is_filled: bool) -> String {
    if is_filled { paint("fill", style.color()) } else { lined(style) }
}

fn lined(style: &impl BackendStyle) -> String {
    format!("fill=\"none\" {} stroke-width=\"{}\"", paint("stroke", style.color()), style.stroke_width())
}

fn points(path: impl IntoIterator<Item = BackendCoord>) -> String {
    let points: Vec<String> = path.into_iter().map(|(x, y)| format!("{x},{y}")).collect();
    points.join(" ")
}

impl DrawingBackend for Vector<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, colour: BackendColor) -> Drawn {
        self.draw_rect((x, y), (x + 1, y + 1), &colour, true)
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        is_filled: bool,
    ) -> Drawn {
        let (width, height) = (right - left, bottom - top);
        let paint = filled_or_lined(style, is_filled);
        self.element(format_args!(
            "rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" {paint}"
        ))
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        // The library's own way to draw nothing.
        if style.color().alpha == 0.0 {
            return Ok(());
        }
        self.element(format_args!("polyline {} points=\"{}\"", lined(style), points(path)))
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        (x, y): BackendCoord,
        radius: u32,
        style: &S,
        is_filled: bool,
    ) -> Drawn {
        let paint = filled_or_lined(style, is_filled);
        self.element(format_args!("circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {paint}"))
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        self.element(format_args!("polygon {} points=\"{}\"", paint("fill", style.color()), points(path)))
    }

    /// Draws level text; the style's turn is not asked for, since no figure has any.
    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, (x, y): BackendCoord) -> Drawn {
        let size = style.size() as f32;
        let (outline, width) = outline(&self.font, size, text);
        let left = match style.anchor().h_pos {
            HPos::Left => 0.0,
            HPos::Center => width / 2.0,
            HPos::Right => width,
        };
        // From the upper edge of a capital letter, its middle or its foot.
        let capital = size * CAPITAL;
        let foot = match style.anchor().v_pos {
            VPos::Top => capital,
            VPos::Center => capital / 2.0,
            VPos::Bottom => 0.0,
        };
        let (x, y) = (x as f32 - left, y as f32 + foot);
        let paint = paint("fill", style.color());
        let spoken = escaped(text);
        self.element(format_args!(
            "path role=\"img\" aria-label=\"{spoken}\" transform=\"translate({x:.0} {y:.0})\" {paint} d=\"{outline}\""
        ))
    }
}

/// The height of a capital letter of the font, in heights of a line.
const CAPITAL: f32 = 0.6;

/// The outline of a line of text from its left end, on its foot, and how long it is.
fn outline(font: &FontRef, size: f32, text: &str) -> (String, f32) {
    let scaled = font.as_scaled(size);
    let scale = size / font.height_unscaled();
    let (mut path, mut width, mut previous) = (String::new(), 0.0, None);
    for letter in text.chars() {
        let glyph = font.glyph_id(letter);
        width += previous.map_or(0.0, |previous| scaled.kern(previous, glyph));
        // In the font y points upwards.
        let at = |point: Point| {
            let place = [width + point.x * scale, -point.y * scale].map(|length| length.round() as i32);
            format!("{} {}", place[0], place[1])
        };
        let mut end = None;
        for curve in font.outline(glyph).into_iter().flat_map(|outline| outline.curves) {
            let (start, way, next) = match curve {
                OutlineCurve::Line(start, next) => (start, format!("L{}", at(next)), next),
                OutlineCurve::Quad(start, control, next) => {
                    (start, format!("Q{} {}", at(control), at(next)), next)
                }
                OutlineCurve::Cubic(start, one, other, next) => {
                    (start, format!("C{} {} {}", at(one), at(other), at(next)), next)
                }
            };
            if end != Some(start) {
                path += &format!("M{}", at(start));
            }
            path += &way;
            end = Some(next);
        }
        width += scaled.h_advance(glyph);
        previous = Some(glyph);
    }
    (path, width)
}

/// Text as the value of an attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

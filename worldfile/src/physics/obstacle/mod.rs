//! What kind of obstacle a table of the file describes.

mod block;
mod door;

use crate::error::{Source, WorldError};
use crate::physics::file::ObstacleFile;
use crate::physics::numbers::Table;
use crate::physics::space::{MAX_TIME_S, Solid, inside, upright};
use crate::together::Together;
use nalgebra::Point2;
use serde_spanned::Spanned;
use sim::physics::{Motion, ObstacleSpec, PushedSpec, Rectangle};
use std::ops::Range;

/// The keys of each kind, beside its name, and what it is.
const KINDS: [(&str, &[&str], &str); 5] = [
    (
        "fixed",
        &["min_m", "max_m", "center_m", "size_m", "heading_deg", "appears_s", "disappears_s"],
        "stands, and may come and go",
    ),
    ("box", &["min_m", "max_m", "center_m", "size_m", "heading_deg", "mass_kg", "friction"], "can be pushed"),
    (
        "block",
        &["size_m", "heading_deg", "path_m", "dwell_s", "speed_mps", "times_s", "repeat"],
        "moves along a path",
    ),
    (
        "hinged_door",
        &[
            "from_m",
            "to_m",
            "thickness_m",
            "open_deg",
            "opening",
            "closed_s",
            "open_s",
            "switches_s",
            "move_s",
            "starts_open",
        ],
        "turns about `from_m`",
    ),
    (
        "sliding_door",
        &[
            "from_m",
            "to_m",
            "thickness_m",
            "slide_m",
            "opening",
            "closed_s",
            "open_s",
            "switches_s",
            "move_s",
            "starts_open",
        ],
        "slides from `to_m` towards `from_m`",
    ),
];

/// An obstacle of the file, and what stands where it is.
pub(super) struct Context<'a> {
    pub(super) source: &'a Source<'a>,
    pub(super) file: &'a ObstacleFile,
    pub(super) kind: &'a str,
    pub(super) name: &'a str,
    pub(super) size: &'a Point2<f64>,
    pub(super) walls: &'a [Solid],
    pub(super) step_s: f64,
}

/// Checks an obstacle of the file.
pub(super) fn obstacle(
    source: &Source<'_>,
    file: &ObstacleFile,
    size: &Point2<f64>,
    walls: &[Solid],
    step_s: f64,
) -> Result<ObstacleSpec, WorldError> {
    let kind = match &file.kind {
        None => "fixed",
        Some(kind) => {
            let Some((known, _, _)) = KINDS.iter().find(|(known, _, _)| known == kind.get_ref()) else {
                let what = format!("`{}` is no kind of obstacle", kind.get_ref());
                let names = KINDS.map(|(name, _, _)| format!("\"{name}\""));
                let help = format!("it must be one of {}", names.join(", "));
                return Err(source.error(&what, (kind.span(), "not known"), &[], &help));
            };
            known
        }
    };
    let (_, known, does) = KINDS.iter().find(|(name, _, _)| *name == kind).unwrap_or(&KINDS[0]);
    let foreign = file.keys().into_iter().filter(|(key, _)| !known.contains(key)).map(|(key, span)| {
        let what = format!("an obstacle that is `{kind}` has no `{key}`");
        let help = format!("leave it out: such an obstacle {does}; its keys are {}", known.join(", "));
        Err::<(), _>(source.error(&what, (span, "not for this obstacle"), &[], &help))
    });
    // Where such a key stands, the kind may be what is wrong, or missing: nothing else is judged by it.
    let most = if file.kind.is_some() { usize::MAX } else { 1 };
    foreign.take(most).collect::<Vec<_>>().together()?;
    let context = Context { source, file, kind, name: file.name.get_ref(), size, walls, step_s };
    let spec = match kind {
        "block" => context.block(),
        "hinged_door" | "sliding_door" => context.door(kind == "hinged_door"),
        "box" => context.pushed(),
        _ => context.fixed(),
    };
    (source.name("obstacle", &file.name), spec).together().map(|(_, spec)| spec)
}

impl Context<'_> {
    pub(super) const TABLE: &'static str = "obstacle";

    pub(super) fn table(&self) -> Table<'_> {
        Table { source: self.source, path: Self::TABLE }
    }

    /// The place in the file that stands for it as a whole.
    pub(super) fn span(&self) -> Range<usize> {
        self.file.name.span()
    }

    pub(super) fn incomplete(&self, what: &str, help: &str) -> WorldError {
        let what = format!("the {what} `{}` is not complete", self.name);
        self.source.error(&what, (self.span(), "this one"), &[], help)
    }

    /// A key that this kind cannot do without.
    pub(super) fn needed<'f, T>(
        &self,
        key: &str,
        value: &'f Option<Spanned<T>>,
    ) -> Result<&'f Spanned<T>, WorldError> {
        value.as_ref().ok_or_else(|| {
            let what = format!("the obstacle `{}` has no `{key}`", self.name);
            let help = format!("an obstacle that is `{}` needs a line `{key} = …`", self.kind);
            self.source.error(&what, (self.span(), "this one"), &[], &help)
        })
    }

    pub(super) fn spec(self, shape: Rectangle, motion: Motion) -> ObstacleSpec {
        let tag = self.file.tag.as_ref().map(|tag| *tag.get_ref());
        ObstacleSpec { name: self.name.to_owned(), shape, motion, tag, appears_s: None, disappears_s: None }
    }

    fn fixed(self) -> Result<ObstacleSpec, WorldError> {
        let (shape, times_s) = (self.shape(), self.stay_s()).together()?;
        let (appears_s, disappears_s) = times_s;
        Ok(ObstacleSpec { appears_s, disappears_s, ..self.spec(shape, Motion::Fixed) })
    }

    /// When it comes and goes, s.
    fn stay_s(&self) -> Result<(Option<f64>, Option<f64>), WorldError> {
        let (table, file) = (self.table(), self.file);
        let (appears_s, disappears_s) = (
            table.number_if("appears_s", &file.appears_s, 0.001..=MAX_TIME_S),
            table.number_if("disappears_s", &file.disappears_s, 0.001..=MAX_TIME_S),
        )
            .together()?;
        if let (Some(from), Some(to), Some(marked)) = (appears_s, disappears_s, &self.file.disappears_s)
            && to <= from
        {
            let what = format!("the obstacle `{}` disappears before it appears", self.name);
            let help = format!("`disappears_s` must be later than `appears_s`, which is {from}");
            return Err(self.source.error(&what, (marked.span(), "too early"), &[], &help));
        }
        Ok((appears_s, disappears_s))
    }

    fn pushed(self) -> Result<ObstacleSpec, WorldError> {
        let mass = self.needed("mass_kg", &self.file.mass_kg);
        let (shape, mass_kg, friction) = (
            self.shape(),
            mass.and_then(|mass| self.table().number("mass_kg", mass, 0.001..=100_000.0)),
            self.table().number_or("friction", &self.file.friction, 0.5, 0.0..=10.0),
        )
            .together()?;
        // A thin box would lie in a wall as a whole before the physics pushes it out.
        if shape.half_m.min() < 0.01 {
            let help = "a box that can be pushed must be 0.02 m wide or more";
            let what = format!("the box `{}` is too thin", self.name);
            return Err(self.source.error(&what, (self.span(), "this one"), &[], help));
        }
        Ok(self.spec(shape, Motion::Pushed(PushedSpec { mass_kg, friction })))
    }

    /// The shape of what stands at the start.
    fn shape(&self) -> Result<Rectangle, WorldError> {
        let (table, span) = (self.table(), self.span());
        let ObstacleFile { min_m, max_m, center_m, size_m, heading_deg, .. } = self.file;
        let shape = match (min_m, max_m, center_m, size_m) {
            (Some(min), Some(max), None, None) if heading_deg.is_none() => {
                upright(&table, min, max, self.size)?
            }
            (None, None, Some(center), Some(sides)) => {
                let (center, sides, heading_deg) = (
                    table.point("center_m", center, self.size),
                    table.pair("size_m", sides, 0.001..=100.0),
                    table.number_or("heading_deg", heading_deg, 0.0, -360.0..=360.0),
                )
                    .together()?;
                Rectangle::around(center, sides.coords, heading_deg.to_radians())
            }
            _ => {
                let help = "give either `min_m` and `max_m`, or `center_m`, `size_m` and, if it is turned, `heading_deg`";
                return Err(self.source.error(
                    "an obstacle needs one shape",
                    (span, "this obstacle"),
                    &[],
                    help,
                ));
            }
        };
        self.is_free(&shape)?;
        Ok(shape)
    }

    /// It lies in the map and in no wall.
    fn is_free(&self, shape: &Rectangle) -> Result<(), WorldError> {
        let (name, span) = (&self.name, self.span());
        let what = format!("the obstacle `{name}` reaches out of the map");
        inside(self.source, &what, span.clone(), shape, self.size)?;
        if let Some(wall) = self.walls.iter().find(|wall| wall.shape.overlaps(shape)) {
            let what = format!("the obstacle `{name}` stands in a wall");
            let marks = [(wall.span.clone(), "in this wall")];
            let help = "it may touch walls, but not overlap them";
            return Err(self.source.error(&what, (span, "this obstacle"), &marks, help));
        }
        Ok(())
    }
}

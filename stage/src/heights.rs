//! Stage worlds have heights, this simulator has none: warnings where heights matter.

use super::lexer::Span;
use super::sources::Sources;
use std::collections::BTreeSet;

/// The maximum number of comparisons; further ones are left out.
const MAX_COMPARISONS: usize = 10_000_000;

/// A body between two heights.
pub(super) struct Solid {
    pub(super) name: String,
    /// The robot that it is a part of.
    pub(super) robot: Option<usize>,
    pub(super) place: Span,
    /// The lowest and the highest point of the body, m.
    pub(super) z_m: [f64; 2],
}

/// The height of a sensor, and its place in the file.
pub(super) struct Beam {
    pub(super) robot: usize,
    pub(super) place: Span,
    pub(super) z_m: f64,
}

/// Everything that has a height.
#[derive(Default)]
pub(super) struct Heights {
    pub(super) solids: Vec<Solid>,
    pub(super) beams: Vec<Beam>,
}

impl Heights {
    /// Warns of beams that pass over bodies in Stage, and of robots that do.
    pub(super) fn compare(&self, sources: &mut Sources<'_>) {
        let mut left = MAX_COMPARISONS;
        for beam in &self.beams {
            let misses = |solid: &&Solid| {
                solid.robot != Some(beam.robot) && !(solid.z_m[0]..=solid.z_m[1]).contains(&beam.z_m)
            };
            if let Some(Solid { name, z_m: [low_m, high_m], .. }) = self.solids.iter().take(left).find(misses)
            {
                let what = format!("in Stage these beams, {:.3} m high, miss `{name}`", beam.z_m);
                let help = "here there are no heights, and they meet it";
                let help = format!("it reaches from {low_m:.3} to {high_m:.3} m; {help}");
                sources.warning(beam.place, what, help);
            }
            left = left.saturating_sub(self.solids.len());
        }
        let mut compared: BTreeSet<(u32, u32)> = BTreeSet::new();
        for a in self.solids.iter().filter(|solid| solid.robot.is_some()) {
            // The parts of one definition share its height: one of them is enough.
            if !compared.insert((a.place.file, a.place.start)) {
                continue;
            }
            let passes = |b: &&Solid| b.robot != a.robot && (a.z_m[1] < b.z_m[0] || b.z_m[1] < a.z_m[0]);
            if let Some(b) = self.solids.iter().take(left).find(passes) {
                let what = format!("in Stage `{}` passes over or under `{}`", a.name, b.name);
                let help = "here there are no heights, and they bump into each other";
                sources.warning(a.place, what, help);
            }
            left = left.saturating_sub(self.solids.len());
        }
    }
}

//! Rays: what a laser sees, exact to the geometry.
//!
//! The usual caster asks, for every beam, what it hits. Here everything asks which beams can hit
//! it, and only these are looked at ([`fan`]): the cost is the number of things plus the beams that
//! they fill, not their product. Walls are [`outline`]s, from which what no ray can meet is left
//! out, and [`sight`] knows, for every place, the few of them that can be seen from there. What moves
//! is kept by the place it is in ([`hulls`], and round robots in [`scene`]).

mod discs;
mod fan;
mod hulls;
mod lists;
mod outline;
mod scene;
mod sight;

pub(super) use fan::Beams;
pub(super) use scene::{Disc, Scene, Scratch};

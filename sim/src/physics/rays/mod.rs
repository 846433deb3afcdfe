//! Ray casting: the ranges of all beams of a sensor, exact to the geometry.
//!
//! The usual method asks for every beam what the beam hits. Here every body asks which beams can hit the
//! body, and only these are computed ([`beams`]): the cost is the number of bodies plus the number of beams
//! that they cover, not the product. Walls are reduced to the [`edges`] that a ray can hit, and a potentially
//! visible set ([`visibility`]) lists for every position the few of them that can be seen from there. What
//! moves is sorted by position ([`polygons`], and round robots in [`scene`]).

mod beams;
mod circles;
mod edges;
mod index_lists;
mod polygons;
mod scene;
mod visibility;

pub(super) use beams::Beams;
pub(super) use circles::Disc;
pub(super) use scene::{Scene, Scratch};

//! Ray casting: the ranges of all beams of a sensor, exact to the geometry.
//!
//! The usual method computes for every beam which bodies the beam hits. Here, for every body, the beams that can
//! hit the body are determined, and only these are computed ([`beams`]). The computing time depends on the number
//! of bodies plus the number of beams that they cover, not on the product. Walls are reduced to the [`edges`] that
//! a ray can hit, and a potentially visible set ([`visibility`]) lists for every position the few edges that can be
//! seen from there, and edges behind the hits of nearer ones are left out ([`hiding`]). Moving bodies are sorted by
//! position ([`polygons`], and round robots in [`scene`]). Where only the shortest range counts, the nearest walls and
//! bodies come first, and what is farther away is left out ([`nearest`]); the sensors of a robot share the list of what is
//! near ([`vicinity`]). A scan that sweeps has a method of its own ([`sectors`]).

mod beams;
mod disc;
mod edges;
mod hiding;
mod index_lists;
mod nearest;
mod polygons;
mod scene;
mod sectors;
mod vicinity;
mod visibility;

pub(super) use beams::Beams;
pub(super) use disc::Disc;
pub(super) use scene::Scene;
pub(super) use sectors::{Passing, Ray};
pub(super) use vicinity::{Ring, Vicinity};

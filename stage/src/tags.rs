//! What can have a tag: here only robots, and boxes by themselves.

use super::StageWall;
use super::place::Place;
use super::sources::Sources;
use nalgebra::Point2;
use worldfile::physics::MAX_PIECES;

/// A box lies about its pose if its middle is so near, m.
const NEAR_M: f64 = 1e-6;

/// Leaves the tags of all things out that cannot be obstacles of their own here, which have the tag
/// in their middle and lie outside of walls. `tagged`: the wall, its pose, and the place of its tag.
pub(super) fn check(
    sources: &mut Sources<'_>,
    walls: &mut [StageWall],
    tagged: &[(usize, Point2<f64>, Place)],
) {
    let pieces: usize = walls.iter().map(|wall| wall.rectangles.len()).sum();
    for (index, pose, place) in tagged {
        let [shape] = walls[*index].rectangles.as_slice() else {
            walls[*index].tag = None;
            let help = "here a tag is that of one rectangle: give the thing no bitmap and no blocks";
            sources.warning(*place, "the tag of a thing of several pieces is left out", "", help);
            continue;
        };
        let reach_m = shape.half_m.norm();
        let overlaps = |other: &&sim::physics::Rectangle| {
            let apart_m = (other.pose.translation.vector - shape.pose.translation.vector).norm();
            apart_m <= reach_m + other.half_m.norm() && shape.overlaps(other)
        };
        let others = walls.iter().enumerate().filter(|(other, _)| other != index);
        let (what, help) = if (shape.pose.translation.vector - pose.coords).norm() > NEAR_M {
            let help = "here a tag is in the middle of its thing: give it no `origin`";
            ("the tag of a thing that does not lie about its pose is left out", help)
        } else if pieces <= MAX_PIECES // or it does not run anyway
            && others.flat_map(|(_, wall)| &wall.rectangles).any(|other| overlaps(&other))
        {
            ("the tag of a thing that lies in another one is left out", "here what has a tag lies by itself")
        } else {
            continue;
        };
        walls[*index].tag = None;
        sources.warning(*place, what, "", help);
    }
}

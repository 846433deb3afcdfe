//! Outline and rectangles against what they stand for: the blocked pixels.

use crate::floor_plan::{Bitmap, FloorPlan, PixelSegment};
use interfaces::pose;
use nalgebra::{Point2, Vector2};
use proptest::prelude::*;

fn bitmap(rows: &str) -> Bitmap {
    Bitmap::from_ascii(rows).unwrap()
}

/// Two rooms with a door between them, walls one pixel thick.
const ROOMS: &str = "\
#########
#   #   #
#       #
#   #   #
#########";

#[test]
fn a_plan_with_right_angles_has_a_segment_per_side() {
    let rooms = bitmap(ROOMS);
    // Outside 4; inside one space of 12 sides, which the two stubs of the middle wall make.
    assert_eq!(rooms.outline().len(), 16);
    // Bottom, top, left, right, and the two stubs, which reach through the outer walls.
    assert_eq!(rooms.rectangles().len(), 6);
}

#[test]
fn pixels_that_touch_in_a_point_keep_their_corners() {
    let rows = "# \n #";
    let segments = bitmap(rows).outline();
    assert_eq!(segments.len(), 8);
    assert_eq!(segments.iter().map(length).sum::<u32>(), 8);
    assert_eq!(bitmap(rows).rectangles().len(), 2);
}

#[test]
fn walls_that_meet_are_as_few_rectangles_as_walls() {
    let crossing = bitmap("  #  \n  #  \n#####\n  #  ");
    let rectangles = crossing.rectangles();
    assert_eq!(rectangles.len(), 2, "{rectangles:?}");
    assert_eq!((rectangles[0].min, rectangles[0].max), ([0, 1], [5, 2]));
    assert_eq!((rectangles[1].min, rectangles[1].max), ([2, 0], [3, 4]));
}

#[test]
fn the_blocked_part_of_a_picture() {
    assert_eq!(bitmap("    \n  # \n #  \n    ").blocked_bounds(), Some(([1, 1], [3, 3])));
    assert_eq!(bitmap("  \n  ").blocked_bounds(), None);
    assert!(bitmap("  \n  ").outline().is_empty() && bitmap("  \n  ").rectangles().is_empty());
}

#[test]
fn a_plan_lies_where_it_is_told() {
    let plan = FloorPlan {
        bitmap: bitmap(" #\n  ").into(),
        pixel_m: Vector2::new(0.5, 0.25),
        origin: pose(1.0, 2.0, std::f64::consts::FRAC_PI_2),
    };
    assert_eq!(plan.size_m(), Vector2::new(1.0, 0.5));
    let wall = plan.rectangles().next().unwrap();
    // The upper right pixel, a quarter turn about the lower left corner.
    let middle = Point2::from(wall.pose.translation.vector);
    assert!((middle - Point2::new(1.0 - 0.375, 2.0 + 0.75)).norm() < 1e-12, "{middle}");
    assert_eq!(wall.half_m, Vector2::new(0.25, 0.125));
    let ends: Vec<Point2<f64>> = plan.outline().flat_map(|segment| [segment.from, segment.to]).collect();
    for corner in wall.corners() {
        assert!(ends.iter().filter(|end| (corner - *end).norm() < 1e-12).count() == 2);
    }
}

fn length(segment: &PixelSegment) -> u32 {
    segment.from[0].abs_diff(segment.to[0]) + segment.from[1].abs_diff(segment.to[1])
}

fn any_bitmap() -> impl Strategy<Value = Bitmap> {
    (1_u32..14, 1_u32..14, 0.0..1.0).prop_flat_map(|(width, height, share)| {
        proptest::collection::vec(proptest::bool::weighted(share), (width * height) as usize)
            .prop_map(move |blocked| Bitmap::new(width, height, blocked).unwrap())
    })
}

proptest! {
    /// A ray from any pixel to the right leaves one wall more than it enters if it starts in one.
    #[test]
    fn the_outline_winds_once_around_what_is_blocked(bitmap in any_bitmap()) {
        let outline = bitmap.outline();
        for y in 0..bitmap.height() {
            for x in 0..bitmap.width() {
                let crossings = outline.iter().filter(|segment| {
                    let (low, high) = (segment.from[1].min(segment.to[1]), segment.from[1].max(segment.to[1]));
                    segment.from[0] == segment.to[0] && segment.from[0] > x && low <= y && high > y
                });
                let winding: i32 = crossings.map(|segment| if segment.to[1] > segment.from[1] { 1 } else { -1 }).sum();
                prop_assert_eq!(winding, i32::from(bitmap.is_blocked(x, y)));
            }
        }
    }

    /// All of the border, nothing else, and no straight line in two pieces.
    #[test]
    fn the_outline_is_as_long_as_the_border_and_in_as_few_pieces(bitmap in any_bitmap()) {
        let outline = bitmap.outline();
        prop_assert_eq!(outline.iter().map(length).sum::<u32>() as usize, bitmap.boundary_sides());
        let direction = |s: &PixelSegment| (s.to[0].cmp(&s.from[0]), s.to[1].cmp(&s.from[1]));
        for a in &outline {
            prop_assert!(length(a) > 0);
            let next: Vec<_> = outline.iter().filter(|b| b.from == a.to).collect();
            prop_assert!(!next.is_empty(), "the outline is closed");
            prop_assert!(next.iter().all(|b| direction(b) != direction(a)) , "{:?} goes on straight", a);
        }
    }

    #[test]
    fn rectangles_are_what_is_blocked_and_none_could_be_larger(bitmap in any_bitmap()) {
        let rectangles = bitmap.rectangles();
        let inside = |x: u32, y: u32| rectangles.iter().any(|r| {
            (r.min[0]..r.max[0]).contains(&x) && (r.min[1]..r.max[1]).contains(&y)
        });
        for y in 0..bitmap.height() {
            for x in 0..bitmap.width() {
                prop_assert_eq!(inside(x, y), bitmap.is_blocked(x, y));
            }
        }
        for r in &rectangles {
            let all = |mut xs: std::ops::Range<u32>, ys: std::ops::Range<u32>| {
                xs.all(|x| ys.clone().all(|y| bitmap.is_blocked(x, y)))
            };
            prop_assert!(!all(r.max[0]..r.max[0] + 1, r.min[1]..r.max[1]));
            prop_assert!(!all(r.min[0]..r.max[0], r.max[1]..r.max[1] + 1));
            prop_assert!(r.min[0] == 0 || !all(r.min[0] - 1..r.min[0], r.min[1]..r.max[1]));
            prop_assert!(r.min[1] == 0 || !all(r.min[0]..r.max[0], r.min[1] - 1..r.min[1]));
        }
    }

    /// On a plan of walls that are at least two pixels thick and keep two pixels apart, there is
    /// at most one segment per two pixels of the border.
    #[test]
    fn right_angled_plans_have_few_segments(coarse in any_bitmap()) {
        let (width, height) = (coarse.width() * 2, coarse.height() * 2);
        let pixels = (0..width * height).map(|i| coarse.is_blocked(i % width / 2, i / width / 2)).collect();
        let fine = Bitmap::new(width, height, pixels).unwrap();
        prop_assert_eq!(fine.outline().len(), coarse.outline().len());
        prop_assert!(fine.outline().len() * 2 <= fine.boundary_sides());
    }
}

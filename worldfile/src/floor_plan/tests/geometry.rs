//! Rectangles against what they stand for: the blocked pixels.

use crate::floor_plan::{Bitmap, FloorPlan, PixelRectangle};
use interfaces::pose;
use nalgebra::{Point2, Vector2};
use proptest::prelude::*;

fn bitmap(rows: &str) -> Bitmap {
    let rows: Vec<&[u8]> = rows.lines().map(str::as_bytes).collect();
    let width = rows.iter().map(|row| row.len()).max().unwrap_or(0);
    let blocked = rows.iter().rev().flat_map(|row| (0..width).map(|x| row.get(x) == Some(&b'#')));
    Bitmap::new(width as u32, rows.len() as u32, &blocked.collect::<Vec<_>>()).unwrap()
}

#[test]
fn there_are_as_few_rectangles_as_walls() {
    // Two rooms with a door between them: four outer walls and two stubs. Pixels that touch in a point. Nothing.
    let rooms = "#########\n#   #   #\n#       #\n#   #   #\n#########";
    for (plan, rectangles) in [(rooms, 6), ("# \n #", 2), ("  \n  ", 0)] {
        assert_eq!(bitmap(plan).rectangles().len(), rectangles, "{plan}");
    }
    let rectangle = |min, max| PixelRectangle { min, max };
    let crossing = bitmap("  #  \n  #  \n#####\n  #  ");
    assert_eq!(crossing.rectangles(), [rectangle([0, 1], [5, 2]), rectangle([2, 0], [3, 4])]);
    let bounds = bitmap("    \n  # \n #  \n    ").blocked_bounds();
    assert_eq!(bounds, Some(rectangle([1, 1], [3, 3])));
    assert_eq!(bitmap("  \n  ").blocked_bounds(), None);
}

#[test]
fn a_plan_lies_at_its_origin() {
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
}

fn any_pixels() -> impl Strategy<Value = (u32, Vec<bool>)> {
    (1_u32..14, 1_u32..14, 0.0..1.0).prop_flat_map(|(width, height, share)| {
        let pixels = proptest::collection::vec(proptest::bool::weighted(share), (width * height) as usize);
        (Just(width), pixels)
    })
}

proptest! {
    #[test]
    fn rectangles_are_what_is_blocked_and_none_could_be_larger((width, pixels) in any_pixels()) {
        let height = pixels.len() as u32 / width;
        let bitmap = Bitmap::new(width, height, &pixels).unwrap();
        let is_blocked = |x: u32, y: u32| x < width && y < height && pixels[(y * width + x) as usize];
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            prop_assert_eq!(bitmap.is_blocked(x, y), is_blocked(x, y));
        }
        for r in bitmap.rectangles() {
            let all = |mut xs: std::ops::Range<u32>, ys: std::ops::Range<u32>| {
                xs.all(|x| ys.clone().all(|y| is_blocked(x, y)))
            };
            prop_assert!(!all(r.max[0]..r.max[0] + 1, r.min[1]..r.max[1]));
            prop_assert!(!all(r.min[0]..r.max[0], r.max[1]..r.max[1] + 1));
            prop_assert!(r.min[0] == 0 || !all(r.min[0] - 1..r.min[0], r.min[1]..r.max[1]));
            prop_assert!(r.min[1] == 0 || !all(r.min[0]..r.max[0], r.min[1] - 1..r.min[1]));
        }
    }
}

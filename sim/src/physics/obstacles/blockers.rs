use crate::physics::form::Form;
use crate::physics::shape::Rectangle;
use nalgebra::Point2;

/// An obstacle may move to a pose if every other moving body is at least this far away, m: far enough that the
/// physics engine does not push the bodies apart.
const ROOM_M: f64 = 0.005;

/// The bodies that an obstacle must not hit. The obstacle waits instead, so that it does not crush anything.
#[derive(Default)]
pub(crate) struct Blockers {
    things: Vec<Thing>,
}

struct Thing {
    /// Center and radius of a circle around the body, m.
    center: Point2<f64>,
    radius_m: f64,
    form: Form,
}

impl Blockers {
    /// Adds a body that lies within `radius_m` of `center` (m).
    pub(crate) fn add(&mut self, center: Point2<f64>, radius_m: f64, form: Form) {
        self.things.push(Thing { center, radius_m, form });
    }

    /// Whether a rectangle can move from one pose to the other: a body that is near on the way or afterwards was at
    /// least as near before.
    pub(super) fn is_free(&self, from: &Rectangle, to: &Rectangle) -> bool {
        let (before, after) = (from.corners(), to.corners());
        let motions_m = before.iter().zip(&after).map(|(before, after)| (after - before).norm());
        let motion_m = motions_m.fold(0.0, f64::max);
        // Most bodies are far away: compares circles first.
        let center = Point2::from(to.pose.translation.vector);
        let reach_m = to.half_m.norm() + motion_m + ROOM_M;
        let is_near =
            |thing: &&Thing| (thing.center - center).norm_squared() <= (reach_m + thing.radius_m).powi(2);
        self.things.iter().filter(is_near).all(|thing| {
            let before_m = thing.form.gap_m(&before);
            let has_room = |gap_m: f64| gap_m >= ROOM_M || gap_m >= before_m;
            // As many poses as it takes not to skip a body between two of them.
            let poses = (motion_m / from.half_m.min().max(thing.form.inner_m())).ceil() as usize;
            let mut between = (1..poses).map(|pose| {
                let pose = from.pose.lerp_slerp(&to.pose, pose as f64 / poses as f64);
                thing.form.gap_m(&Rectangle { pose, ..*from }.corners())
            });
            has_room(thing.form.gap_m(&after)) && between.all(has_room)
        })
    }

    /// Whether a rectangle can appear.
    pub(super) fn has_room(&self, shape: &Rectangle) -> bool {
        let corners = shape.corners();
        self.things.iter().all(|thing| thing.form.gap_m(&corners) >= ROOM_M)
    }
}

use crate::Scene;
use interfaces::CellState;
use nalgebra::{Point2, Vector2};

/// Points nearer to each other than this are one obstacle, m.
const MERGE_M: f64 = 0.02;
/// The distance between two places where a predicted trajectory is checked, at most, m.
const CHECK_M: f64 = 0.04;
/// How many speeds are tried between the wish and standing still.
const LEVELS: u32 = 8;

/// How a robot stops, and how far it keeps from what it senses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Braking {
    pub(super) radius_m: f64,
    pub(super) margin_m: f64,
    /// For each m/s of speed this much margin more, s.
    pub(super) margin_s: f64,
    pub(super) reaction_s: f64,
    pub(super) deceleration_mps2: f64,
    /// What may move does so at most this fast, m/s.
    pub(super) others_mps: f64,
}

impl Braking {
    /// The time from the decision to stop at a speed until the robot stands, s.
    fn stop_s(&self, speed_mps: f64) -> f64 {
        self.reaction_s + speed_mps / self.deceleration_mps2
    }

    /// The way that it takes, m.
    fn stop_m(&self, speed_mps: f64) -> f64 {
        speed_mps * self.reaction_s + 0.5 * speed_mps * speed_mps / self.deceleration_mps2
    }

    /// When the robot that stops from a speed passes a place that far on, s.
    fn passes_at_s(&self, speed_mps: f64, way_m: f64) -> f64 {
        let rolling_m = speed_mps * self.reaction_s;
        if way_m <= rolling_m {
            return way_m / speed_mps;
        }
        let braking_m = way_m - rolling_m;
        let left = (speed_mps * speed_mps - 2.0 * self.deceleration_mps2 * braking_m).max(0.0);
        self.reaction_s + (speed_mps - left.sqrt()) / self.deceleration_mps2
    }
}

/// Something that the robot must not touch, in its own frame, m.
#[derive(Clone, Copy, Debug)]
struct Obstacle {
    at: Vector2<f64>,
    away_m: f64,
    restless: bool,
}

/// Predicts whether the robot could still stop in time. A speed is safe if the robot, holding it
/// until it can react and then braking along the same arc, keeps its distance from all that it
/// senses and from all blocked cells, even if what may move comes straight at it. What is already
/// too near may only be moved away from.
#[derive(Clone, Debug, Default)]
pub(super) struct Guard {
    near: Vec<Obstacle>,
}

impl Guard {
    /// Gathers the obstacles that matter up to `speed_mps`.
    pub(super) fn look(&mut self, braking: &Braking, scene: &Scene, speed_mps: f64) {
        let reach_m = braking.radius_m
            + braking.margin_m
            + braking.margin_s * speed_mps
            + braking.stop_m(speed_mps)
            + braking.others_mps * braking.stop_s(speed_mps);
        self.near.clear();
        let robot = scene.situation.position();
        for point in scene.situation.points {
            if (point - robot).norm_squared() < reach_m * reach_m {
                self.add(scene, point);
            }
        }
        let frame = scene.situation.map.frame();
        let corner = Vector2::repeat(reach_m);
        let (first, last) = (frame.cell_at(&(robot - corner)), frame.cell_at(&(robot + corner)));
        for y in first.y.max(0)..=last.y.min(frame.height() as i32 - 1) {
            for x in first.x.max(0)..=last.x.min(frame.width() as i32 - 1) {
                let cell = interfaces::Cell::new(x, y);
                if scene.situation.map.get(cell) == Some(&CellState::Blocked) {
                    let center = frame.center(cell);
                    if (center - robot).norm_squared() < reach_m * reach_m {
                        self.add(scene, &center);
                    }
                }
            }
        }
    }

    fn add(&mut self, scene: &Scene, point: &Point2<f64>) {
        let at = scene.situation.pose.inverse_transform_point(point).coords;
        if self.near.last().is_some_and(|last| (last.at - at).norm_squared() < MERGE_M * MERGE_M) {
            return;
        }
        let restless = scene.restless.is_restless(scene.situation, point);
        self.near.push(Obstacle { at, away_m: at.norm(), restless });
    }

    /// The highest safe speed up to `wish_mps` (negative backwards) on the arc of a curvature.
    pub(super) fn safe_speed_mps(&self, braking: &Braking, wish_mps: f64, curvature_radpm: f64) -> f64 {
        let levels = (1..=LEVELS).rev().map(|level| wish_mps * f64::from(level) / f64::from(LEVELS));
        levels.into_iter().find(|speed| self.is_safe(braking, *speed, curvature_radpm)).unwrap_or(0.0)
    }

    fn is_safe(&self, braking: &Braking, velocity_mps: f64, curvature_radpm: f64) -> bool {
        let speed_mps = velocity_mps.abs();
        let keep_m = braking.radius_m + braking.margin_m + braking.margin_s * speed_mps;
        let stop_m = braking.stop_m(speed_mps);
        let checks = (stop_m / CHECK_M).ceil().max(1.0);
        (1..=checks as u32).all(|check| {
            let way_m = stop_m * f64::from(check) / checks;
            let at = along_arc(way_m.copysign(velocity_mps), curvature_radpm);
            let moves_m = braking.others_mps * braking.passes_at_s(speed_mps, way_m);
            self.near.iter().all(|obstacle| {
                let keep_m = if obstacle.restless { keep_m + moves_m } else { keep_m };
                let away_square = (obstacle.at - at).norm_squared();
                away_square >= keep_m * keep_m || away_square >= obstacle.away_m * obstacle.away_m
            })
        })
    }
}

/// Where an arc that starts forwards at the origin has led after `way_m`.
fn along_arc(way_m: f64, curvature_radpm: f64) -> Vector2<f64> {
    let turn_rad = way_m * curvature_radpm;
    if turn_rad.abs() < 1e-6 {
        return Vector2::new(way_m, 0.5 * way_m * turn_rad);
    }
    let (sin, cos) = libm::sincos(turn_rad);
    Vector2::new(sin / curvature_radpm, (1.0 - cos) / curvature_radpm)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BRAKING: Braking = Braking {
        radius_m: 0.2,
        margin_m: 0.02,
        margin_s: 0.0,
        reaction_s: 0.2,
        deceleration_mps2: 1.0,
        others_mps: 0.3,
    };

    fn guard(x: f64, y: f64, restless: bool) -> Guard {
        let at = Vector2::new(x, y);
        Guard { near: vec![Obstacle { at, away_m: at.norm(), restless }] }
    }

    #[test]
    fn a_safe_speed_leaves_room_to_stop() {
        for distance_cm in 22..80 {
            let ahead_m = f64::from(distance_cm) / 100.0;
            let speed = guard(ahead_m, 0.0, false).safe_speed_mps(&BRAKING, 0.5, 0.0);
            assert!(BRAKING.stop_m(speed) <= (ahead_m - 0.22).max(0.0) + 1e-12);
            assert!(speed == 0.5 || BRAKING.stop_m(speed + 0.5 / 8.0) > ahead_m - 0.22 - 1e-9);
        }
    }

    #[test]
    fn what_comes_closer_needs_more_room() {
        let ahead_m = 0.22 + BRAKING.stop_m(0.5) + 0.01;
        assert_eq!(guard(ahead_m, 0.0, false).safe_speed_mps(&BRAKING, 0.5, 0.0), 0.5);
        assert!(guard(ahead_m, 0.0, true).safe_speed_mps(&BRAKING, 0.5, 0.0) < 0.5);
        let ahead_m = ahead_m + 0.3 * BRAKING.stop_s(0.5);
        assert_eq!(guard(ahead_m, 0.0, true).safe_speed_mps(&BRAKING, 0.5, 0.0), 0.5);
    }

    #[test]
    fn beside_and_behind_do_not_stop_but_a_turn_towards_does() {
        assert_eq!(guard(0.1, 0.23, false).safe_speed_mps(&BRAKING, 0.5, 0.0), 0.5);
        assert_eq!(guard(-0.21, 0.0, false).safe_speed_mps(&BRAKING, 0.5, 0.0), 0.5);
        assert_eq!(guard(-0.21, 0.0, false).safe_speed_mps(&BRAKING, -0.5, 0.0), 0.0);
        assert!(guard(0.1, 0.23, false).safe_speed_mps(&BRAKING, 0.5, 3.0) < 0.3);
    }

    #[test]
    fn arcs_close_to_straight_ones_are_straight() {
        assert!((along_arc(0.5, 1e-5) - along_arc(0.5, 1e-7)).norm() < 1e-5);
        let quarter = along_arc(std::f64::consts::FRAC_PI_2, 1.0);
        assert!((quarter - Vector2::new(1.0, 1.0)).norm() < 1e-12);
        let back = along_arc(-std::f64::consts::FRAC_PI_2, 1.0);
        assert!((back - Vector2::new(-1.0, 1.0)).norm() < 1e-12);
    }
}

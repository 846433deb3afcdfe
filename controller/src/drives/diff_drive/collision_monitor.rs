use super::DiffDriveSettings;
use crate::drives::DriveScene;
use interfaces::{Cell, CellState};
use nalgebra::{Point2, Vector2};

/// The minimum distance to sensed obstacles, m: less than the footprint padding, so that the robot can follow paths along walls.
const CLEARANCE_M: f64 = 0.015;
/// The additional clearance per m/s of speed, s.
const CLEARANCE_S: f64 = 0.05;
/// The maximum speed of dynamic obstacles, m/s. With 0.3 m/s, doors and robots reached a robot that was still braking
/// six times in five runs of 20 minutes; with 0.5 m/s once.
const MAX_OBSTACLE_MPS: f64 = 0.5;
/// Points nearer to each other than this are one obstacle, m.
const MERGE_M: f64 = 0.02;
/// The largest distance between two checked points of a predicted trajectory, m.
const CHECK_M: f64 = 0.04;
/// The number of speeds that are tried between the wanted speed and 0.
const LEVELS: u32 = 8;

impl DiffDriveSettings {
    /// The minimum distance from the center of the robot to obstacles, m.
    fn keep_m(&self, speed_mps: f64) -> f64 {
        self.radius_m + CLEARANCE_M + CLEARANCE_S * speed_mps
    }

    /// The time from the decision to stop until the robot stands, s.
    fn stop_s(&self, speed_mps: f64) -> f64 {
        self.reaction_s + speed_mps / self.acceleration_mps2
    }

    /// The stopping distance, m.
    fn stop_m(&self, speed_mps: f64) -> f64 {
        speed_mps * self.reaction_s + 0.5 * speed_mps * speed_mps / self.acceleration_mps2
    }

    /// The time after which the stopping robot passes the point at a distance, s.
    fn passes_at_s(&self, speed_mps: f64, distance_m: f64) -> f64 {
        let rolling_m = speed_mps * self.reaction_s;
        if distance_m <= rolling_m {
            return distance_m / speed_mps;
        }
        let braking_m = distance_m - rolling_m;
        let left = (speed_mps * speed_mps - 2.0 * self.acceleration_mps2 * braking_m).max(0.0);
        self.reaction_s + (speed_mps - left.sqrt()) / self.acceleration_mps2
    }
}

/// An obstacle in the frame of the robot, m.
#[derive(Clone, Copy, Debug)]
struct Obstacle {
    at: Vector2<f64>,
    distance_m: f64,
    is_dynamic: bool,
}

/// Predicts whether the robot can still stop in time. The robot holds a speed until it can react, and then brakes
/// along the same arc. The speed is safe if the robot thereby keeps its distance from all sensed points and all
/// blocked cells, even if dynamic obstacles move straight toward it. If an obstacle is already too near, the robot
/// may only move away from it.
#[derive(Clone, Debug, Default)]
pub(super) struct CollisionMonitor {
    obstacles: Vec<Obstacle>,
}

impl CollisionMonitor {
    /// Collects the obstacles that matter at speeds up to `speed_mps`.
    pub(super) fn update(&mut self, settings: &DiffDriveSettings, scene: &DriveScene, speed_mps: f64) {
        let reach_m = settings.keep_m(speed_mps)
            + settings.stop_m(speed_mps)
            + MAX_OBSTACLE_MPS * settings.stop_s(speed_mps);
        self.obstacles.clear();
        let robot = scene.input.position();
        let (map, corner) = (scene.input.map, Vector2::repeat(reach_m));
        let (first, last) = (map.frame().cell_at(&(robot - corner)), map.frame().cell_at(&(robot + corner)));
        let around = (first.y..=last.y).flat_map(|y| (first.x..=last.x).map(move |x| Cell::new(x, y)));
        let blocked = around.filter(|cell| map.get(*cell) == Some(&CellState::Blocked));
        let centers = blocked.map(|cell| map.frame().center(cell));
        for point in scene.input.points.iter().copied().chain(centers) {
            if (point - robot).norm_squared() < reach_m * reach_m {
                self.add(scene, &point);
            }
        }
    }

    fn add(&mut self, scene: &DriveScene, point: &Point2<f64>) {
        let at = scene.input.pose.inverse_transform_point(point).coords;
        if self.obstacles.last().is_some_and(|last| (last.at - at).norm_squared() < MERGE_M * MERGE_M) {
            return;
        }
        let is_dynamic = scene.dynamic.is_dynamic(scene.input, point);
        self.obstacles.push(Obstacle { at, distance_m: at.norm(), is_dynamic });
    }

    /// The highest safe speed up to `wish_mps` (negative: backward) on an arc with a curvature.
    pub(super) fn safe_speed_mps(
        &self,
        settings: &DiffDriveSettings,
        wish_mps: f64,
        curvature_radpm: f64,
    ) -> f64 {
        let mut levels = (1..=LEVELS).rev().map(|level| wish_mps * f64::from(level) / f64::from(LEVELS));
        levels.find(|speed| self.is_safe(settings, *speed, curvature_radpm)).unwrap_or(0.0)
    }

    fn is_safe(&self, settings: &DiffDriveSettings, velocity_mps: f64, curvature_radpm: f64) -> bool {
        let speed_mps = velocity_mps.abs();
        let keep_m = settings.keep_m(speed_mps);
        let stop_m = settings.stop_m(speed_mps);
        let checks = (stop_m / CHECK_M).ceil().max(1.0);
        (1..=checks as u32).all(|check| {
            let distance_m = stop_m * f64::from(check) / checks;
            let at = along_arc(distance_m.copysign(velocity_mps), curvature_radpm);
            let moves_m = MAX_OBSTACLE_MPS * settings.passes_at_s(speed_mps, distance_m);
            self.obstacles.iter().all(|obstacle| {
                let keep_m = if obstacle.is_dynamic { keep_m + moves_m } else { keep_m };
                let square = (obstacle.at - at).norm_squared();
                square >= keep_m * keep_m || square >= obstacle.distance_m * obstacle.distance_m
            })
        })
    }
}

/// The point at `distance_m` along an arc that starts at the origin, in the direction x.
fn along_arc(distance_m: f64, curvature_radpm: f64) -> Vector2<f64> {
    let turn_rad = distance_m * curvature_radpm;
    if turn_rad.abs() < 1e-6 {
        return Vector2::new(distance_m, 0.5 * distance_m * turn_rad);
    }
    let (sin, cos) = libm::sincos(turn_rad);
    Vector2::new(sin / curvature_radpm, (1.0 - cos) / curvature_radpm)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn braking() -> DiffDriveSettings {
        DiffDriveSettings {
            radius_m: 0.2,
            reaction_s: 0.2,
            acceleration_mps2: 1.0,
            ..DiffDriveSettings::default()
        }
    }

    fn monitor(x: f64, y: f64, is_dynamic: bool) -> CollisionMonitor {
        let at = Vector2::new(x, y);
        CollisionMonitor { obstacles: vec![Obstacle { at, distance_m: at.norm(), is_dynamic }] }
    }

    #[test]
    fn a_safe_speed_leaves_room_to_stop() {
        for distance_cm in 22..80 {
            let ahead_m = f64::from(distance_cm) / 100.0;
            let speed = monitor(ahead_m, 0.0, false).safe_speed_mps(&braking(), 0.5, 0.0);
            let room_m = |speed: f64| ahead_m - braking().keep_m(speed);
            assert!(braking().stop_m(speed) <= room_m(speed).max(0.0) + 1e-12);
            let faster = speed + 0.5 / 8.0;
            assert!(speed == 0.5 || braking().stop_m(faster) > room_m(faster) - 1e-9);
        }
    }

    #[test]
    fn dynamic_obstacles_need_more_room() {
        let ahead_m = braking().keep_m(0.5) + braking().stop_m(0.5) + 0.01;
        assert_eq!(monitor(ahead_m, 0.0, false).safe_speed_mps(&braking(), 0.5, 0.0), 0.5);
        assert!(monitor(ahead_m, 0.0, true).safe_speed_mps(&braking(), 0.5, 0.0) < 0.5);
        let ahead_m = ahead_m + MAX_OBSTACLE_MPS * braking().stop_s(0.5);
        assert_eq!(monitor(ahead_m, 0.0, true).safe_speed_mps(&braking(), 0.5, 0.0), 0.5);
    }

    #[test]
    fn beside_and_behind_do_not_stop_but_a_turn_towards_does() {
        assert_eq!(monitor(0.1, 0.25, false).safe_speed_mps(&braking(), 0.5, 0.0), 0.5);
        assert_eq!(monitor(-0.21, 0.0, false).safe_speed_mps(&braking(), 0.5, 0.0), 0.5);
        assert_eq!(monitor(-0.21, 0.0, false).safe_speed_mps(&braking(), -0.5, 0.0), 0.0);
        assert!(monitor(0.1, 0.23, false).safe_speed_mps(&braking(), 0.5, 3.0) < 0.3);
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

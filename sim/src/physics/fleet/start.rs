//! A fleet at its start: what is the same for every seed, built once and shared.

use super::Fleet;
use super::rooms::Rooms;
use super::slide::Sliding;
use crate::physics::bodies::Bodies;
use crate::physics::free_poses::FreePoses;
use crate::physics::obstacles::Obstacle;
use crate::physics::past::Past;
use crate::physics::rays::{Disc, Scene};
use crate::physics::report::Body;
use crate::physics::robot::SimulatedRobot;
use crate::physics::sensors::SharedBeams;
use crate::physics::shape::grid_corners;
use crate::physics::spec::{FleetSpec, RobotSpec};
use nalgebra::{Isometry2, Point2};
use std::sync::Arc;

/// Everything at the start that does not depend on the seed.
pub(super) struct Start {
    pub(super) spec: FleetSpec,
    bodies: Bodies,
    /// With random streams that every fleet replaces by its own.
    obstacles: Vec<Obstacle>,
    scene: Scene,
    beams: SharedBeams,
    /// The rooms whose doors wait for robots.
    pub(super) rooms: Rooms,
    /// Where each robot that is carried away can be set down.
    pub(super) carried: Vec<Option<FreePoses>>,
    /// The robots that have corners.
    cornered: Vec<usize>,
}

impl Start {
    pub(super) fn new(spec: &FleetSpec) -> Self {
        let mut bodies = Bodies::new(spec);
        for (index, wall) in spec.walls.iter().enumerate() {
            bodies.add_box(Body::Wall(index), wall);
        }
        for robot in &spec.robots {
            bodies.add_robot(robot, spec.step_s);
        }
        let poses: Vec<_> = (0..spec.robots.len()).map(|index| bodies.pose(index)).collect();
        let obstacles = spec.obstacles.iter().enumerate();
        let obstacles =
            obstacles.map(|(index, obstacle)| Obstacle::new(obstacle, index, spec.starts_s, &mut bodies));
        let obstacles: Vec<Obstacle> = obstacles.collect();
        // A robot with corners is a disc of radius 0, and a polygon after those of the obstacles.
        let discs = spec.robots.iter().zip(&poses).map(|(robot, pose)| Disc {
            center: pose.translation.vector.into(),
            radius_m: if robot.corners.is_empty() { robot.radius_m } else { 0.0 },
        });
        let cornered = spec.robots.iter().enumerate().filter(|(_, robot)| !robot.corners.is_empty());
        let cornered: Vec<usize> = cornered.map(|(index, _)| index).collect();
        let range_m = spec.robots.iter().map(RobotSpec::range_m).fold(0.0, f64::max);
        let polygons = spec.obstacles.len() + cornered.len();
        let mut scene =
            Scene::new(grid_corners(&spec.frame), &spec.walls, discs.collect(), polygons, range_m);
        obstacles.iter().enumerate().for_each(|(index, obstacle)| show_obstacle(&mut scene, index, obstacle));
        let carried = spec.robots.iter().enumerate().map(|(index, robot)| {
            robot.odometry.carried?;
            FreePoses::reachable(spec, index)
        });
        let mut start = Self {
            spec: spec.clone(),
            bodies,
            obstacles,
            scene,
            beams: SharedBeams::default(),
            rooms: Rooms::new(spec),
            carried: carried.collect(),
            cornered,
        };
        let mut scene = start.scene.clone();
        poses.iter().enumerate().for_each(|(index, pose)| start.show_robot(&mut scene, index, pose));
        start.scene = scene;
        // Robots with the same sensors share beams, which are computed here and in no fleet.
        let mut beams = SharedBeams::default();
        start.robots(0, &mut beams);
        start.beams = beams;
        start
    }

    fn robots(&self, seed: u64, beams: &mut SharedBeams) -> Vec<SimulatedRobot> {
        let robots = self.spec.robots.iter().enumerate();
        let robots = robots.map(|(index, robot)| {
            SimulatedRobot::new(robot, index, self.bodies.pose(index), self.spec.step_s, seed, beams)
        });
        robots.collect()
    }

    /// Updates a robot in a scene that lasers see.
    pub(super) fn show_robot(&self, scene: &mut Scene, index: usize, pose: &Isometry2<f64>) {
        scene.move_disc(index, pose.translation.vector.into());
        if let Ok(polygon) = self.cornered.binary_search(&index) {
            let corners = self.spec.robots[index].corners.iter().map(|corner| pose * corner);
            scene.set_polygon(self.obstacles.len() + polygon, Some(index), corners);
        }
    }
}

/// Updates an obstacle in a scene that lasers see.
pub(super) fn show_obstacle(scene: &mut Scene, index: usize, obstacle: &Obstacle) {
    let corners = obstacle.shape.corners();
    let corners: &[Point2<f64>] = if obstacle.is_standing() { &corners } else { &[] };
    scene.set_polygon(index, None, corners.iter().copied());
}

impl Fleet {
    /// The fleet at its start, with the random streams of a seed.
    pub(super) fn begin(start: Arc<Start>, seed: u64) -> Self {
        let obstacles = start.obstacles.iter().enumerate();
        Self {
            seed,
            step: 0,
            bodies: start.bodies.clone(),
            robots: start.robots(seed, &mut start.beams.clone()),
            obstacles: obstacles
                .map(|(index, obstacle)| obstacle.reseeded(index, start.spec.starts_s, seed))
                .collect(),
            scene: start.scene.clone(),
            past: Past::new(&start.spec),
            contacts: Vec::new(),
            moved: Vec::new(),
            before: Vec::new(),
            sliding: Sliding::default(),
            parallel_lasers: false,
            start,
        }
    }
}

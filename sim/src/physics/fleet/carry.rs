//! Robots that are carried away and set down elsewhere.

use super::Fleet;
use crate::physics::free_space::FreeSpace;
use crate::physics::spec::FleetSpec;
use interfaces::heading_rad;
use nalgebra::{Isometry2, Point2};

/// The number of poses that are tried for a robot.
const ATTEMPTS: usize = 100;

/// Where robots can be set down.
pub(super) struct Carrying {
    /// For each robot the free space and the region of it in which the robot starts; `None`: it is never carried.
    places: Vec<Option<(FreeSpace, Option<usize>)>>,
}

impl Carrying {
    pub(super) fn new(spec: &FleetSpec) -> Self {
        let places = spec.robots.iter().map(|robot| {
            robot.odometry.carried?;
            let space = FreeSpace::new(spec, robot.radius_m);
            let region = space.region_near(&robot.pose.translation.vector.into(), robot.radius_m);
            Some((space, region))
        });
        Self { places: places.collect() }
    }

    /// Whether a robot can drive to a point (m) from its start, with doors open.
    fn reaches(&self, robot: usize, at: &Point2<f64>) -> bool {
        let Some((space, Some(region))) = &self.places[robot] else { return false };
        space.region_at(at) == Some(*region)
    }
}

impl Fleet {
    /// Carries away the robots for which it is time.
    pub(super) fn carry_robots(&mut self) {
        let time_s = self.time_s();
        for index in 0..self.robots.len() {
            let robot = &mut self.robots[index];
            let Some(mut carried) = robot.carried.take_if(|carried| carried.is_due(time_s)) else { continue };
            let (from, heading_rad) = (robot.at(), heading_rad(&robot.pose));
            let mut poses = (0..ATTEMPTS).map(|_| {
                let (at, heading_rad) = carried.draw(&from, heading_rad);
                interfaces::pose(at.x, at.y, heading_rad)
            });
            let is_good = |pose: &Isometry2<f64>| {
                self.start.carrying.reaches(index, &pose.translation.vector.into())
                    && self.check_fit(index, pose).is_ok()
            };
            if let Some(pose) = poses.find(is_good) {
                self.bodies.put(index, &pose);
                self.robots[index].carry(self.bodies.pose(index));
                self.show_robot(index);
            }
            self.robots[index].carried = Some(carried);
        }
    }
}

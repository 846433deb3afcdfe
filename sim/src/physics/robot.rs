use super::bodies::Bodies;
use super::chance::{Gaussian, Purpose};
use super::drive::Drive;
use super::laser::Laser;
use super::odometry::Odometry;
use super::patrol::WallPatrol;
use super::rays::Scene;
use super::report::Sweep;
use super::spec::{Behaviour, RobotSpec};
use geometry::{LaserReading, Twist};
use nalgebra::{Isometry2, Point2};

/// A robot at work: laser, mind, motors, odometry. Its body is rapier's.
pub(super) struct Robot {
    pub(super) spec: RobotSpec,
    /// Its place among the robots.
    index: usize,
    /// Where it truly is.
    pub(super) pose: Isometry2<f64>,
    pub(super) velocity: Twist,
    /// What it was last told to do.
    wanted: Twist,
    drive: Drive,
    odometry: Odometry,
    laser: Laser,
    patrol: Option<WallPatrol>,
    pub(super) sweep: Option<Sweep>,
}

impl Robot {
    pub(super) fn new(spec: &RobotSpec, index: usize, pose: Isometry2<f64>, step_s: f64, seed: u64) -> Self {
        let laser = Laser::new(&spec.laser, Gaussian::new(seed, Purpose::Laser, index));
        let patrol = match spec.behaviour {
            Behaviour::Driven => None,
            Behaviour::WallPatrol(way) => Some(WallPatrol::new(way, spec, step_s, laser.directions())),
        };
        Self {
            index,
            pose,
            velocity: Twist::STOP,
            wanted: Twist::STOP,
            drive: Drive::new(spec.drive),
            odometry: Odometry::new(spec.odometry, Gaussian::new(seed, Purpose::Odometry, index), pose),
            laser,
            patrol,
            sweep: None,
            spec: spec.clone(),
        }
    }

    /// Its middle, m.
    pub(super) fn at(&self) -> Point2<f64> {
        self.pose.translation.vector.into()
    }

    /// Whether it moves by itself, rather than being pushed.
    pub(super) fn is_moving(&self) -> bool {
        self.velocity != Twist::STOP
    }

    /// Tells it what to do.
    pub(super) fn command(&mut self, wanted: &Twist) {
        self.wanted = *wanted;
    }

    /// Looks around at `time_s`, unless it has done so already at that time.
    pub(super) fn look(&mut self, time_s: f64, scene: &Scene) -> &LaserReading {
        let laser_pose = self.pose * self.spec.laser.mount;
        let sweep = self.sweep.get_or_insert_with(|| Sweep {
            reading: LaserReading {
                // Before any time, so that the first look is a new one.
                time_s: f64::NEG_INFINITY,
                pose: self.pose,
                twist: Twist::STOP,
                mount: self.spec.laser.mount,
                scan: self.spec.laser.empty_scan(),
            },
            laser_pose,
        });
        if sweep.reading.time_s != time_s {
            sweep.laser_pose = laser_pose;
            sweep.reading.time_s = time_s;
            sweep.reading.pose = *self.odometry.pose();
            sweep.reading.twist = self.odometry.twist(&self.velocity);
            self.laser.scan(&laser_pose, scene, self.index, &mut sweep.reading.scan);
        }
        &sweep.reading
    }

    /// Lets a robot with a mind of its own look and decide, where its next scan is due.
    pub(super) fn think(&mut self, step: u64, time_s: f64, scene: &Scene) {
        if self.patrol.is_none() || !step.is_multiple_of(self.spec.laser.period_steps) {
            return;
        }
        self.look(time_s, scene);
        if let (Some(patrol), Some(sweep)) = (&mut self.patrol, &self.sweep) {
            self.wanted = patrol.decide(&sweep.reading);
        }
    }

    /// Sets its wheels in motion for the next step.
    pub(super) fn push(&mut self, bodies: &mut Bodies, step_s: f64) {
        self.velocity = self.drive.step(&self.wanted, step_s);
        bodies.set_velocity(self.index, &self.velocity, step_s);
    }

    /// Takes over where the step brought it. Returns where it was, m.
    pub(super) fn follow(&mut self, bodies: &Bodies) -> Point2<f64> {
        let before = std::mem::replace(&mut self.pose, bodies.pose(self.index));
        self.velocity = self.drive.settle(&bodies.velocity(self.index));
        self.odometry.feel(&before, &self.pose);
        before.translation.vector.into()
    }
}

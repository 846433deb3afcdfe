use super::bodies::Bodies;
use super::chance::{Gaussian, Purpose, Uniform};
use super::drive::Drive;
use super::laser::Laser;
use super::minds::Mind;
use super::odometry::Odometry;
use super::rays::{Beams, Scene, Scratch};
use super::report::{Body, Sweep};
use super::snapshot::{Played, Tape};
use super::spec::RobotSpec;
use geometry::{LaserReading, Twist};
use nalgebra::{Isometry2, Point2};
use std::sync::Arc;

/// A robot at work: laser, mind, motors, odometry. Its body is rapier's.
#[derive(Clone)]
pub(super) struct Robot {
    pub(super) spec: RobotSpec,
    /// Its place among the robots.
    index: usize,
    /// Where it truly is.
    pub(super) pose: Isometry2<f64>,
    /// Where its middle was before the last step, m.
    pub(super) was_at: Point2<f64>,
    pub(super) velocity: Twist,
    /// Whether it drove by itself in the last step.
    pub(super) drove: bool,
    /// What it touches now.
    pub(super) touching: Vec<Body>,
    /// What it was last told to do.
    wanted: Twist,
    pub(super) drive: Drive,
    odometry: Odometry,
    laser: Laser,
    mind: Mind,
    pub(super) sweep: Option<Sweep>,
}

impl Robot {
    /// A robot in place `index` of the file, at `pose`. `beams` are its laser's.
    pub(super) fn new(
        spec: &RobotSpec,
        index: usize,
        pose: Isometry2<f64>,
        step_s: f64,
        seed: u64,
        beams: Arc<Beams>,
    ) -> Self {
        let gaussian = |purpose| Gaussian::new(seed, purpose, index);
        Self {
            index,
            pose,
            was_at: pose.translation.vector.into(),
            velocity: Twist::STOP,
            drove: false,
            touching: Vec::new(),
            wanted: Twist::STOP,
            drive: Drive::new(spec.drive),
            odometry: Odometry::new(spec.odometry, gaussian(Purpose::Odometry), pose),
            mind: Mind::new(spec, step_s, &beams, Uniform::new(seed, Purpose::Behaviour, index)),
            laser: Laser::new(&spec.laser, beams, gaussian(Purpose::Laser)),
            sweep: None,
            spec: spec.clone(),
        }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        tape.pose(&mut self.pose)?;
        tape.point(&mut self.was_at)?;
        tape.twist(&mut self.velocity)?;
        tape.bool(&mut self.drove)?;
        tape.list(&mut self.touching, Body::Wall(0), Tape::body)?;
        tape.twist(&mut self.wanted)?;
        self.drive.play(tape)?;
        self.odometry.play(tape)?;
        self.laser.play(tape)?;
        self.mind.play(tape)?;
        let unseen = || unseen(&self.spec, self.pose);
        tape.option(&mut self.sweep, unseen, Tape::sweep)
    }

    /// Its middle, m.
    pub(super) fn at(&self) -> Point2<f64> {
        self.pose.translation.vector.into()
    }

    /// Whether it obeys commands.
    pub(super) fn is_driven(&self) -> bool {
        matches!(self.mind, Mind::Driven)
    }

    /// Whether its next scan is due at a step.
    pub(super) fn is_due(&self, step: u64) -> bool {
        step.is_multiple_of(self.spec.laser.period_steps)
    }

    /// Tells it what to do.
    pub(super) fn command(&mut self, wanted: &Twist) {
        self.wanted = *wanted;
    }

    /// It has been set down at `pose`, at rest, and knows where it is.
    pub(super) fn put(&mut self, pose: Isometry2<f64>) {
        self.pose = pose;
        self.was_at = self.at();
        self.velocity = Twist::STOP;
        self.wanted = Twist::STOP;
        self.drive = Drive::new(self.spec.drive);
        self.odometry.restart(pose);
        self.touching.clear();
        self.sweep = None;
    }

    /// Looks around at `time_s`, unless it has done so already at that time.
    pub(super) fn look(&mut self, time_s: f64, scene: &Scene, scratch: &mut Scratch) -> &LaserReading {
        let laser_pose = self.pose * self.spec.laser.mount;
        let sweep = self.sweep.get_or_insert_with(|| unseen(&self.spec, self.pose));
        if sweep.reading.time_s != time_s {
            sweep.laser_pose = laser_pose;
            sweep.reading.time_s = time_s;
            sweep.reading.pose = *self.odometry.pose();
            sweep.reading.twist = self.odometry.twist(&self.velocity);
            self.laser.scan(&laser_pose, scene, self.index, scratch, &mut sweep.reading.scan);
        }
        &sweep.reading
    }

    /// Looks around and, with a mind of its own, decides what to do.
    pub(super) fn think(&mut self, time_s: f64, scene: &Scene, scratch: &mut Scratch) {
        self.look(time_s, scene, scratch);
        if let Some(sweep) = &self.sweep
            && let Some(wanted) = self.mind.decide(&sweep.reading)
        {
            self.wanted = wanted;
        }
    }

    /// Sets its wheels in motion for the next step.
    pub(super) fn push(&mut self, bodies: &mut Bodies, step_s: f64) {
        self.velocity = self.drive.step(&self.wanted, step_s);
        self.drove = self.velocity != Twist::STOP;
        bodies.set_velocity(self.index, &self.velocity, step_s);
    }

    /// Takes over where the step brought it.
    pub(super) fn follow(&mut self, bodies: &Bodies) {
        let before = std::mem::replace(&mut self.pose, bodies.pose(self.index));
        self.velocity = self.drive.settle(&bodies.velocity(self.index));
        self.odometry.feel(&before, &self.pose);
        self.was_at = before.translation.vector.into();
    }
}

/// What a robot has seen before its first look.
fn unseen(spec: &RobotSpec, pose: Isometry2<f64>) -> Sweep {
    let mount = spec.laser.mount;
    // Before any time, so that the first look is a new one.
    let (time_s, twist, scan) = (f64::NEG_INFINITY, Twist::STOP, spec.laser.empty_scan());
    Sweep { reading: LaserReading { time_s, pose, twist, mount, scan }, laser_pose: pose * mount }
}

use super::chance::{Gaussian, Purpose, Uniform};
use super::laser::Laser;
use super::rays::{Beams, Scene, Scratch};
use super::report::Sweep;
use super::snapshot::{Played, Tape};
use super::spec::LaserSpec;
use interfaces::{LaserReading, Twist};
use nalgebra::Isometry2;
use std::sync::Arc;

/// A laser on a robot, and what it saw last.
#[derive(Clone)]
pub(super) struct Eye {
    spec: LaserSpec,
    laser: Laser,
    pub(super) sweep: Option<Sweep>,
}

/// What a robot knows of itself when it looks.
pub(super) struct Stance {
    pub(super) time_s: f64,
    /// Where it truly is.
    pub(super) pose: Isometry2<f64>,
    /// Where it believes to be, and how it believes to move.
    pub(super) felt_pose: Isometry2<f64>,
    pub(super) felt_twist: Twist,
    /// Its place among the robots.
    pub(super) robot: usize,
}

impl Eye {
    /// Laser `which` of the robot in place `robot`; `beams` are its own.
    pub(super) fn new(spec: &LaserSpec, beams: Arc<Beams>, seed: u64, robot: usize, which: usize) -> Self {
        // Each laser has streams of its own; that of the first is the robot's.
        let place = robot + (which << 24);
        let noise = Gaussian::new(seed, Purpose::Laser, place);
        let dropout = Uniform::new(seed, Purpose::Dropout, place);
        Self { spec: *spec, laser: Laser::new(spec, beams, noise, dropout), sweep: None }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        self.laser.play(tape)?;
        let spec = self.spec;
        tape.option(&mut self.sweep, || unseen(&spec), Tape::sweep)
    }

    /// Whether its next scan is due at a step.
    pub(super) fn is_due(&self, step: u64) -> bool {
        step.is_multiple_of(self.spec.period_steps)
    }

    /// Looks around, unless it has done so already at that time.
    pub(super) fn look(&mut self, stance: &Stance, scene: &Scene, scratch: &mut Scratch) -> &LaserReading {
        let sweep = self.sweep.get_or_insert_with(|| unseen(&self.spec));
        if sweep.reading.time_s != stance.time_s {
            sweep.laser_pose = stance.pose * self.spec.mount;
            sweep.reading.time_s = stance.time_s;
            sweep.reading.pose = stance.felt_pose;
            sweep.reading.twist = stance.felt_twist;
            self.laser.scan(&sweep.laser_pose, scene, stance.robot, scratch, &mut sweep.reading.scan);
        }
        &sweep.reading
    }
}

/// What a laser has seen before its first look.
fn unseen(spec: &LaserSpec) -> Sweep {
    let (pose, mount) = (Isometry2::identity(), spec.mount);
    // Before any time, so that the first look is a new one.
    let (time_s, twist, scan) = (f64::NEG_INFINITY, Twist::STOP, spec.empty_scan());
    Sweep { reading: LaserReading { time_s, pose, twist, mount, scan }, laser_pose: mount }
}

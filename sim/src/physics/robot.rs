use super::bodies::Bodies;
use super::chance::{Gaussian, Purpose, Uniform};
use super::command::{Command, Velocity};
use super::drive::Drive;
use super::eye::{Eye, Stance};
use super::minds::Mind;
use super::odometry::Odometry;
use super::rays::{Beams, Scene, Scratch};
use super::report::{Body, RobotView, Sweep};
use super::snapshot::{Played, Tape};
use super::spec::RobotSpec;
use geometry::LaserReading;
use nalgebra::{Isometry2, Point2};
use std::sync::Arc;

/// A robot at work: lasers, mind, motors, odometry. Its body is rapier's.
#[derive(Clone)]
pub(super) struct Robot {
    pub(super) spec: RobotSpec,
    /// Its place among the robots.
    index: usize,
    /// Where it truly is.
    pub(super) pose: Isometry2<f64>,
    /// Where its middle was before the last step, m.
    pub(super) was_at: Point2<f64>,
    pub(super) velocity: Velocity,
    /// Whether it drove by itself in the last step.
    pub(super) drove: bool,
    /// What it touches now.
    pub(super) touching: Vec<Body>,
    /// What it was last told to do.
    wanted: Command,
    pub(super) drive: Drive,
    odometry: Odometry,
    mind: Mind,
    /// Its lasers, the main one first.
    eyes: Vec<Eye>,
}

impl Robot {
    /// A robot in place `index` of the file, at `pose`. `beams` are its lasers'.
    pub(super) fn new(
        spec: &RobotSpec,
        index: usize,
        pose: Isometry2<f64>,
        step_s: f64,
        seed: u64,
        beams: Vec<Arc<Beams>>,
    ) -> Self {
        Self {
            index,
            pose,
            was_at: pose.translation.vector.into(),
            velocity: Velocity::STOP,
            drove: false,
            touching: Vec::new(),
            wanted: Command::STOP,
            drive: Drive::new(spec.drive),
            odometry: Odometry::new(spec.odometry, Gaussian::new(seed, Purpose::Odometry, index), pose),
            mind: Mind::new(spec, step_s, &beams[0], Uniform::new(seed, Purpose::Behaviour, index)),
            eyes: spec
                .lasers()
                .zip(beams)
                .enumerate()
                .map(|(which, (laser, beams))| Eye::new(laser, beams, seed, index, which))
                .collect(),
            spec: spec.clone(),
        }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        tape.pose(&mut self.pose)?;
        tape.point(&mut self.was_at)?;
        self.velocity.play(tape)?;
        tape.bool(&mut self.drove)?;
        tape.list(&mut self.touching, Body::Wall(0), Tape::body)?;
        self.wanted.play(tape)?;
        self.drive.play(tape)?;
        self.odometry.play(tape)?;
        self.mind.play(tape)?;
        self.eyes.iter_mut().try_for_each(|eye| eye.play(tape))
    }

    /// Its middle, m.
    pub(super) fn at(&self) -> Point2<f64> {
        self.pose.translation.vector.into()
    }

    /// Whether it obeys commands.
    pub(super) fn is_driven(&self) -> bool {
        matches!(self.mind, Mind::Driven)
    }

    /// Whether its main laser's next scan is due at a step: then it decides.
    pub(super) fn is_due(&self, step: u64) -> bool {
        self.eyes[0].is_due(step)
    }

    /// Whether a scan of any laser is due at a step.
    pub(super) fn looks(&self, step: u64) -> bool {
        self.eyes.iter().any(|eye| eye.is_due(step))
    }

    /// What its main laser saw last, if it has looked yet.
    pub(super) fn sweep(&self) -> Option<&Sweep> {
        self.eyes[0].sweep.as_ref()
    }

    /// What there is to see of it.
    pub(super) fn view(&self) -> RobotView<'_> {
        RobotView {
            index: self.index,
            name: &self.spec.name,
            pose: self.pose,
            radius_m: self.spec.radius_m,
            is_driven: self.is_driven(),
            twist: self.velocity.twist(),
            left_mps: self.velocity.left_mps,
            is_stalled: self.drive.is_stalled(),
            sweep: self.sweep(),
            eyes: &self.eyes,
        }
    }

    /// Tells it what to do.
    pub(super) fn command(&mut self, wanted: &Command) {
        self.wanted = *wanted;
    }

    /// It has been set down at `pose`, at rest, and knows where it is.
    pub(super) fn put(&mut self, pose: Isometry2<f64>) {
        self.pose = pose;
        self.was_at = self.at();
        self.velocity = Velocity::STOP;
        self.wanted = Command::STOP;
        self.drive = Drive::new(self.spec.drive);
        self.odometry.restart(pose);
        self.touching.clear();
        self.eyes.iter_mut().for_each(|eye| eye.sweep = None);
    }

    /// Looks around with its main laser at `time_s`, and with the others that are due, unless it has
    /// done so already at that time.
    pub(super) fn look(
        &mut self,
        (step, time_s): (u64, f64),
        scene: &Scene,
        scratch: &mut Scratch,
    ) -> &LaserReading {
        let stance = self.stance(time_s);
        let (main, others) = self.eyes.split_at_mut(1);
        for eye in others.iter_mut().filter(|eye| eye.is_due(step)) {
            eye.look(&stance, scene, scratch);
        }
        main[0].look(&stance, scene, scratch)
    }

    /// Looks around with the lasers that are due and, with a mind of its own, decides what to do.
    pub(super) fn think(&mut self, (step, time_s): (u64, f64), scene: &Scene, scratch: &mut Scratch) {
        let stance = self.stance(time_s);
        for eye in self.eyes.iter_mut().filter(|eye| eye.is_due(step)) {
            eye.look(&stance, scene, scratch);
        }
        if self.is_due(step)
            && let Some(sweep) = &self.eyes[0].sweep
            && let Some(wanted) = self.mind.decide(&sweep.reading)
        {
            self.wanted = wanted.into();
        }
    }

    fn stance(&self, time_s: f64) -> Stance {
        Stance {
            time_s,
            pose: self.pose,
            felt_pose: *self.odometry.pose(),
            felt_twist: self.odometry.twist(&self.velocity.twist()),
            robot: self.index,
        }
    }

    /// Sets its wheels in motion for the next step.
    pub(super) fn push(&mut self, bodies: &mut Bodies, step_s: f64) {
        self.velocity = self.drive.step(&self.wanted, self.odometry.pose(), step_s);
        self.drove = self.velocity != Velocity::STOP;
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

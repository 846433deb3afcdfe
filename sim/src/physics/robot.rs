use super::bodies::Bodies;
use super::chance::{Gaussian, Purpose, Uniform};
use super::command::{Command, Velocity};
use super::drive::Drive;
use super::ear::Ear;
use super::eye::{Eye, Stance};
use super::finder::{Finder, Tagged};
use super::form::Form;
use super::minds::Mind;
use super::odometry::Odometry;
use super::rays::{Beams, Scene, Scratch};
use super::report::{Body, RobotView, Sweep};
use super::snapshot::{Played, Tape};
use super::spec::RobotSpec;
use interfaces::LaserReading;
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
    /// Where it was before the last step.
    pub(super) was: Isometry2<f64>,
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
    ears: Vec<Ear>,
    finder: Option<Finder>,
    /// The bumpers that touch something, as bits.
    pub(super) pressed: u64,
}

/// A moment, and what there is to sense.
pub(super) struct Now<'a> {
    pub(super) step: u64,
    pub(super) time_s: f64,
    pub(super) scene: &'a Scene,
    pub(super) tagged: &'a [Tagged],
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
            was: pose,
            velocity: Velocity::STOP,
            drove: false,
            touching: Vec::new(),
            wanted: Command::STOP,
            drive: Drive::new(spec.drive),
            odometry: Odometry::new(spec, Gaussian::new(seed, Purpose::Odometry, index), pose),
            mind: Mind::new(spec, step_s, &beams[0], Uniform::new(seed, Purpose::Behaviour, index)),
            eyes: spec
                .lasers()
                .zip(beams)
                .enumerate()
                .map(|(which, (laser, beams))| Eye::new(laser, beams, seed, index, which))
                .collect(),
            ears: spec
                .sonars
                .iter()
                .enumerate()
                .map(|(which, sonar)| Ear::new(sonar, seed, index, which))
                .collect(),
            finder: spec.fiducial.as_ref().map(Finder::new),
            pressed: 0,
            spec: spec.clone(),
        }
    }

    /// Writes or reads what has become of it.
    pub(super) fn play(&mut self, tape: &mut Tape<'_>) -> Played {
        tape.pose(&mut self.pose)?;
        tape.pose(&mut self.was)?;
        self.velocity.play(tape)?;
        tape.bool(&mut self.drove)?;
        tape.list(&mut self.touching, Body::Wall(0), Tape::body)?;
        self.wanted.play(tape)?;
        self.drive.play(tape)?;
        self.odometry.play(tape)?;
        self.mind.play(tape)?;
        self.eyes.iter_mut().try_for_each(|eye| eye.play(tape))?;
        self.ears.iter_mut().try_for_each(|ear| ear.play(tape))?;
        self.finder.iter_mut().try_for_each(|finder| finder.play(tape))?;
        tape.u64(&mut self.pressed)
    }

    /// Its middle, m.
    pub(super) fn at(&self) -> Point2<f64> {
        self.pose.translation.vector.into()
    }

    /// Its body, now.
    pub(super) fn form(&self) -> Form {
        self.spec.form(&self.pose)
    }

    /// Whether it obeys commands.
    pub(super) fn is_driven(&self) -> bool {
        matches!(self.mind, Mind::Driven)
    }

    /// Whether its main laser's next scan is due at a step: then it decides.
    pub(super) fn is_due(&self, step: u64) -> bool {
        self.eyes[0].is_due(step)
    }

    /// Whether any of its senses is due at a step.
    pub(super) fn looks(&self, step: u64) -> bool {
        self.eyes.iter().any(|eye| eye.is_due(step))
            || self.ears.iter().any(|ear| ear.is_due(step))
            || self.finder.as_ref().is_some_and(|finder| finder.is_due(step))
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
            corners: &self.spec.corners,
            is_driven: self.is_driven(),
            twist: self.velocity.twist(),
            left_mps: self.velocity.left_mps,
            is_stalled: self.drive.is_stalled(),
            touching: &self.touching,
            sweep: self.sweep(),
            fiducials: self.finder.as_ref().map_or(&[], |finder| finder.found.as_slice()),
            eyes: &self.eyes,
            ears: &self.ears,
            bumpers: (self.pressed, self.spec.bumper.map_or(0, |bumper| bumper.sectors)),
        }
    }

    /// Tells it what to do.
    pub(super) fn command(&mut self, wanted: &Command) {
        self.wanted = *wanted;
    }

    /// It has been set down at `pose`, at rest, and knows where it is.
    pub(super) fn put(&mut self, pose: Isometry2<f64>) {
        self.pose = pose;
        self.was = pose;
        self.velocity = Velocity::STOP;
        self.wanted = Command::STOP;
        self.drive = Drive::new(self.spec.drive);
        self.odometry.restart(pose);
        self.touching.clear();
        self.pressed = 0;
        self.eyes.iter_mut().for_each(|eye| eye.sweep = None);
        self.ears.iter_mut().for_each(|ear| ear.ping = None);
        self.finder.iter_mut().for_each(|finder| finder.found.clear());
    }

    /// Looks around with its main laser, and with all other senses that are due, unless it has done
    /// so already at that time.
    pub(super) fn look(&mut self, now: &Now<'_>, scratch: &mut Scratch) -> &LaserReading {
        let stance = self.stance(now.time_s);
        self.sense(now, &stance, scratch);
        self.eyes[0].look(&stance, now.scene, scratch)
    }

    /// Senses what is due and, with a mind of its own, decides what to do.
    pub(super) fn think(&mut self, now: &Now<'_>, scratch: &mut Scratch) {
        self.sense(now, &self.stance(now.time_s), scratch);
        if self.is_due(now.step)
            && let Some(sweep) = &self.eyes[0].sweep
            && let Some(wanted) = self.mind.decide(&sweep.reading)
        {
            self.wanted = wanted.into();
        }
    }

    fn sense(&mut self, now: &Now<'_>, stance: &Stance, scratch: &mut Scratch) {
        for eye in self.eyes.iter_mut().filter(|eye| eye.is_due(now.step)) {
            eye.look(stance, now.scene, scratch);
        }
        for ear in self.ears.iter_mut().filter(|ear| ear.is_due(now.step)) {
            ear.listen(stance, now.scene, scratch);
        }
        if let Some(finder) = self.finder.as_mut().filter(|finder| finder.is_due(now.step)) {
            finder.look(stance, now.tagged, now.scene, scratch);
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
        self.was = before;
    }
}

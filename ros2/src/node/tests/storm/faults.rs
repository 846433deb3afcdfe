//! What goes wrong in a life: how each fault begins and ends, and what it does to the messages of the robot.

use super::*;
use crate::message::PoseWithCovarianceStamped;
use crate::service::wire::{Parameter, ParameterValue};
use crate::value::Value;

/// A robot is not carried before a new map has this number of readings: it stands still then, and one view looks like many others.
const SETTLED: u64 = 15;

/// What goes wrong: for a while, or at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Fault {
    LostScans,
    ScansTwice,
    ScansLate,
    DamagedScans,
    NoTransforms,
    ClockBack,
    ClockAhead,
    OdometryReset,
    Carried,
    Occupied,
    Killed,
    SecondWriter,
    Nonsense,
}

const FAULTS: [Fault; 13] = [
    Fault::LostScans,
    Fault::ScansTwice,
    Fault::ScansLate,
    Fault::DamagedScans,
    Fault::NoTransforms,
    Fault::ClockBack,
    Fault::ClockAhead,
    Fault::OdometryReset,
    Fault::Carried,
    Fault::Occupied,
    Fault::Killed,
    Fault::SecondWriter,
    Fault::Nonsense,
];

impl Life {
    /// A fault begins.
    pub(super) fn begin(&mut self) -> Result<(), String> {
        let mut fault = FAULTS[self.random.random_range(0..FAULTS.len())];
        if fault == Fault::Carried && self.readings < SETTLED {
            fault = Fault::LostScans;
        }
        let end_s = self.time_s() + self.random.random_range(1.0..6.0);
        self.tell(&format!("{fault:?}"));
        match fault {
            Fault::ClockBack => self.clock_ns -= self.random.random_range(2..400) * 1_000_000_000,
            Fault::ClockAhead => {
                let jumps = [10, 3600, 31_536_000];
                self.clock_ns += jumps[self.random.random_range(0..jumps.len())] * 1_000_000_000;
            }
            Fault::OdometryReset => {
                self.odom = self.pair.sim.poses().ok_or("no robot")?[1];
                // Readings from before it may still wait.
                self.now = Some((fault, self.time_s() + 1.0));
            }
            Fault::Carried => {
                self.carry();
                self.now = Some((fault, self.time_s() + 1.0));
            }
            Fault::Killed => self.kill()?,
            Fault::SecondWriter => {
                let second = CuriousNode::new(
                    FakeLink::default(),
                    &self.parameters,
                    Some(&self.state()),
                    Box::new(|_| ()),
                );
                if second.is_ok() {
                    return Err("a second node writes to the same file".to_owned());
                }
            }
            Fault::Occupied => {
                if self.state().exists() {
                    self.wait();
                    std::fs::rename(self.state(), self.kept()).map_err(|why| why.to_string())?;
                }
                std::fs::write(self.state(), FOREIGN[0]).map_err(|why| why.to_string())?;
                self.now = Some((fault, end_s));
            }
            Fault::Nonsense => self.nonsense()?,
            _ => self.now = Some((fault, end_s)),
        }
        Ok(())
    }

    /// What goes wrong now is over.
    pub(super) fn over(&mut self) -> Result<(), String> {
        if let Some((Fault::Occupied, _)) = self.now.take() {
            let is_saved = self.save()?;
            if is_saved || std::fs::read(self.state()).ok().as_deref() != Some(FOREIGN[0].as_bytes()) {
                return Err("the state replaces a file of somebody else".to_owned());
            }
            std::fs::remove_file(self.state()).map_err(|why| why.to_string())?;
            if self.kept().exists() {
                std::fs::rename(self.kept(), self.state()).map_err(|why| why.to_string())?;
            }
        }
        if self.random.random_bool(0.5) && self.save()? {
            self.saved = self.origin;
        }
        while let Some((topic, message)) = self.held.pop_front() {
            self.deliver(topic, message);
        }
        Ok(())
    }

    /// Where the state is while somebody else's file has its name.
    fn kept(&self) -> PathBuf {
        self.folder.path().join("kept.state")
    }

    /// Until the state is written.
    fn wait(&mut self) {
        if let Some(file) = &mut self.pair.node.state_file {
            file.wait().1.ok();
        }
    }

    /// Somebody carries the robot to another place. Its wheels do not turn.
    fn carry(&mut self) {
        let Some([_, before]) = self.pair.sim.poses() else { return };
        for _ in 0..100 {
            let pose = interfaces::pose(
                self.random.random_range(0.5..10.5),
                self.random.random_range(0.5..7.5),
                self.random.random_range(-3.0..3.0),
            );
            if self.pair.sim.put(&pose)
                && let Some([_, after]) = self.pair.sim.poses()
            {
                self.odom = after * before.inverse() * self.odom;
                return;
            }
        }
    }

    /// The node is killed, and starts again.
    pub(super) fn kill(&mut self) -> Result<(), String> {
        self.wait();
        let has_state = self.state().exists();
        self.pair.others.others(|others| others.events.clear());
        let (none, _, _) = node(&self.parameters, None);
        drop(std::mem::replace(&mut self.pair.node, none));
        let (node, others, said) = node(&self.parameters, Some(&self.state()));
        (self.pair.node, self.pair.others, self.pair.said) = (node, others, said);
        self.latched
            .iter()
            .for_each(|message| self.pair.others.sends(Topic::StaticTransforms, message.clone()));
        (self.origin, self.readings) = (self.saved, 0);
        match has_state == self.pair.is_said("the map goes on from") {
            true => Ok(()),
            false => Err("what was saved is lost".to_owned()),
        }
    }

    /// Calls and messages that no program should send.
    fn nonsense(&mut self) -> Result<(), String> {
        let long = "x".repeat(self.random.random_range(1..100_000));
        let unknown = Parameter { name: long.clone(), value: ParameterValue::from(&Value::Float(f64::NAN)) };
        self.call(Service::SetParameters, Call::Parameters(vec![unknown; 3]))?;
        self.call(Service::GetParameters, Call::Names(vec![long; 3]))?;
        let header = crate::message::header(Time::default(), "map");
        let nowhere = interfaces::pose(f64::INFINITY, 0.0, 0.0);
        let pose = PoseWithCovarianceStamped::in_plane(header, &nowhere, &nalgebra::Matrix3::identity());
        self.send(Topic::InitialPose, Message::PoseWithCovariance(Box::new(pose)));
        Ok(())
    }

    /// Sends a message with what goes wrong.
    pub(super) fn send(&mut self, topic: Topic, mut message: Message) {
        let fault = self.now.map(|(fault, _)| fault);
        match (&mut message, fault) {
            (Message::Transforms(_), Some(Fault::NoTransforms)) if topic == Topic::Transforms => return,
            (Message::Odometry(_), Some(Fault::NoTransforms)) => return,
            (Message::Scan(_), Some(Fault::LostScans)) if self.random.random_bool(0.7) => return,
            (Message::Scan(scan), Some(Fault::DamagedScans)) => {
                let range = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 0.0, 1e30, 0.3]
                    [self.random.random_range(0..7)];
                match self.random.random_range(0..4) {
                    0 => scan.ranges.iter_mut().step_by(3).for_each(|beam| *beam = range),
                    1 => scan.ranges.truncate(self.random.random_range(0..5)),
                    2 => scan.angle_increment = range,
                    _ => scan.ranges.iter_mut().for_each(|beam| *beam = range),
                }
            }
            (Message::Scan(_), Some(Fault::ScansTwice)) => self.deliver(topic, message.clone()),
            (Message::Scan(_), Some(Fault::ScansLate)) if self.random.random_bool(0.5) => {
                self.held.push_back((topic, message));
                return;
            }
            _ => {}
        }
        if topic == Topic::StaticTransforms {
            self.latched = Some(message.clone());
        }
        let is_scan = matches!(message, Message::Scan(_));
        self.deliver(topic, message);
        if is_scan && let Some((topic, late)) = self.held.pop_front() {
            self.deliver(topic, late);
        }
    }

    /// Sends a message as the clock and the odometry of the robot have it.
    fn deliver(&mut self, topic: Topic, mut message: Message) {
        let shift = |stamp: &mut Time| *stamp = Time::from_ns(stamp.ns() + self.clock_ns);
        match &mut message {
            Message::Scan(scan) => shift(&mut scan.header.stamp),
            Message::Odometry(odometry) => {
                shift(&mut odometry.header.stamp);
                self.reset(&mut odometry.pose.pose);
            }
            Message::Transforms(all) => {
                for one in &mut all.transforms {
                    shift(&mut one.header.stamp);
                    if one.header.frame_id == "odom" {
                        self.reset(&mut one.transform);
                    }
                }
            }
            _ => {}
        }
        self.pair.others.sends(topic, message);
    }

    fn reset(&self, pose: &mut crate::message::Pose) {
        if let Some(isometry) = pose.isometry() {
            *pose = crate::message::Pose::in_plane(&(self.odom.inverse() * ros::flat(&isometry)));
        }
    }
}

//! The mapping node: the loop of every robot, once per reading that arrives, and what other nodes hear of it.

mod calls;
mod diagnostics;
mod lifecycle;
mod publishing;
mod routes;
mod saving;
mod session;
mod setup;
mod slam_services;
#[cfg(test)]
mod tests;

use crate::lifecycle::State;
use crate::link::{Event, Link};
use crate::message::{Message, Time, Topic};
use crate::node_state_file::{Asker, NodeStateFile, open};
use crate::notes::{Notes, Output};
use crate::parameters::Parameters;
use crate::pilot::LivePilot;
use crate::source::{LiveReading, ScanCount, Source};
use interfaces::{LaserReading, PoseMode};
use localizer::PoseState;
use publishing::Published;
use robot::{Belief, Robot};
use routes::Routes;
use session::Seat;
use setup::Parts;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The longest wait for an event.
const NAP: Duration = Duration::from_millis(100);
/// A robot that gets no scan for this time is stopped.
const BLIND: Duration = Duration::from_millis(500);
/// After this time without a reading, a sentence says why.
const SILENCE: Duration = Duration::from_secs(5);
/// What signals ask for.
#[derive(Debug, Default)]
pub struct Signals {
    /// The node ends.
    pub stop: Arc<AtomicBool>,
    /// The node saves its state.
    pub save: Arc<AtomicBool>,
}

/// What a run of a node has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeReport {
    /// Scans that came, and what happened to them.
    pub scans: ScanCount,
    /// Scans that became readings.
    pub readings: u64,
    /// Readings that entered the map: those whose pose was certain.
    pub mapped: u64,
    /// The longest time from the arrival of an event to the end of its processing, µs.
    pub longest_us: u64,
}

/// A node that maps what a robot sees, and can explore.
pub struct CuriousNode<L: Link> {
    link: L,
    parameters: Parameters,
    source: Source,
    robot: Robot<LaserReading, LivePilot>,
    published: Published,
    routes: Option<Routes>,
    /// What the node does at all.
    state: State,
    /// `--state`, as given.
    state_path: Option<PathBuf>,
    state_file: Option<NodeStateFile>,
    /// States that are written for those who have asked.
    copies: Vec<NodeStateFile>,
    /// The time of the last reading before this session: of the state that was loaded, or before the node was deactivated.
    continued: Option<Time>,
    /// Where the robot is at its next reading, as somebody says.
    seat: Option<Seat>,
    notes: Notes,
    /// The last reading that was used: its time, and when it came.
    last: Option<(Time, Instant)>,
    next_silence: Instant,
    is_stopped: bool,
    report: NodeReport,
    pose_state: PoseState,
}

impl<L: Link> CuriousNode<L> {
    /// A node that has received nothing. What it has learned in earlier runs is loaded from `state`.
    ///
    /// # Errors
    ///
    /// When a parameter is out of range, or when the state cannot be used.
    pub fn new(
        link: L,
        parameters: &Parameters,
        state: Option<&Path>,
        output: Output,
    ) -> anyhow::Result<Self> {
        let mut notes = Notes::new(output);
        let loaded = state.filter(|_| parameters.autostart).map(open).transpose()?;
        let Parts { robot, state_file, continued } = Parts::new(parameters, loaded, &mut notes)?;
        let mut node = Self {
            link,
            source: Source::new(setup::frames(parameters)),
            parameters: parameters.clone(),
            robot,
            published: Published::default(),
            routes: Routes::new(parameters)?,
            state: State::Unconfigured,
            state_path: state.map(Path::to_owned),
            state_file,
            copies: Vec::new(),
            continued,
            seat: None,
            notes,
            last: None,
            next_silence: Instant::now() + SILENCE,
            is_stopped: true,
            report: NodeReport::default(),
            pose_state: PoseState::default(),
        };
        if parameters.autostart {
            node.state = State::Active;
            node.activate();
        } else {
            node.notes.say("the node is unconfigured, and waits for a lifecycle manager");
        }
        Ok(node)
    }

    /// Runs until a signal ends the node. The state is saved at the end.
    ///
    /// # Errors
    ///
    /// When the state cannot be saved.
    pub fn run(&mut self, signals: &Signals) -> anyhow::Result<NodeReport> {
        while !signals.stop.load(Ordering::Relaxed) {
            if signals.save.swap(false, Ordering::Relaxed) {
                self.save_for(Asker::Signal);
            }
            self.turn(self.nap());
        }
        self.finish()
    }

    /// Waits for an event at most for this time, and does all that is due.
    pub fn turn(&mut self, patience: Duration) {
        let event = self.link.receive(patience);
        let now = Instant::now();
        self.turn_with(event, now);
        let took_us = u64::try_from(now.elapsed().as_micros()).unwrap_or(u64::MAX);
        self.report.longest_us = self.report.longest_us.max(took_us);
    }

    /// Takes an event, if one has come, and does all that is due now.
    fn turn_with(&mut self, event: Option<Event>, now: Instant) {
        if let Some(event) = event {
            self.take(event, now);
        }
        while let Some(reading) = self.source.next(now) {
            if self.is_active() {
                self.step(reading, now);
            }
        }
        for note in self.source.take_notes() {
            self.notes.note(&note, now);
        }
        self.tick(now);
    }

    /// What the node has done so far.
    pub fn report(&self) -> NodeReport {
        NodeReport { scans: self.source.count, ..self.report }
    }

    fn nap(&self) -> Duration {
        let next = self.published.next_transform.filter(|_| self.is_active());
        next.map_or(NAP, |next| next.saturating_duration_since(Instant::now()).min(NAP))
    }

    fn take(&mut self, event: Event, now: Instant) {
        match event {
            Event::Message(Topic::Resume, Message::Bool(resume)) => {
                self.notes.say(if resume { "exploring" } else { "exploring is paused" });
                self.robot.pilot.resume(resume);
                if !resume {
                    self.stop_robot();
                }
            }
            Event::Message(Topic::InitialPose, Message::PoseWithCovariance(pose)) => {
                self.take_initial_pose(&pose, now);
            }
            Event::Message(topic, message) => self.source.take(topic, message, now),
            Event::Call(request, call) => self.call(request, call),
            Event::EdgesAdjusted(are_adjusted) => self.note_edges(are_adjusted, now),
            Event::Navigation(navigation) => self.robot.pilot.navigated(navigation),
            Event::Problem(text) => self.notes.note(&text, now),
        }
    }

    /// One step of the robot, for a live scan whose pose by odometry is known.
    fn step(&mut self, live: LiveReading, now: Instant) {
        let LiveReading { mut reading, in_odom, in_first_odom, stamp, is_restart } = live;
        if self.parameters.pose != PoseMode::Localized {
            reading.pose = in_first_odom;
        }
        self.begin_session(&reading, stamp, is_restart);
        self.take_seat();
        let (was_trusted, was_settled) = (self.is_trusted(&reading), self.robot.is_settled());
        let turn = self.robot.step(reading);
        (self.last, self.next_silence) = (Some((stamp, now)), now + SILENCE);
        let turn = match turn {
            Ok(turn) => turn,
            Err(why) => return self.notes.note(&format!("a scan is left out: {why}"), now),
        };
        self.report.readings += 1;
        self.pose_state = turn.belief.state();
        self.report.mapped += u64::from(turn.belief.is_certain());
        match (was_settled, self.robot.is_settled()) {
            (true, false) => self
                .notes
                .say("a loop is found: a thread learns the map again, and the robot goes on in the old one"),
            (false, true) if turn.belief.correction.is_none() => {
                self.notes.say("the map that was learned again is no better: the old one stays");
            }
            _ => {}
        }
        self.say_news(&turn.belief);
        if self.is_trusted(&turn.reading) != was_trusted {
            let what = if was_trusted { "say nothing" } else { "count as free" };
            self.notes
                .say(&format!("beams without a return {what} from now on: see the parameter `no_return`"));
        }
        if turn.belief.state() != PoseState::Lost {
            self.published.map_to_odom = Some(turn.belief.pose * in_odom.inverse());
        }
        self.publish_reading(stamp, &turn, now);
    }

    /// What a user should know of the pose.
    fn say_news(&mut self, belief: &Belief) {
        if let Some(correction) = &belief.correction {
            self.notes.say(&correction.to_string());
            self.published.maps.repeat();
        }
        let is_lost = belief.state() == PoseState::Lost;
        if std::mem::replace(&mut self.published.is_lost, is_lost) != is_lost {
            match is_lost {
                true => self.notes.warn("the pose of the robot is not known"),
                false => self.notes.say("the pose is known again"),
            }
        }
    }

    /// Whether beams without a return of the scanner of a reading mean free space.
    fn is_trusted(&self, reading: &LaserReading) -> bool {
        self.robot.filter().is_some_and(|filter| filter.no_returns().is_trusted(reading))
    }

    fn tick(&mut self, now: Instant) {
        if self.is_active() {
            self.tick_active(now);
        }
        self.publish_diagnostics(now);
        self.answer_askers();
        let is_due = self.state_file.as_ref().is_some_and(NodeStateFile::is_due) && self.last.is_some();
        if is_due
            && self.robot.is_settled()
            && let Some(Err(why)) = self.save()
        {
            self.notes.note(&format!("the state cannot be saved: {why}"), now);
        }
        self.publish_log(now);
    }

    fn tick_active(&mut self, now: Instant) {
        if self.published.next_transform.is_none_or(|next| now >= next) {
            self.publish_transform(now);
        }
        if self.last.is_some_and(|(_, at)| now.duration_since(at) >= BLIND) {
            self.stop_robot();
        }
        if now >= self.next_silence {
            self.next_silence = now + SILENCE;
            let topic = &self.parameters.scan_topic;
            let why = self.source.obstacle().unwrap_or_else(|| format!("no scans on {topic}"));
            self.notes.note(&format!("waiting: {why}"), now);
        }
    }

    fn finish(&mut self) -> anyhow::Result<NodeReport> {
        self.leave_robot();
        self.save_at_end()?;
        self.publish_log(Instant::now());
        Ok(self.report())
    }
}

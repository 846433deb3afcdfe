//! The mapping node: the loop of every robot, once per reading that arrives, and what other nodes hear of it.

mod outputs;
mod publishing;
mod saving;
mod session;
mod setup;
#[cfg(test)]
mod tests;

use crate::link::{Event, Link};
use crate::maps::PublishedMaps;
use crate::message::{Message, Time, Topic};
use crate::notes::{Notes, Output};
use crate::order::Order;
use crate::parameters::{Parameters, PoseSource};
use crate::pilot::LivePilot;
use crate::saves::Saves;
use crate::source::{FrameNames, LiveReading, ScanCount, Source};
use anyhow::anyhow;
use interfaces::{LaserReading, World};
use localizer::{GivenPoses, LocalizerSettings, LoopClosingLocalizer, PoseState, Switch};
use mapper::{Mapper, NoReturns, ReadingError};
use nalgebra::Isometry2;
use outputs::Markers;
use robot::{Localization, Session, explore};
use saving::Asker;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use survey::SurveySettings;

/// The longest wait for an event.
const NAP: Duration = Duration::from_millis(100);
/// A robot that gets no scan for this time is stopped.
const BLIND: Duration = Duration::from_millis(500);
/// After this time without a reading, a sentence says why.
const SILENCE: Duration = Duration::from_secs(5);
/// Between readings that are farther apart, nothing was in view, s.
const LONGEST_GAP_S: f64 = 2.0;

/// With a simulated clock, the map that a closed loop has corrected replaces the old one after this number of readings.
const SWITCH_READINGS: usize = 50;

/// What signals ask for.
#[derive(Debug, Default)]
pub struct Signals {
    /// The node ends.
    pub stop: AtomicBool,
    /// The node saves its state.
    pub save: Arc<AtomicBool>,
}

/// What a run of a node has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeReport {
    /// Scans that came.
    pub received: u64,
    /// Scans that became readings.
    pub readings: u64,
    /// Readings that entered the map: those whose pose was certain.
    pub mapped: u64,
    /// Scans that are not valid, that have no place or no pose, and that came too late.
    pub unused: [u64; 3],
    /// The longest time from the arrival of an event to the end of its processing, µs.
    pub longest_us: u64,
}

/// A node that maps what a robot sees, and can explore.
pub struct CuriousNode<L: Link> {
    link: L,
    parameters: Parameters,
    settings: SurveySettings,
    source: Source,
    mapper: Mapper,
    no_returns: NoReturns,
    localization: Box<dyn Localization<LaserReading> + Send>,
    pilot: LivePilot,
    maps: PublishedMaps,
    markers: Markers,
    saves: Option<Saves>,
    /// Those who wait until the state is saved.
    askers: Vec<Asker>,
    notes: Notes,
    /// The time of the first reading by its clock, s.
    first_s: Option<f64>,
    session: Session,
    /// The time of the last reading of the state that was loaded.
    continued: Option<Time>,
    /// The pose of the frame of the odometry in the frame of the map.
    map_to_odom: Option<Isometry2<f64>>,
    last: Option<(Time, Instant)>,
    next_transform: Instant,
    next_silence: Instant,
    state: PoseState,
    is_stopped: bool,
    report: NodeReport,
}

impl<L: Link> CuriousNode<L> {
    /// A node that has received nothing. What it has learned in earlier runs is loaded from `state`.
    ///
    /// # Errors
    ///
    /// When a parameter is out of range, or when the state cannot be used.
    pub fn new(
        mut link: L,
        parameters: &Parameters,
        state: Option<&Path>,
        output: Output,
    ) -> anyhow::Result<Self> {
        parameters.check()?;
        let settings = setup::settings(parameters);
        let frame = setup::frame(parameters)?;
        let mut mapper = Mapper::new(&settings.mapper, frame)?;
        let localizer = LocalizerSettings {
            range_noise_std_m: parameters.range_noise_m,
            lost_after_s: parameters.lost_after_s,
            ..LocalizerSettings::default()
        };
        let is_localized = parameters.pose == PoseSource::Localized;
        let mut localization: Box<dyn Localization<LaserReading> + Send> = match is_localized {
            true => {
                let loops = LoopClosingLocalizer::from_nothing(&localizer, &frame, Isometry2::identity())?;
                let by_count = Switch::After(SWITCH_READINGS);
                Box::new(loops.switching(if parameters.use_sim_time { by_count } else { Switch::WhenReady }))
            }
            false => Box::new(GivenPoses::default()),
        };
        let mut pilot = LivePilot::new(parameters)?;
        let mut notes = Notes::new(output);
        let pose = if is_localized { ("localized", Some(&localizer)) } else { ("given", None) };
        let strategy = &parameters.strategy;
        let saves =
            state.map(|path| Saves::new(path, &settings.mapper, &frame, pose, strategy)).transpose()?;
        let continued = match &saves {
            Some(saves) => saves.restore(&mut mapper, localization.as_mut(), &mut pilot)?,
            None => None,
        };
        let mut maps = PublishedMaps::new(parameters.map_update_interval_s);
        if let Some(last) = continued {
            let header = outputs::header(last, &parameters.map_frame);
            for (topic, message) in maps.after(&mapper, &header, Instant::now()) {
                link.send(topic, message);
            }
            notes.say(&format!("the map goes on from {} readings", mapper.readings()));
        }
        let Parameters { map_frame, odom_frame, base_frame, .. } = parameters.clone();
        let now = Instant::now();
        Ok(Self {
            link,
            parameters: parameters.clone(),
            settings,
            source: Source::new(
                FrameNames { map: map_frame, odom: odom_frame, base: base_frame },
                parameters.transform_publish_period_s > 0.0,
            ),
            mapper,
            no_returns: NoReturns::new(parameters.no_return),
            localization,
            pilot,
            maps,
            markers: Markers::default(),
            saves,
            askers: Vec::new(),
            notes,
            first_s: None,
            session: Session::default(),
            continued,
            map_to_odom: None,
            last: None,
            next_transform: now,
            next_silence: now + SILENCE,
            state: PoseState::Tracking,
            is_stopped: true,
            report: NodeReport::default(),
        })
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
        if let Some(event) = event {
            self.take(event, now);
        }
        while let Some(reading) = self.source.next(now) {
            self.learn(reading, now);
        }
        for note in self.source.take_notes() {
            self.notes.note(&note, now);
        }
        self.tick(now);
        let took_us = u64::try_from(now.elapsed().as_micros()).unwrap_or(u64::MAX);
        self.report.longest_us = self.report.longest_us.max(took_us);
    }

    /// What the node has done so far.
    pub fn report(&self) -> NodeReport {
        let ScanCount { received, invalid, unplaced, late } = self.source.count;
        NodeReport { received, unused: [invalid, unplaced, late], ..self.report }
    }

    /// The map.
    pub fn mapper(&self) -> &Mapper {
        &self.mapper
    }

    fn nap(&self) -> Duration {
        let transform = self.next_transform.saturating_duration_since(Instant::now());
        if self.parameters.transform_publish_period_s > 0.0 { transform.min(NAP) } else { NAP }
    }

    fn take(&mut self, event: Event, now: Instant) {
        match event {
            Event::Message(Topic::Resume, Message::Bool(resume)) => {
                self.notes.say(if resume.data { "exploring" } else { "exploring is paused" });
                self.pilot.resume(resume.data);
                if !resume.data {
                    self.stop_robot();
                }
            }
            Event::Message(topic, message) => self.source.take(topic, message, now),
            Event::SaveState(request) => self.save_for(Asker::Request(request)),
            Event::Navigation(navigation) => self.pilot.navigated(navigation),
            Event::Problem(text) => self.notes.note(&text, now),
        }
    }

    /// One turn of the loop of every robot.
    fn learn(&mut self, live: LiveReading, now: Instant) {
        let LiveReading { mut reading, in_odom, stamp, is_restart } = live;
        if self.parameters.pose != PoseSource::Localized {
            reading.pose = in_odom;
        }
        let mut seen = reading.clone();
        let pose = self.map_to_odom.map_or(reading.pose, |to_map| to_map * in_odom);
        self.no_returns.apply(&mut reading, &pose);
        let reading = self.in_session(self.settings.filtered(reading), stamp, is_restart);
        if reading.time_s - self.mapper.time() > LONGEST_GAP_S && self.mapper.readings() > 0 {
            self.mapper.pause(reading.time_s);
        }
        let Self { mapper, localization, pilot, .. } = self;
        let mut moment = Moment(reading);
        let (mut pose, mut state) = (Isometry2::identity(), PoseState::Tracking);
        let mut correction = None;
        let localization: &mut dyn Localization<LaserReading> = localization.as_mut();
        let order = explore(&mut moment, localization, mapper, pilot, |_, _, belief, _| {
            pose = *belief.pose;
            state = belief.estimate.map_or(PoseState::Tracking, |estimate| estimate.state);
            correction = belief.correction;
            Ok::<_, ReadingError>(ControlFlow::Break(()))
        });
        self.last = Some((stamp, now));
        self.next_silence = now + SILENCE;
        let order = match order {
            Ok(order) => order,
            Err(why) => {
                self.notes.note(&format!("a scan is left out: {why}"), now);
                return;
            }
        };
        if let Some(correction) = correction {
            self.notes.say(&correction.to_string());
            self.maps.repeat();
        }
        self.report.readings += 1;
        self.report.mapped += u64::from(state == PoseState::Tracking);
        if state != self.state && (state == PoseState::Lost || self.state == PoseState::Lost) {
            let is_lost = state == PoseState::Lost;
            self.notes.say(if is_lost {
                "the pose of the robot is not known"
            } else {
                "the pose is known again"
            });
        }
        self.state = state;
        if state == PoseState::Tracking {
            seen.pose = pose;
            self.no_returns.learn(&seen);
        }
        if state != PoseState::Lost {
            self.map_to_odom = Some(pose * in_odom.inverse());
        }
        self.publish_reading(stamp, order, now);
    }

    fn tick(&mut self, now: Instant) {
        let period_s = self.parameters.transform_publish_period_s;
        if period_s > 0.0 && now >= self.next_transform {
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
        self.answer_askers();
        let is_due = self.saves.as_ref().is_some_and(Saves::is_due) && self.report.readings > 0;
        if is_due
            && self.localization.is_settled()
            && let Some(Err(why)) = self.save()
        {
            self.notes.note(&format!("the state cannot be saved: {why}"), now);
        }
    }

    fn finish(&mut self) -> anyhow::Result<NodeReport> {
        self.stop_robot();
        self.link.navigate(None);
        if self.save().is_some() {
            let answer = self.written();
            for asker in std::mem::take(&mut self.askers) {
                self.answer(asker, answer.clone());
            }
            if !answer.is_done {
                return Err(anyhow!(answer.text));
            }
        }
        Ok(self.report())
    }
}

/// One reading as a world: the order is carried out elsewhere.
struct Moment(LaserReading);

impl World for Moment {
    type Reading = LaserReading;
    type Command = Order;

    fn sense(&mut self) -> LaserReading {
        self.0.clone()
    }

    fn poses_are_exact(&self) -> bool {
        false
    }

    fn act(&mut self, _: &Order) {}
}

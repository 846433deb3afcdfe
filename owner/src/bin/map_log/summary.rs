//! The results of a survey: `summary.json`, and a few lines for the terminal.

use crate::logs_in_order::begin_s;
use crate::passes::{Learned, ignored};
use anyhow::Context;
use cli::program::arguments;
use interfaces::{CellState, PoseMode, median, printable};
use mapper::{Mapper, NoReturn, NoReturnEvidence};
use owner::words::{how_often, list};
use results::numbers::percent;
use robot::BUILD;
use serde::Serialize;
use std::fmt;
use survey::{Place, PlaceKind, Quality, Since, StillName, Survey, SurveySettings, SurveyedLog, Verdict};

/// The number of places in the summary and in the report, beside those with names and doors.
const MAX_PLACES: usize = 20;
/// The version of the layout of `summary.json`; count up when a key is renamed, removed or changes its meaning.
const SCHEMA: u32 = 4;
/// Why there are no rates.
const NO_TIMES: &str = "the times of the log are unusable, so that no rate, duration or date can be given: the map shows where \
                        something changed, not how often";
const NOT_USABLE: &str =
    "the map is not usable, and what looks like a change can be a wall that is there twice";

/// The content of `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Summary {
    /// The version of this layout: [`SCHEMA`].
    pub(crate) schema: u32,
    /// The build of the program: equal builds compute equal bits.
    pub(crate) build: &'static str,
    pub(crate) version: &'static str,
    /// The command line, without the name of the program.
    pub(crate) arguments: Vec<String>,
    pub(crate) settings: SurveySettings,
    /// The logs, in the order of their times.
    pub(crate) logs: Vec<String>,
    /// The number of scans that were used.
    pub(crate) scans: usize,
    /// The duration of what was used of the logs, without the time between them, s; `null` if their times are unusable.
    pub(crate) duration_s: Option<f64>,
    /// What the map is good for: `good`, `usable-with-care` or `not-usable`, as the worst of the logs.
    pub(crate) verdict: Verdict,
    /// Why the map is not good, in sentences.
    pub(crate) verdict_reasons: Vec<String>,
    /// The figures of each log behind the verdict.
    pub(crate) quality: Vec<Quality>,
    /// What was repaired or left out in the log.
    pub(crate) notes: Vec<String>,
    /// The length of the trajectory in this time, m.
    pub(crate) trajectory_m: f64,
    /// The number of places that the robot recognized, in the whole logs.
    pub(crate) loops: usize,
    /// The time of the first scan in seconds since the epoch (1970-01-01 UTC); `null` unless every log says when it was
    /// recorded. Times of changes are relative to this.
    pub(crate) begin_s: Option<f64>,
    /// The time of the first scan of each log on the clock of the map, s: of logs without a date it is made up.
    #[serde(skip)]
    pub(crate) log_begins_s: Vec<f64>,
    /// Whose hours people and doors have, or why there are none.
    pub(crate) hours: String,
    /// What beams without a return mean: `learn`, `free` or `ignore`.
    pub(crate) no_return: NoReturn,
    /// The evidence about them, for each scanner of each log that has such beams; empty unless it was learned.
    pub(crate) no_return_evidence: Vec<NoReturnEvidence>,
    /// The number of scans that did not enter the map, because their pose is not certain.
    pub(crate) scans_left_out: usize,
    /// The area that was seen, m².
    pub(crate) seen_m2: f64,
    /// The share of the cells seen that changed at least once.
    pub(crate) changed_share: f64,
    /// The number of changes of cells.
    pub(crate) changes: u64,
    /// Why there are no rates; `null` if there are.
    pub(crate) rates_withheld: Option<String>,
    /// The number of places where something changes; the first of them are in `places`.
    pub(crate) place_count: usize,
    /// The places where something changes, the liveliest first.
    pub(crate) places: Vec<Place>,
    /// The names of the user for what was not seen to change.
    pub(crate) names_without_change: Vec<StillName>,
    /// The median time in view of the cells that did not change, s; `null` if there are none.
    pub(crate) still_observed_s: Option<f64>,
    /// The time of the first scan of this session, in seconds since the epoch; `null` in the first session, and without dates.
    pub(crate) session_begin_s: Option<f64>,
    /// What is different since the last session; `null` in the first one.
    pub(crate) since_last_session: Option<Since>,
    /// Whether the map is not usable, and `--accept-map` was not given.
    pub(crate) is_refused: bool,
    pub(crate) is_interrupted: bool,
    pub(crate) wall_s: f64,
    /// The names of the other files with results, in the same folder.
    pub(crate) files: Vec<String>,
}

impl Summary {
    pub(crate) fn new(survey: &Survey, learned: &Learned, is_accepted: bool) -> anyhow::Result<Self> {
        let mapper = survey.mapper().context("nothing was learned")?;
        let logs = survey.logs();
        let entries = || logs.iter().map(|log| &log.entry);
        let cell_m2 = mapper.frame().resolution_m().powi(2);
        let seen = mapper.states().cells().iter().filter(|state| **state != CellState::Unknown).count();
        let mut places = survey.places();
        let place_count = places.len();
        let names_without_change = survey.still_names(&places);
        let mut since_last_session = survey.since(&places);
        let has_times = entries().all(|entry| entry.has_times);
        let verdict = survey.verdict();
        let is_refused = verdict == Verdict::NotUsable && !is_accepted;
        let rates_withheld = match (has_times, is_refused) {
            (_, true) => Some(NOT_USABLE),
            (false, _) => Some(NO_TIMES),
            _ => None,
        };
        if rates_withheld.is_some() {
            places.iter_mut().for_each(|place| place.rates = None);
            since_last_session = None;
        }
        let first_log = since_last_session.as_ref().and_then(|since| logs.get(since.first_log));
        let session_begin_s = first_log.and_then(|log| log.entry.begin_s);
        let is_different =
            |place: &Place| since_last_session.as_ref().is_some_and(|since| since.is_different(place.number));
        let mut rank = 0..;
        places.retain(|place| {
            rank.next().is_some_and(|rank| rank < MAX_PLACES) || is_always_shown(place) || is_different(place)
        });
        let qualities = || logs.iter().map(|log| &log.quality);
        Ok(Self {
            schema: SCHEMA,
            build: BUILD,
            version: env!("CARGO_PKG_VERSION"),
            arguments: arguments(),
            settings: survey.settings_of(logs.len()),
            logs: entries().map(|entry| entry.name.clone()).collect(),
            scans: logs.iter().map(|log| log.used).sum(),
            duration_s: has_times.then(|| logs.iter().map(|log| log.travelled.duration_s).sum()),
            verdict,
            verdict_reasons: reasons(survey),
            quality: qualities().cloned().collect(),
            notes: entries()
                .flat_map(|entry| entry.notes.clone())
                .chain(learned.no_return.iter().filter_map(ignored))
                .collect(),
            trajectory_m: logs.iter().map(|log| log.travelled.length_m).sum(),
            loops: logs.iter().map(|log| log.loops).sum(),
            begin_s: begin_s(entries()),
            log_begins_s: entries().map(|entry| entry.offset_s).collect(),
            hours: hours(survey, arguments().iter().any(|argument| argument.starts_with("--time-zone"))),
            no_return: survey.settings_of(logs.len()).filter.no_return,
            no_return_evidence: learned.no_return.clone(),
            scans_left_out: logs.iter().map(|log| log.travelled.uncertain).sum(),
            seen_m2: seen as f64 * cell_m2,
            changed_share: mapper.changed().count() as f64 / seen.max(1) as f64,
            changes: survey.changes.events(),
            rates_withheld: rates_withheld.map(str::to_owned),
            place_count,
            places,
            names_without_change,
            still_observed_s: still_observed_s(mapper),
            session_begin_s,
            since_last_session,
            is_refused,
            is_interrupted: learned.is_interrupted,
            wall_s: 0.0,
            files: Vec::new(),
        })
    }
}

/// Why the map is not good, with the log if there are several.
fn reasons(survey: &Survey) -> Vec<String> {
    let several = survey.logs().len() > 1;
    let of = |log: &SurveyedLog| {
        let name = log.entry.name.clone();
        let reasons = log.quality.reasons().into_iter();
        reasons
            .map(move |reason| if several { format!("{name}: {reason}") } else { reason })
            .collect::<Vec<_>>()
    };
    survey.logs().iter().flat_map(of).collect()
}

/// Whether a place is in the summary however little changes there.
fn is_always_shown(place: &Place) -> bool {
    place.name.is_some() || matches!(place.kind, PlaceKind::Door { .. })
}

/// The median time in view of the cells that never changed, s.
fn still_observed_s(mapper: &Mapper) -> Option<f64> {
    let is_still = |index: &usize| mapper.was_ever_seen(*index) && mapper.statistics(*index).events() == 0;
    let still = (0..mapper.frame().len()).filter(is_still);
    median(still.map(|index| mapper.statistics(index).observed()))
}

/// Whose hours people and doors have.
fn hours(survey: &Survey, is_chosen: bool) -> String {
    let (last, zone) = (survey.logs().len(), survey.settings_of(0).mapper.time_zone.unwrap_or_default());
    match survey.undated(last) {
        Some(log) => format!("none: {} does not say when it was recorded", log.name),
        None if zone == "UTC" && !is_chosen => "UTC (--time-zone gives those of the place)".to_owned(),
        None => zone,
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let per_scan_ms = self.wall_s * 1e3 / self.scans.max(1) as f64;
        let seconds = |duration_s| format!("{duration_s:.0} s");
        let duration = self.duration_s.map_or("an unknown time".to_owned(), seconds);
        writeln!(f, "{}: {} scans in {duration}", list(&self.logs), self.scans)?;
        writeln!(f, "  map       {}", self.verdict.name())?;
        for reason in &self.verdict_reasons {
            writeln!(f, "            - {reason}")?;
        }
        let pose = match self.settings.pose {
            PoseMode::Exact => "poses of the log",
            PoseMode::Odometry => "odometry, with its drift",
            PoseMode::Localized => "localized",
            PoseMode::Corrected => "corrected by another SLAM",
        };
        writeln!(
            f,
            "  route     {:.0} m, {pose}, {} places recognized, {} scans left out",
            self.trajectory_m, self.loops, self.scans_left_out
        )?;
        writeln!(f, "  seen      {:.0} m², {} of it changed", self.seen_m2, percent(self.changed_share))?;
        writeln!(f, "  changes   {}, counted cell by cell, in {} places", self.changes, self.place_count)?;
        for place in self.places.iter().take(3) {
            let rate = how_often(place).map(|rate| format!(", {rate}")).unwrap_or_default();
            let name = place.name.as_ref().map(|name| format!("{}, ", printable(name))).unwrap_or_default();
            writeln!(f, "    {}.      {name}at ({:.1}, {:.1}) m{rate}", place.number, place.x_m, place.y_m)?;
        }
        writeln!(f, "  hours     {}", self.hours)?;
        if let Some(why) = &self.rates_withheld {
            writeln!(f, "  rates     withheld: {why}")?;
        }
        write!(f, "  time      {:.1} s, {per_scan_ms:.2} ms per scan", self.wall_s)
    }
}

//! The logs of one place, in the order of their times.

use anyhow::{bail, ensure};
use cli::progress::Progress;
use cli::terminal::note;
use interfaces::printable;
use logs::{Log, TopicChoice};
use std::path::{Path, PathBuf};
use survey::{LogEntry, Survey};

/// The time between two logs whose times do not say it, s.
const UNKNOWN_GAP_S: f64 = 3600.0;

/// A log that was given.
#[derive(Clone)]
pub(crate) struct Source {
    pub(crate) log: Log,
    pub(crate) entry: LogEntry,
}

/// Opens all logs, and puts them in the order of their times. Notes go to the error output. `is_kept`: whether a log must
/// be recognized in a later run.
pub(crate) fn open(files: &[PathBuf], choice: &TopicChoice, is_kept: bool) -> anyhow::Result<Vec<Source>> {
    let open = |file: &PathBuf| {
        let busy = || Progress::of_work(format!("reading {}", file.display()));
        let reading = busy();
        let log = Log::open(file, choice);
        drop(reading);
        let log = log?;
        log.summary().notes.iter().for_each(|what| note(format_args!("{}: {what}", file.display())));
        if let Some(why) = &log.summary().impossible {
            bail!("{}: {why}", file.display());
        }
        let mut entry = LogEntry::of(short_name(file), &log, choice)?;
        if is_kept || files.len() > 1 {
            let _reading = busy();
            entry.recognize(&log)?;
        }
        Ok(Source { log, entry })
    };
    let mut sources = files.iter().map(open).collect::<anyhow::Result<Vec<_>>>()?;
    check_choice(&sources, choice)?;
    if sources.iter().all(|source| source.entry.begin_s.is_some()) {
        let begin_s = |source: &Source| source.entry.begin_s.unwrap_or_default();
        sources.sort_by(|a, b| begin_s(a).total_cmp(&begin_s(b)));
    }
    Ok(sources)
}

/// Topics and frames are those of bags: for CARMEN logs alone, such a choice is an error.
fn check_choice(sources: &[Source], choice: &TopicChoice) -> anyhow::Result<()> {
    let flags = [
        ("--scan-topic", !choice.scan_topics.is_empty()),
        ("--odom-topic", choice.odom_topic.is_some()),
        ("--base-frame", choice.base_frame.is_some()),
        ("--map-frame", choice.map_frame.is_some()),
    ];
    let given = flags.iter().find(|(_, is_given)| *is_given);
    for Source { entry, .. } in sources.iter().filter(|source| source.log.summary().scan_topics.is_empty()) {
        let Some((flag, _)) = given else { continue };
        let what =
            format!("{flag} is for bags, but {} is a CARMEN log, which has no topics and frames", entry.name);
        ensure!(
            sources.iter().any(|other| !other.log.summary().scan_topics.is_empty()),
            "{what}: leave it out"
        );
        note(what);
    }
    Ok(())
}

/// The time of the first reading, in seconds since the epoch; `None` unless every log says when it was recorded.
pub(crate) fn begin_s<'a>(entries: impl Iterator<Item = &'a LogEntry>) -> Option<f64> {
    let begins_s: Option<Vec<f64>> = entries.map(|entry| entry.begin_s).collect();
    begins_s?.first().copied()
}

/// Leaves out what `survey` has learned, and gives every other log its place in time after the logs of the survey. What is
/// left begins with the logs of the survey that were not learned to their end.
///
/// A log that was learned in part and is not given stays so, and nothing can follow it: an error.
pub(crate) fn continued(mut sources: Vec<Source>, survey: &mut Survey) -> anyhow::Result<Vec<Source>> {
    for (number, source) in sources.iter().enumerate() {
        let is_same = |other: &&Source| other.entry.content == source.entry.content;
        let twice = sources[..number].iter().find(is_same).filter(|_| source.entry.content != 0);
        ensure!(
            twice.is_none(),
            "{} is given twice: it has the content of {}",
            source.entry.name,
            twice.map_or("", |twice| &twice.entry.name)
        );
    }
    for log in survey.logs() {
        let (name, used, all) = (&log.entry.name, log.used, log.readings);
        let given = sources.iter().find(|source| source.entry.content == log.entry.content);
        match given {
            _ if log.is_finished() || used == 0 => {}
            Some(source) => ensure!(
                source.entry.choice == log.entry.choice,
                "{name}: {used} of its {all} scans are learned with other --scan-topic, --odom-topic, --base-frame or --map-frame"
            ),
            None => bail!(
                "{name} is learned in part ({used} of {all} scans): give it as well, then it goes on from there, or take it \
                 out of the state by state_file remove"
            ),
        }
    }
    sources.retain(|source| {
        let mut learned = survey.logs().iter().filter(|log| log.is_finished());
        let is_learned = learned.any(|log| log.entry.content == source.entry.content);
        if is_learned {
            note(format_args!("{} is learned already", source.entry.name));
        }
        !is_learned
    });
    if sources.is_empty() {
        let shown = "the results show what was learned before, without a trajectory";
        note(format_args!("nothing is added; {shown}"));
    }
    // Routes that were found hold for the same logs in the same order.
    let begun = survey.logs().iter().take_while(|log| log.used > 0).count();
    let learned = survey.logs().iter().take_while(|log| log.is_finished()).count();
    let mut kept = learned;
    while let (Some(log), Some(source)) = (survey.logs().get(kept), sources.get_mut(kept - learned)) {
        if log.entry.content != source.entry.content || log.entry.choice != source.entry.choice {
            break;
        }
        source.entry = log.entry.clone();
        kept += 1;
    }
    if kept < begun {
        let name = &survey.logs()[kept].entry.name;
        bail!("{name} is learned in part: no log can begin before it");
    }
    for log in survey.logs().iter().skip(kept) {
        // Its run ended between both passes. A log that is given again finds its place anew.
        if !sources.iter().any(|source| source.entry.content == log.entry.content) {
            let name = &log.entry.name;
            note(format_args!(
                "{name} is left out: its run ended before anything was learned of it; give it again"
            ));
        }
    }
    survey.forget_from(kept);
    let mut before: Vec<LogEntry> = survey.logs().iter().map(|log| log.entry.clone()).collect();
    for source in &mut sources[kept - learned..] {
        place(&mut source.entry, &before)?;
        before.push(source.entry.clone());
    }
    Ok(sources)
}

/// Gives a log its place in time after other logs.
fn place(entry: &mut LogEntry, before: &[LogEntry]) -> anyhow::Result<()> {
    let (Some(first), Some(last)) = (before.first(), before.last()) else { return Ok(()) };
    let repeated = before.iter().find(|other| entry.repeats(other)).map(|other| &other.name);
    if let Some(repeated) = repeated {
        bail!(
            "{} and {repeated} have the same scans, which would count twice: leave one of them out",
            entry.name
        );
    }
    let known = entry.begin_s.zip(first.begin_s).map(|(begin_s, first_s)| begin_s - first_s);
    entry.offset_s = match known {
        Some(offset_s) if offset_s >= last.end_s() => offset_s,
        Some(_) => {
            bail!("{} begins before {} has ended: logs of one robot follow each other", entry.name, last.name)
        }
        None => {
            let note = format!(
                "the time between {} and {} is not known and counts as an hour",
                last.name, entry.name
            );
            add_note(&mut entry.notes, note);
            last.end_s() + UNKNOWN_GAP_S
        }
    };
    if entry.laser != first.laser {
        let note = format!(
            "the laser of {} is not that of {}: {}, not {}; where it sees another plane, differences count as changes",
            entry.name, first.name, entry.laser, first.laser
        );
        add_note(&mut entry.notes, note);
    }
    Ok(())
}

fn add_note(notes: &mut Vec<String>, what: String) {
    note(&what);
    notes.push(what);
}

fn short_name(file: &Path) -> String {
    printable(&file.file_name().unwrap_or(file.as_os_str()).to_string_lossy()).into_owned()
}

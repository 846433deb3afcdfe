//! The logs of one place, in the order of their times.

use curious::terminal::say;
use logs::{Log, TopicChoice};
use std::io::stderr;
use std::path::{Path, PathBuf};

/// The time between two logs whose times do not say it, s.
const UNKNOWN_GAP_S: f64 = 3600.0;

/// A log with its place in time.
pub(crate) struct Source {
    /// The name of the file or folder.
    pub(crate) name: String,
    pub(crate) log: Log,
    /// The time of its first reading, s after that of the first log.
    pub(crate) offset_s: f64,
    /// What is not known about the time before it.
    pub(crate) gap_note: Option<String>,
}

impl Source {
    /// Whether the laser stands.
    pub(crate) fn stands(&self) -> bool {
        self.log.summary().stands
    }

    /// What was repaired, left out or assumed, each a sentence.
    pub(crate) fn notes(&self) -> impl Iterator<Item = &String> {
        self.log.summary().notes.iter().chain(&self.gap_note)
    }
}

/// Opens all logs. Notes go to the error output.
pub(crate) fn open(files: &[PathBuf], choice: &TopicChoice) -> anyhow::Result<Vec<Source>> {
    let open = |file: &PathBuf| {
        let log = Log::open(file, choice)?;
        log.summary()
            .notes
            .iter()
            .for_each(|note| say(stderr(), format_args!("note: {}: {note}", file.display())));
        Ok(Source { name: short_name(file), log, offset_s: 0.0, gap_note: None })
    };
    let mut sources = files.iter().map(open).collect::<anyhow::Result<Vec<_>>>()?;
    let begin_s = |source: &Source| source.log.summary().begin_s;
    if sources.iter().all(|source| begin_s(source).is_some()) {
        sources.sort_by(|a, b| begin_s(a).unwrap_or_default().total_cmp(&begin_s(b).unwrap_or_default()));
    }
    for later in 1..sources.len() {
        let (before, source) = (&sources[later - 1], &sources[later]);
        let end_s = before.offset_s + before.log.summary().duration_s;
        let known = begin_s(source).zip(begin_s(&sources[0])).map(|(begin_s, first_s)| begin_s - first_s);
        let (offset_s, gap_note) = match known {
            Some(offset_s) if offset_s >= end_s => (offset_s, None),
            Some(_) => anyhow::bail!(
                "{} begins before {} has ended: logs of one robot follow each other",
                source.name,
                before.name
            ),
            None => {
                let note = format!(
                    "the time between {} and {} is not known and counts as an hour",
                    before.name, source.name
                );
                say(stderr(), format_args!("note: {note}"));
                (end_s + UNKNOWN_GAP_S, Some(note))
            }
        };
        (sources[later].offset_s, sources[later].gap_note) = (offset_s, gap_note);
    }
    Ok(sources)
}

fn short_name(file: &Path) -> String {
    file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}

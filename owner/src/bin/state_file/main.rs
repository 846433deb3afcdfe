//! Shows what a state file holds, and removes a log from it.

use anyhow::{Context, anyhow, bail, ensure};
use clap::{Parser, Subcommand};
use cli::program::{Failure, input, start};
use cli::terminal::print;
use owner::words::{date, length_of, list};
use robot::state::{Facts, State, StateFile, earlier_name, read_state};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use survey::{SavedLogs, SurveyedLog};

/// Shows what a state file holds (`--state` of map_log, four_rooms and curious_node), and removes a log from it.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "state_file",
    version,
    max_term_width = 100,
    after_help = "Examples:\n  \
        state_file show office.state                  the logs, their dates, the settings\n  \
        state_file remove office.state tuesday.mcap   the state as it was before tuesday.mcap\n\n\
        Exit codes: 0 success, 1 the file cannot be written, 2 invalid arguments or input, or a log that cannot be removed."
)]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Clone, Debug, Subcommand)]
enum Command {
    /// Print what a state holds: logs with their dates, parts, settings
    Show {
        /// The state file
        file: PathBuf,
    },
    /// Remove a log: the state is as it was before the run that added it
    ///
    /// What was learned from several logs is one map, from which no log can be taken out. But map_log keeps the state as it
    /// was before the last run that added a log (FILE.earlier): the last log can be removed if that run added it alone.
    Remove {
        /// The state file
        file: PathBuf,

        /// The name of the log, as `show` prints it; a path counts as the name at its end
        log: PathBuf,
    },
}

fn main() -> ExitCode {
    start(|args: &Args| match &args.command {
        Command::Show { file } => show(file),
        Command::Remove { file, log } => remove(file, log),
    })
}

fn show(file: &Path) -> Result<ExitCode, Failure> {
    let state = read(file).map_err(input)?;
    print(file.display())?;
    for log in logs(&state).map_err(input)?.iter().flat_map(SavedLogs::logs) {
        let entry = &log.entry;
        let begin = entry.begin_s.map_or("at an unknown time".to_owned(), date);
        let (length, used, all) = (length_of(entry.duration_s), log.used, log.readings);
        print(format_args!(
            "  log {}: {begin}, {length}, {used} of {all} scans learned, {}",
            entry.name, entry.laser
        ))?;
        entry.notes.iter().try_for_each(|note| print(format_args!("    note: {note}")))?;
    }
    if let Ok(removable) = removable(file, &state) {
        print(format_args!("  can be removed: {removable}"))?;
    }
    for (name, facts, bytes) in state.sections() {
        print(format_args!("  part {name}: {} bytes", bytes.len()))?;
        facts.iter().try_for_each(|(name, value)| print(format_args!("    {name} = {value}")))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn remove(file: &Path, log: &Path) -> Result<ExitCode, Failure> {
    // As map_log names logs.
    let log = &*log.file_name().unwrap_or(log.as_os_str()).to_string_lossy();
    let locked = StateFile::open(file).with_context(|| format!("{}: cannot use it", file.display()));
    let locked = locked.map_err(input)?; // before it is read
    let state = read(file).map_err(input)?;
    check_removable(file, &state, log).map_err(input)?;
    locked.restore_earlier().with_context(|| format!("cannot write {}", file.display()))?;
    print(format_args!("{log} is removed: {} is as it was before", file.display()))?;
    Ok(ExitCode::SUCCESS)
}

fn read(file: &Path) -> anyhow::Result<State> {
    read_state(file).map_err(|why| anyhow!("{}: {why}", file.display()))
}

/// The logs in a state, or none if it is not one of logs.
fn logs(state: &State) -> anyhow::Result<Option<SavedLogs>> {
    if !state.has(SavedLogs::PART) {
        return Ok(None);
    }
    let logs = SavedLogs::read(state.section(SavedLogs::PART, &Facts::default())?);
    logs.map(Some).map_err(|_| anyhow!("the logs in the state do not fit this program"))
}

fn names(logs: &[SurveyedLog]) -> Vec<String> {
    logs.iter().map(|log| log.entry.name.clone()).collect()
}

fn check_removable(file: &Path, state: &State, log: &str) -> anyhow::Result<()> {
    let name = file.display();
    let Some(logs) = logs(state)? else { bail!("{name} holds no logs, but the run of one robot") };
    let all = names(logs.logs());
    ensure!(all.iter().any(|other| other == log), "{name} holds no log {log}, but {}", list(&all));
    ensure!(all.len() > 1, "{log} is the only log in {name}: remove the file");
    let why = "what was learned from all logs is one map";
    let way_out = "map the other logs into a new file by map_log --state";
    let removable = removable(file, state);
    match removable {
        Ok(removable) if removable == log => Ok(()),
        Ok(removable) => {
            bail!("{log} cannot be removed: {why}, and only {removable} was added last; {way_out}")
        }
        Err(problem) => bail!("{log} cannot be removed: {why}, and {problem}; {way_out}"),
    }
}

/// The log that was added last, if the state before it was kept.
fn removable(file: &Path, state: &State) -> anyhow::Result<String> {
    let earlier = read_state(&earlier_name(file)).map_err(|_| anyhow!("no earlier state was kept"))?;
    let [now, before] = [state, &earlier].map(|state| logs(state).ok().flatten());
    let content = |logs: &[SurveyedLog]| logs.iter().map(|log| log.entry.content).collect::<Vec<_>>();
    let (Some(now), Some(before)) = (now, before) else { bail!("the earlier state holds no logs") };
    match now.logs().split_last() {
        Some((last, rest)) if content(rest) == content(before.logs()) => Ok(last.entry.name.clone()),
        Some(_) if content(now.logs()) == content(before.logs()) => {
            bail!("a run that was killed before it added a log has replaced the earlier state")
        }
        _ => bail!("the run that was the last one added several"),
    }
}

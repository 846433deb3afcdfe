//! Shows what a state file holds, and removes its last session.

use anyhow::{Context, anyhow, bail, ensure};
use clap::{Parser, Subcommand};
use cli::program::{Failure, input, start};
use cli::terminal::print;
use interfaces::printable;
use owner::words::{date, length_of, list};
use robot::state::{SavedSettings, State, StateFile, earlier_name, read_state};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use survey::Forecast;

/// Shows what a state file holds (`--state` of map_log, four_rooms and curious_node), and removes its last session.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "state_file",
    version,
    max_term_width = 100,
    after_help = "Examples:\n  \
        state_file show office.state                  the sessions, their dates, the doors, the places\n  \
        state_file remove office.state tuesday.mcap   the state as it was before tuesday.mcap\n\n\
        Exit codes: 0 success, 1 the file cannot be written, 2 invalid arguments or input, or a session that cannot be removed."
)]
struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Clone, Debug, Subcommand)]
enum Command {
    /// Print what a state holds: sessions (logs and runs of robots) with their dates, doors, places
    Show {
        /// The state file
        file: PathBuf,

        /// Also print the settings with which it was learned
        #[arg(long)]
        settings: bool,
    },
    /// Remove the last session: the state is as it was before the run that added it
    ///
    /// What was learned from several sessions is one map, from which no session can be taken out. But a program keeps the state as
    /// it was before the last run that added a session (FILE.earlier): it can be removed if that run added it alone.
    Remove {
        /// The state file
        file: PathBuf,

        /// The name of the session, as `show` prints it; a path counts as the name at its end
        log: PathBuf,
    },
}

fn main() -> ExitCode {
    start(|args: &Args| match &args.command {
        Command::Show { file, settings } => show(file, *settings),
        Command::Remove { file, log } => remove(file, log),
    })
}

fn show(file: &Path, settings: bool) -> Result<ExitCode, Failure> {
    let state = read(file).map_err(input)?;
    print(file.display())?;
    for session in &state.sessions {
        let begin = session.begin_s.map_or("at an unknown time".to_owned(), date);
        let (length, [used, all]) = (length_of(session.duration_s), session.readings);
        let laser = if session.laser.is_empty() { String::new() } else { format!(", {}", session.laser) };
        print(format_args!("  {}: {begin}, {length}, {used} of {all} scans learned{laser}", session.name))?;
        session.notes.iter().try_for_each(|note| print(format_args!("    note: {note}")))?;
    }
    if let Ok(forecast) = Forecast::of_state(&state) {
        for door in forecast.mapper().doors() {
            let at = door.closed.ends[0];
            print(format_args!("  door {} at {:.1},{:.1}", door.id, at.x, at.y))?;
        }
        for place in forecast.places() {
            let name = place.name.as_deref().map(|name| format!(", {name}")).unwrap_or_default();
            print(format_args!("  place {}{name}", place.number))?;
        }
    }
    if let Ok(removable) = removable(file, &state) {
        print(format_args!("  can be removed: {removable}"))?;
    }
    let of_map = state.map.iter().map(|map| &map.settings);
    let parts = state.survey.iter().chain(&state.run).chain([&state.localization]).map(|part| &part.settings);
    for (name, value) in of_map.chain(parts).filter(|_| settings).flat_map(SavedSettings::fields) {
        print(format_args!("  {name} = {value}"))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn remove(file: &Path, log: &Path) -> Result<ExitCode, Failure> {
    // As map_log names logs.
    let log = log.file_name().unwrap_or(log.as_os_str()).to_string_lossy();
    let log = &*printable(&log);
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

fn names(state: &State) -> Vec<String> {
    state.sessions.iter().map(|session| session.name.clone()).collect()
}

fn check_removable(file: &Path, state: &State, log: &str) -> anyhow::Result<()> {
    let name = file.display();
    let all = names(state);
    ensure!(all.iter().any(|other| other == log), "{name} holds no session {log}, but {}", list(&all));
    ensure!(all.len() > 1, "{log} is the only session in {name}: remove the file");
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

/// The session that was added last, if the state before it was kept.
fn removable(file: &Path, state: &State) -> anyhow::Result<String> {
    let earlier = read_state(&earlier_name(file)).map_err(|_| anyhow!("no earlier state was kept"))?;
    let [now, before] = [state, &earlier].map(names);
    match now.split_last() {
        Some((last, rest)) if rest == before => Ok(last.clone()),
        Some(_) if now == before => {
            bail!("a run that was killed before it added a session has replaced the earlier state")
        }
        _ => bail!("the run that was the last one added several"),
    }
}

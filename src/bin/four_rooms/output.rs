//! What a run shows while it goes on, and the files that it leaves.

use crate::Ended;
use crate::args::{Args, DriveChoice};
use crate::parts::TrialStateFile;
use anyhow::Context;
use cli::bag::RunBag;
use cli::program::{Failure, arguments, input, not_opened, results_folder};
use cli::progress::Progress;
use cli::terminal::{note, print_lines, say, tell};
use draw::Film;
use draw::layers::Layer;
use draw::pictures::FIGURE_5_FILE;
use draw::scene::Scene;
use draw::view::Measured;
use evaluation::metrics::map_scores;
use evaluation::physics_trial::PhysicsTrial;
use evaluation::scenes::{Displayed, view};
use evaluation::summary::{SCHEMA, Summary};
use files::{RunFolder, UnfinishedFile, write_file};
use interfaces::{LaserReading, Twist, World};
use mapper::Mapper;
use results::thinned::Goals;
use results::{TrajectoryFile, cell_statistics, file_name, ros_map, things};
use robot::{BUILD, Pilot, Robot, Settings, Turn};
use sim::physics::WorldSpec;
use std::io::stderr;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use viewer::recording::{Live, Recorder};
use viewer::show::Show;

/// The file that ends a run.
const SUMMARY: &str = "summary.json";
/// The longest time for which a run that keeps to real time does not look for Ctrl-C.
const NAP: Duration = Duration::from_millis(50);

/// Everything that a run shows and writes.
pub(crate) struct Outputs<'a> {
    args: &'a Args,
    /// The simulated time at which the run goes on, s.
    began_s: f64,
    folder: RunFolder,
    bag: Option<RunBag>,
    show: Show,
    /// The trajectories as the robot knew it and as it was.
    trajectories: [TrajectoryFile; 2],
    state_file: Option<TrialStateFile>,
    progress: Progress,
    /// Why no viewer shows the run, as far as it was reported.
    reported: Option<String>,
    is_complete: bool,
}

impl<'a> Outputs<'a> {
    /// Opens all files.
    pub(crate) fn open(
        args: &'a Args,
        spec: &WorldSpec,
        state_file: Option<TrialStateFile>,
        began_s: f64,
    ) -> Result<Self, Failure> {
        let mut folder = results_folder(&args.out)?;
        args.mcap.as_ref().map_or(Ok(()), |path| folder.adopt(path, "mcap")).map_err(input)?;
        let bag = args.mcap.as_deref().map(|path| RunBag::create(path, 0.0)).transpose();
        let bag = bag.context("cannot write the bag of --mcap").map_err(input)?;
        let show = show(args, spec.scene(), &mut folder)?;
        let file = |name| TrajectoryFile::create(&folder.unfinished().join(name));
        let trajectories = ["trajectory.tum", "trajectory_true.tum"].map(file);
        let reported = show.live_problem();
        if let Some(problem) = &reported {
            note(problem);
        }
        if began_s > 0.0 {
            tell(format_args!("the run goes on from {began_s:.1} s"));
        }
        let progress = Progress::of_time(args.duration).from(began_s);
        let is_complete = true;
        Ok(Self {
            args,
            began_s,
            folder,
            bag,
            show,
            trajectories,
            state_file,
            progress,
            reported,
            is_complete,
        })
    }

    /// Shows one turn.
    pub(crate) fn add(
        &mut self,
        trial: &mut PhysicsTrial<impl Pilot<Command = Twist>>,
        turn: &Turn<LaserReading, Twist>,
        is_last: bool,
    ) {
        let raw = self.bag.as_ref().map(|_| trial.world.sense());
        let PhysicsTrial { world, robot: Robot { mapper, pilot, .. }, observer, .. } = trial;
        let time_s = turn.reading.time_s;
        self.progress.show(time_s, || map_scores(mapper, world.truth()).coverage);
        for (bag, raw) in self.bag.iter_mut().zip(&raw) {
            bag.add(raw, turn, mapper, pilot);
        }
        let [used, truth] = &mut self.trajectories;
        used.add(time_s, &turn.belief.pose);
        truth.add(time_s, world.true_pose());
        let measured = Measured {
            coverage_and_quality: observer.scores().map(|scores| [scores.coverage, scores.map_quality]),
            messages: &observer.messages,
        };
        if let Err(problem) = self.show.add(&view(world, turn, mapper, pilot, measured), is_last) {
            self.is_complete = false;
            self.progress.say(format_args!("error: {problem}; the run goes on without it"));
        }
    }

    /// Saves the state, if it is time to.
    pub(crate) fn save(&mut self, trial: &mut PhysicsTrial<impl Pilot<Command = Twist>>) {
        if let Some(state_file) = self.state_file.as_mut().filter(|file| file.is_due())
            && let Err(problem) = state_file.save(trial)
        {
            self.is_complete = false;
            self.progress.say(format_args!("error: cannot save the state: {problem}; the run goes on"));
        }
    }

    /// Waits until a simulated time is due, in short naps: an interrupted run ends soon.
    pub(crate) fn keep_pace(&self, time_s: f64, start: Instant, is_interrupted: &AtomicBool) {
        if self.args.speed.is_infinite() {
            return;
        }
        let due = Duration::from_secs_f64((time_s - self.began_s).max(0.0) / self.args.speed);
        while start.elapsed() < due && !is_interrupted.load(Ordering::Relaxed) {
            std::thread::sleep(due.saturating_sub(start.elapsed()).min(NAP));
        }
    }

    /// Writes all results. Returns whether everything could be shown.
    pub(crate) fn finish(
        mut self,
        settings: &Settings,
        mut trial: PhysicsTrial<impl Pilot<Command = Twist>>,
        ended: Ended,
        wall_s: f64,
    ) -> anyhow::Result<bool> {
        drop(self.progress);
        if let Some(problem) =
            self.show.live_problem().filter(|problem| Some(problem) != self.reported.as_ref())
        {
            note(problem);
        }
        let mut failures = Vec::new();
        if let Some(Err(problem)) = self.state_file.take().map(|file| file.finish(&mut trial)) {
            failures.push(format!("cannot save the state: {problem}"));
        }
        if let Some(Err(problem)) = self.bag.take().map(RunBag::finish) {
            failures.push(format!("cannot write the bag: {problem:#}"));
        }
        for problem in self.trajectories.into_iter().filter_map(|file| file.finish().err()) {
            failures.push(format!("cannot write a trajectory: {problem}"));
        }
        failures.iter().for_each(|failure| say(stderr(), format_args!("error: {failure}")));

        let (args, mut summary) =
            (self.args, summary(self.args, settings, &trial, ended, self.began_s, wall_s));
        let PhysicsTrial { robot: Robot { mapper, pilot, .. }, observer, .. } = trial;
        drop(pilot); // restores the terminal before anything is printed
        write(&self.folder, &mapper, &self.show, &observer.goals, &mut summary)?;
        if let Err(problem) = self.show.write_film() {
            say(stderr(), format_args!("error: {problem}"));
            failures.push(problem.to_string());
        }
        let read = [Some(args.world.as_ref()), args.map.as_deref(), args.tour.as_deref()];
        self.folder.finish(&read.into_iter().flatten().collect::<Vec<&Path>>())?;
        let (out, picture) = (args.out.display(), args.out.join(FIGURE_5_FILE));
        print_lines(format_args!("{summary}\n  files     {out}: open {}", picture.display()))?;
        Ok(self.is_complete && failures.is_empty())
    }
}

/// Opens everything that shows the run: the recording, viewers, the moving picture.
fn show(args: &Args, scene: Scene, folder: &mut RunFolder) -> Result<Show, Failure> {
    for (path, ending) in [(&args.rrd, "rrd"), (&args.gif, "gif")] {
        path.as_ref().map_or(Ok(()), |path| folder.adopt(path, ending)).map_err(input)?;
    }
    let mut live = Vec::from_iter(args.connect.clone());
    live.extend(args.view.then_some(Live::Spawn));
    let named = || folder.reserve(&format!("{}.rrd", file_name::of(&scene.title)));
    let file = (!args.no_rrd).then(|| args.rrd.clone().map_or_else(named, Ok)).transpose()?;
    let [file, gif] = [&file, &args.gif].map(|path| path.as_deref().map(UnfinishedFile::create).transpose());
    let (file, gif) = (file.map_err(not_opened)?, gif.map_err(not_opened)?);
    let recorder = match file {
        None if live.is_empty() => None,
        file => Some(Recorder::new(file, &live, scene.clone()).map_err(anyhow::Error::from)?),
    };
    let film = gif.map(|file| Film::new(file, scene.clone(), args.duration));
    Ok(Show::new(scene, recorder, film))
}

/// Writes everything except the recording and the moving picture: no result is lost for them.
fn write(
    folder: &RunFolder,
    mapper: &Mapper,
    show: &Show,
    goals: &Goals,
    summary: &mut Summary,
) -> anyhow::Result<()> {
    let to = folder.unfinished();
    show.write_pictures(to, mapper, goals, &Layer::ALL)?;
    ros_map::write(to, "map", mapper.states())?;
    cell_statistics::write(&to.join("cell_statistics.csv"), mapper)?;
    things::write(&to.join("things.json"), mapper)?;
    summary.files = folder.results()?;
    let text = serde_json::to_string_pretty(summary)?;
    write_file(&to.join(SUMMARY), |file| writeln!(file, "{text}"))?;
    Ok(())
}

fn summary(
    args: &Args,
    settings: &Settings,
    trial: &PhysicsTrial<impl Pilot<Command = Twist>>,
    ended: Ended,
    began_s: f64,
    wall_s: f64,
) -> Summary {
    let simulated_s = trial.robot.mapper.time();
    Summary {
        schema: SCHEMA,
        build: BUILD,
        version: env!("CARGO_PKG_VERSION"),
        arguments: arguments(),
        settings: serde_json::to_value(settings).unwrap_or_default(),
        world: trial.world.spec().name.clone(),
        seed: args.seed,
        drive: args.drive.name(),
        strategy: (args.drive == DriveChoice::Agent).then(|| args.strategy().name()),
        estimator: args.estimator.name(),
        occupancy: args.occupancy.name(),
        ended_by: match ended {
            Ended::Duration => "duration",
            Ended::Pilot => "tour",
            Ended::Interrupted => "interrupted",
        },
        simulated_s,
        wall_s,
        real_time_factor: (simulated_s - began_s) / wall_s.max(f64::MIN_POSITIVE),
        files: Vec::new(),
        results: trial.results(),
    }
}

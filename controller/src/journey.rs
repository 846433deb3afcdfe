use crate::settings::PatienceSettings;
use crate::{Drive, Path, Planner, Reach, Restless, Scene, Situation};
use nalgebra::Point2;

/// A recovery farther away than this from the last one is the first at its place, m.
const SAME_PLACE_M: f64 = 1.0;
/// A path that ends this much farther from the goal than an earlier one is worse, m.
const WORSE_M: f64 = 0.1;

/// What the robot knows of its surroundings for driving.
#[derive(Clone, Debug)]
pub(crate) struct Surroundings {
    pub(crate) planner: Planner,
    pub(crate) restless: Restless,
}

impl Surroundings {
    pub(crate) fn scene<'a>(&'a self, situation: &'a Situation<'a>) -> Scene<'a> {
        Scene { situation, costmap: self.planner.costmap(), restless: &self.restless }
    }
}

/// How far a journey is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Progress<Command> {
    /// On the way, with the next command.
    Underway(Command),
    /// The robot is at the end of its path.
    Arrived(Reach),
    /// The robot got nowhere, or it took too long.
    GivenUp,
}

/// The way to one place: plans it, plans it anew when it must be, waits, gets free, gives up.
#[derive(Clone, Debug)]
pub(crate) struct Journey {
    target: Point2<f64>,
    from: Point2<f64>,
    /// The journey ends when the robot has come this far, m.
    stride_m: f64,
    limit_s: f64,
    began_s: f64,
    planned_at_s: f64,
    reach: Option<Reach>,
    /// The nearest to the target that a path has led, m.
    best_short_m: f64,
    waits_until_s: Option<f64>,
    /// Where the robot was when it last got somewhere, and when.
    anchor: (Point2<f64>, f64),
    recoveries: u32,
    recovery_at: Point2<f64>,
    recovering_since_s: Option<f64>,
}

impl Journey {
    /// A journey from where the robot is to `target`, or until it has come `stride_m` along the
    /// way, given up after `limit_s`.
    pub(crate) fn new(situation: &Situation, target: Point2<f64>, stride_m: f64, limit_s: f64) -> Self {
        let (position, time) = (situation.position(), situation.time);
        Self {
            target,
            from: position,
            stride_m,
            limit_s,
            began_s: time,
            planned_at_s: f64::NEG_INFINITY,
            reach: None,
            best_short_m: f64::INFINITY,
            waits_until_s: None,
            anchor: (position, time),
            recoveries: 0,
            recovery_at: position,
            recovering_since_s: None,
        }
    }

    /// Where the journey leads.
    pub(crate) fn target(&self) -> &Point2<f64> {
        &self.target
    }

    /// How long it has taken, s.
    pub(crate) fn elapsed_s(&self, situation: &Situation) -> f64 {
        situation.time - self.began_s
    }

    /// One tick: how far it is, and what to do.
    pub(crate) fn drive<D: Drive>(
        &mut self,
        patience: &PatienceSettings,
        situation: &Situation,
        surroundings: &mut Surroundings,
        path: &mut Path,
        drive: &mut D,
    ) -> Progress<D::Command> {
        if self.elapsed_s(situation) >= self.limit_s {
            return Progress::GivenUp;
        }
        let position = situation.position();
        let off_path_m = path.advance(&position);
        if self.must_plan(patience, situation, &surroundings.planner, off_path_m) {
            self.plan(patience, situation, &mut surroundings.planner, path);
        }
        let scene = surroundings.scene(situation);
        if self.waits(situation) {
            self.anchor = (position, situation.time);
            let may_stay = scene.costmap.is_open(scene.costmap.frame().cell_at(&position));
            let command = if may_stay { drive.rest(&scene) } else { drive.follow(&scene, path) };
            return Progress::Underway(command);
        }
        if let Some(reach) = self.reach.filter(|_| path.left_m(&position) <= drive.body().tolerance_m) {
            return Progress::Arrived(reach);
        }
        if !self.keeps_trying(patience, situation) {
            return Progress::GivenUp;
        }
        if let Some(since_s) = self.recovering_since_s {
            if let Some(command) = drive.recover(&scene, situation.time - since_s) {
                return Progress::Underway(command);
            }
            self.recovering_since_s = None;
            self.anchor = (position, situation.time);
            // A recovery has left the path: plan from where it ended.
            self.planned_at_s = f64::NEG_INFINITY;
            self.reach = None;
        }
        Progress::Underway(drive.follow(&scene, path))
    }

    /// Whether the robot waits for the way to open. Having waited in vain it makes do with what is
    /// left.
    fn waits(&mut self, situation: &Situation) -> bool {
        let waits = self.waits_until_s.is_some_and(|until_s| situation.time < until_s);
        if !waits && self.waits_until_s.take().is_some() {
            self.best_short_m = self.reach.map_or(f64::INFINITY, |reach| reach.short_m);
        }
        waits
    }

    fn must_plan(
        &self,
        patience: &PatienceSettings,
        situation: &Situation,
        planner: &Planner,
        off_path_m: f64,
    ) -> bool {
        let since_s = situation.time - self.planned_at_s;
        let lost = self.reach.is_none() || off_path_m > patience.off_path_m;
        planner.path_closed() && since_s >= patience.replan_closed_s
            || (lost || planner.goal_opened()) && since_s >= patience.replan_s
    }

    fn plan(
        &mut self,
        patience: &PatienceSettings,
        situation: &Situation,
        planner: &mut Planner,
        path: &mut Path,
    ) {
        self.planned_at_s = situation.time;
        self.reach = planner.plan(situation.map, &situation.position(), &self.target, path);
        let come_m = (situation.position() - self.from).norm();
        path.truncate((self.stride_m - come_m).max(0.0));
        let Some(reach) = self.reach else { return };
        if reach.short_m <= self.best_short_m + WORSE_M {
            self.waits_until_s = None;
            self.best_short_m = self.best_short_m.min(reach.short_m);
        } else if self.waits_until_s.is_none() && self.stride_m.is_infinite() {
            // What closed the way may open it again. A step is not worth the wait.
            self.waits_until_s = Some(situation.time + patience.wait_s);
        }
    }

    /// Notes whether the robot gets anywhere, and starts a recovery if it does not; false when it
    /// has tried often enough.
    fn keeps_trying(&mut self, patience: &PatienceSettings, situation: &Situation) -> bool {
        let position = situation.position();
        if (position - self.anchor.0).norm() > patience.progress_m {
            self.anchor = (position, situation.time);
        }
        let stuck = situation.time - self.anchor.1 >= patience.patience_s;
        if self.recovering_since_s.is_some() || !stuck {
            return true;
        }
        if (position - self.recovery_at).norm() > SAME_PLACE_M {
            self.recoveries = 0;
        }
        self.recovery_at = position;
        self.recoveries += 1;
        self.recovering_since_s = Some(situation.time);
        self.recoveries <= patience.max_recoveries
    }
}

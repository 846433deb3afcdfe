//! Several poses that the robot may have. Driving on decides between them.

use crate::constants::{AMBIGUOUS, EQUAL, FOUND_STD, SAME_POSE, WIDE_GATE_M};
use crate::match_scene::MatchScene;
use crate::matcher::{Prior, difference};
use crate::motion::Motion;
use crate::support::Support;
use nalgebra::{Isometry2, Matrix3};

/// What a score counts at the next scan: about five scans decide.
const SCORE_MEMORY: f64 = 0.8;

/// A pose that the robot may have.
#[derive(Clone, Copy, Debug, serde::Deserialize, serde::Serialize)]
pub(crate) struct Hypothesis {
    pub(crate) pose: Isometry2<f64>,
    pub(crate) covariance: Matrix3<f64>,
    /// The agreement of the last scan.
    pub(crate) support: Support,
    /// The sum of the scores of the last scans.
    score: f64,
}

/// All poses that the robot may have, the best first.
#[derive(Clone, Debug, Default, serde::Deserialize, serde::Serialize)]
pub(crate) struct Hypotheses {
    list: Vec<Hypothesis>,
    /// The number of scans since the search.
    scans: u32,
}

impl Hypotheses {
    /// Refines the poses that a search has found. Poses below `min_score` are dropped.
    pub(crate) fn start(scene: &MatchScene, found: &[Isometry2<f64>], min_score: f64) -> Self {
        let covariance = FOUND_STD.covariance();
        let list = found
            .iter()
            .filter_map(|pose| refine(scene, pose, &covariance, WIDE_GATE_M, 0.0))
            .filter(|hypothesis| hypothesis.score >= min_score)
            .collect();
        let mut hypotheses = Self { list, scans: 0 };
        hypotheses.sort_out();
        hypotheses
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The best pose.
    pub(crate) fn best(&self) -> Option<&Hypothesis> {
        self.list.first()
    }

    /// These and others.
    pub(crate) fn or(mut self, others: Self) -> Self {
        self.list.extend(others.list);
        self.sort_out();
        self
    }

    /// The same poses, of which only the agreement of the last scan counts.
    pub(crate) fn restarted(mut self) -> Self {
        for hypothesis in &mut self.list {
            hypothesis.score = hypothesis.support.score();
        }
        Self { scans: 0, ..self }
    }

    /// Whether a pose is one of them.
    pub(crate) fn contains(&self, pose: &Isometry2<f64>) -> bool {
        self.list.iter().any(|hypothesis| is_same(&hypothesis.pose, pose))
    }

    /// The covariance of the differences between the poses.
    pub(crate) fn spread(&self) -> Matrix3<f64> {
        let Some(best) = self.best() else { return Matrix3::zeros() };
        let square = |hypothesis: &Hypothesis| {
            let off = difference(&hypothesis.pose, &best.pose);
            off * off.transpose() / self.list.len() as f64
        };
        self.list.iter().map(square).sum()
    }

    /// The only pose, once it has agreed with this number of scans after the search.
    pub(crate) fn decided(&self, scans: u32) -> Option<&Hypothesis> {
        if self.scans >= scans && self.list.len() == 1 { self.list.first() } else { None }
    }

    /// Moves all poses.
    pub(crate) fn follow_odometry(&mut self, motion: &Motion) {
        for hypothesis in &mut self.list {
            hypothesis.covariance = motion.propagate(&hypothesis.pose, &hypothesis.covariance);
            hypothesis.pose = motion.apply(&hypothesis.pose);
        }
    }

    /// After this number of scans: of poses with about the same score, the one that is expected is the only one.
    pub(crate) fn prefer(&mut self, scans: u32, is_expected: impl Fn(&Isometry2<f64>) -> bool) {
        let Some(min_score) = self.best().map(|best| best.score * EQUAL) else { return };
        let is_one = |hypothesis: &Hypothesis| hypothesis.score >= min_score && is_expected(&hypothesis.pose);
        if self.scans >= scans
            && let Some(expected) = self.list.iter().copied().find(is_one)
        {
            self.list = vec![expected];
        }
    }

    /// Compares all poses with a scan. Poses below `min_score` are dropped.
    pub(crate) fn compare(&mut self, scene: &MatchScene, min_score: f64) {
        self.scans += 1;
        let next = |Hypothesis { pose, covariance, score, .. }: &Hypothesis| {
            refine(scene, pose, covariance, 2.0 * scene.gate_m(), SCORE_MEMORY * score)
                .filter(|next| next.support.score() >= min_score)
        };
        self.list = self.list.iter().filter_map(next).collect();
        self.sort_out();
    }

    /// Sorts by the score, and drops what is much worse than the best, or the same as a better one.
    fn sort_out(&mut self) {
        self.list.sort_by(|a, b| b.score.total_cmp(&a.score));
        let min_score = self.list.first().map_or(0.0, |best| best.score * AMBIGUOUS);
        let mut kept: Vec<Hypothesis> = Vec::new();
        for hypothesis in self.list.drain(..).filter(|hypothesis| hypothesis.score >= min_score) {
            if !kept.iter().any(|better| is_same(&better.pose, &hypothesis.pose)) {
                kept.push(hypothesis);
            }
        }
        self.list = kept;
    }
}

fn is_same(a: &Isometry2<f64>, b: &Isometry2<f64>) -> bool {
    SAME_POSE.contains(&a.inv_mul(b))
}

/// Matches the scan near a pose.
fn refine(
    scene: &MatchScene,
    pose: &Isometry2<f64>,
    covariance: &Matrix3<f64>,
    first_m: f64,
    score: f64,
) -> Option<Hypothesis> {
    let prior = Prior { pose: *pose, information: covariance.try_inverse()?, begin: None };
    let found = scene.align(pose, Some(&prior), first_m, true)?;
    let support = scene.judge(&found.placement);
    let covariance = found.information.try_inverse()?;
    Some(Hypothesis { pose: found.placement.pose, covariance, support, score: score + support.score() })
}

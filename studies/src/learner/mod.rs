//! A robot that does not know the habits of the things: it learns them, and the hours of the building, from its looks.
//!
//! Each thing has a law over a fixed set of candidate habits and their phases. Whether the building is active or quiet is not
//! known either: it is a hidden state that all things share, with a switch at most every half hour. The law of each
//! thing is kept for both cases, and mixed where the state can have switched (an interacting multiple model filter;
//! Blom and Bar-Shalom, 1988).

mod activity;
mod candidates;
mod track;

use crate::SLOT_STEPS;
use crate::belief::Model;
use crate::calendar::{Hours, Phases};
use activity::Activity;
use candidates::{CANDIDATES, Candidates, Weights, normalized};
use track::Track;

/// The weight of what is plausible anywhere against what was learned in the building, in things.
const PRIOR_THINGS: f64 = 0.3;

/// What a robot has learned about all things of a building.
pub(crate) struct Learner {
    candidates: Candidates,
    tracks: Vec<Track>,
    activity: Activity,
    step: usize,
    /// Whether each thing is a door.
    doors: Vec<bool>,
    /// The probabilities of the candidates of each thing before any look at it.
    priors: Vec<Weights>,
}

impl Learner {
    /// Before any look, on Monday, 0:00.
    pub(crate) fn new(doors: Vec<bool>) -> Self {
        let candidates = Candidates::new();
        let tracks = vec![Track::new(&candidates); doors.len()];
        let priors = vec![[1.0 / CANDIDATES as f64; CANDIDATES]; doors.len()];
        Self { candidates, tracks, activity: Activity::new(), step: 0, doors, priors }
    }

    /// Learns from the other things what is usual in this building: the prior of a thing is the mean of what their looks
    /// alone say. Doors learn from doors, and all else from all else.
    pub(crate) fn learn_priors(&mut self) {
        let active = self.activity.probability();
        let alone = |(track, prior): (&Track, &Weights)| {
            let weights = track.weights(active);
            normalized(std::array::from_fn(|index| weights[index] / prior[index]))
        };
        let alone: Vec<Weights> = self.tracks.iter().zip(&self.priors).map(alone).collect();
        for (thing, prior) in self.priors.iter_mut().enumerate() {
            let mut all = [PRIOR_THINGS / CANDIDATES as f64; CANDIDATES];
            let is_alike = |other: &usize| *other != thing && self.doors[*other] == self.doors[thing];
            for other in (0..alone.len()).filter(is_alike) {
                all.iter_mut().zip(&alone[other]).for_each(|(all, weight)| *all += weight);
            }
            let (before, after) = (*prior, normalized(all));
            *prior = after;
            self.tracks[thing].change_prior(&self.candidates, &before, &after, active);
        }
    }

    /// The number of things.
    pub(crate) fn things(&self) -> usize {
        self.tracks.len()
    }

    /// Lets a step pass.
    pub(crate) fn advance(&mut self) {
        self.step += 1;
        let is_new_slot = self.step.is_multiple_of(SLOT_STEPS);
        let mixing = is_new_slot.then(|| self.activity.next_slot());
        for track in &mut self.tracks {
            track.advance(&self.candidates, self.step, mixing.as_ref());
        }
    }

    /// A look shows the state of a thing.
    pub(crate) fn look(&mut self, thing: usize, is_blocked: bool) {
        let likelihoods = self.tracks[thing].look(&self.candidates, self.step, is_blocked);
        self.activity.look(likelihoods);
    }

    /// The probability that a thing is blocked.
    pub(crate) fn probability(&self, thing: usize) -> f64 {
        let active = self.activity.probability();
        let [quiet, busy] = self.tracks[thing].probabilities(self.step);
        quiet + active * (busy - quiet)
    }

    /// The law of the phases of a thing: that of all candidates together.
    pub(crate) fn phases(&self, thing: usize) -> Phases {
        self.tracks[thing].phases(self.step, self.activity.probability())
    }

    /// The model of a thing for planning, with these hours.
    pub(crate) fn model(&self, thing: usize, hours: Hours) -> Model {
        self.candidates.model(&self.tracks[thing].law(self.activity.probability()), hours)
    }

    /// The half hours of the coming week in which the building will rather be active than quiet.
    pub(crate) fn hours(&self) -> Hours {
        self.activity.forecast()
    }
}

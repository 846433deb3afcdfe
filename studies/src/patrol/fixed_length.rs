use super::view::{Choice, Seen, Strategy, View};
use interfaces::RandomStream;

/// Chooses the next viewpoint of a patrol.
pub(super) trait NextViewpoint {
    /// A viewpoint that the battery allows; `None` if there is none.
    fn next(&mut self, view: &View<'_>, rng: &mut RandomStream) -> Option<usize>;

    fn learn(&mut self, _seen: &Seen<'_>) {}
}

/// Patrols of one length: the robot leaves the dock as soon as the battery is enough for it, and comes back when it is over.
pub(super) struct FixedLength<N> {
    pub(super) next: N,
    /// The length of a patrol, steps.
    pub(super) length: usize,
    /// The end of the patrol, if the robot is on one.
    pub(super) end: Option<usize>,
}

impl<N: NextViewpoint> Strategy for FixedLength<N> {
    fn choose(&mut self, view: &View<'_>, rng: &mut RandomStream) -> Choice {
        if !view.duty.is_always() {
            let missing = self.length as f64 - view.charge_steps;
            if self.end.is_some_and(|end| end <= view.step) {
                self.end = None;
            }
            if self.end.is_none() && (missing > 0.0 || !view.is_docked) {
                return Choice::Rest((missing / view.duty.charge_per_step()).ceil().max(1.0) as usize);
            }
            self.end = self.end.or(Some(view.step + self.length));
        }
        match self.next.next(view, rng) {
            Some(viewpoint) => Choice::Go(viewpoint),
            None => {
                self.end = None;
                Choice::Rest(1)
            }
        }
    }

    fn learn(&mut self, seen: &Seen<'_>) {
        self.next.learn(seen);
    }
}

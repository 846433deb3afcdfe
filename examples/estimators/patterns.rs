//! The times at which a cell is observed.

/// A pattern of observation times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Pattern {
    /// In the first n steps of every m steps.
    Of(u64, u64),
    /// Every `every` steps, until nothing has changed for `calm` steps.
    Stays { every: u64, calm: u64 },
}

impl Pattern {
    pub(crate) const ALL: [Self; 6] = [
        Self::Of(1, 1),
        Self::Of(10, 40),
        Self::Of(3, 50),
        Self::Of(1, 10),
        Self::Of(1, 50),
        Self::Stays { every: 50, calm: 5 },
    ];

    pub(crate) fn name(self) -> String {
        match self {
            Self::Of(1, 1) => "always".to_owned(),
            Self::Of(view, every) => format!("{view} of {every}"),
            Self::Stays { every, calm } => format!("every {every}, until calm for {calm}"),
        }
    }
}

/// The observer of one cell.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Looker {
    /// The step of the last observation, and whether the cell was blocked.
    seen: Option<(u64, bool)>,
    /// The number of steps without a change at the end of this visit.
    calm: u64,
}

impl Looker {
    /// Whether the cell is observed in a step; `shift` moves the pattern in time.
    pub(crate) fn looks(&self, pattern: Pattern, step: u64, shift: u64) -> bool {
        match pattern {
            Pattern::Of(view, every) => (step + shift) % every < view,
            Pattern::Stays { every, calm } => {
                let is_there = self.seen.is_some_and(|(at, _)| at + 1 == step);
                (step + shift).is_multiple_of(every) || is_there && self.calm < calm
            }
        }
    }

    /// Observes the cell. Returns the time since the last observation, and whether the cell was blocked then.
    pub(crate) fn see(&mut self, step: u64, blocked: bool) -> Option<(u64, bool)> {
        let before = self.seen.replace((step, blocked));
        let is_calm = before == step.checked_sub(1).map(|last| (last, blocked));
        self.calm = if is_calm { self.calm + 1 } else { 0 };
        before.map(|(at, was_blocked)| (step - at, was_blocked))
    }
}

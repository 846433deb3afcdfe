use calendar::{Schedule, Timeline};
use interfaces::{Purpose, RandomStream, Values};

/// What a thing with a schedule does, in the time of a world.
#[derive(Clone, Debug)]
pub(crate) struct Routine {
    timeline: Timeline,
    /// The time of the week at the start of the world, s.
    starts_s: f64,
}

impl Routine {
    /// The thing with an index in a world that starts at a time of the week, s.
    pub(crate) fn new(schedule: &Schedule, starts_s: f64, index: usize, seed: u64) -> Self {
        let rng = RandomStream::new(seed, Purpose::Thing(index));
        Self { timeline: schedule.timeline(starts_s, rng), starts_s }
    }

    /// Whether the thing is to be blocked at a time since the start, s, which must not decrease between calls.
    pub(crate) fn is_blocked(&mut self, time_s: f64) -> bool {
        self.timeline.advance(time_s + self.starts_s, |_, _| ());
        self.timeline.is_blocked()
    }

    /// The time of the next change since the start, s; infinite if there is none.
    pub(crate) fn next_s(&self) -> f64 {
        self.timeline.next_event_s() - self.starts_s
    }

    /// The values that a snapshot holds.
    pub(crate) fn values(&mut self) -> Values<'_> {
        self.timeline.values()
    }
}

use calendar::{Schedule, Timeline};
use interfaces::{Purpose, RandomStream, Values, value};
use rand::RngExt;

/// What a thing with a schedule does, in the time of a world.
#[derive(Clone, Debug)]
pub(crate) struct Routine {
    timeline: Timeline,
    /// The time of the week at the start of the world, s.
    starts_s: f64,
    /// The number of its places, and the one where it is, or was last.
    places: usize,
    place: usize,
    rng: RandomStream,
}

impl Routine {
    /// The thing with an index and a number of places in a world that starts at a time of the week, s. It starts at its first
    /// place, or was there last.
    pub(crate) fn new(schedule: &Schedule, starts_s: f64, places: usize, index: usize, seed: u64) -> Self {
        let timeline = schedule.timeline(starts_s, RandomStream::new(seed, Purpose::Thing(index)));
        let rng = RandomStream::new(seed, Purpose::Place(index));
        Self { timeline, starts_s, places, place: 0, rng }
    }

    /// The place where the thing is to be blocked at a time since the start, s, which must not decrease between calls; `None` if
    /// it is to be free. Whenever it comes, it comes to another one of its places.
    pub(crate) fn place(&mut self, time_s: f64) -> Option<usize> {
        let Self { timeline, starts_s, places, place, rng } = self;
        timeline.advance(time_s + *starts_s, |_, is_blocked| {
            if is_blocked && *places > 1 {
                *place = (*place + rng.random_range(1..*places)) % *places;
            }
        });
        timeline.is_blocked().then_some(*place)
    }

    /// Whether the thing is to be blocked at a time since the start, s, as [`Self::place`].
    pub(crate) fn is_blocked(&mut self, time_s: f64) -> bool {
        self.place(time_s).is_some()
    }

    /// The time of the next change since the start, s; infinite if there is none.
    pub(crate) fn next_s(&self) -> f64 {
        self.timeline.next_event_s() - self.starts_s
    }

    /// The values that a snapshot holds.
    pub(crate) fn values(&mut self) -> Values<'_> {
        let mut values = self.timeline.values();
        if self.places > 1 {
            values.extend([value(&mut self.place), value(&mut self.rng)]);
        }
        values
    }
}

use crate::{Localization, Posed};
use interfaces::ValueError;
use mapper::Mapper;

/// A localization that shows every reading to a callback, as its source gave it: before the reading gets its pose.
pub struct Tapped<L: ?Sized, F> {
    show: F,
    inner: Box<L>,
}

impl<L: ?Sized, F> Tapped<L, F> {
    /// `show` is called once per reading.
    pub fn new(inner: Box<L>, show: F) -> Self {
        Self { show, inner }
    }
}

impl<R, L: Localization<R> + ?Sized, F: FnMut(&R)> Localization<R> for Tapped<L, F> {
    fn localize(&mut self, reading: R, mapper: &mut Mapper) -> Posed<R> {
        (self.show)(&reading);
        self.inner.localize(reading, mapper)
    }

    fn snapshot(&mut self) -> Vec<u8> {
        self.inner.snapshot()
    }

    fn restore(&mut self, snapshot: &[u8]) -> Result<(), ValueError> {
        self.inner.restore(snapshot)
    }

    fn begin_session(&mut self) {
        self.inner.begin_session();
    }
}

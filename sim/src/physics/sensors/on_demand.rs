//! Readings that are computed when they are first read.

use super::{Platform, Surroundings};
use crate::physics::rays::{Ring, Vicinity};
use std::sync::{Arc, OnceLock};

/// A robot and its surroundings at the time of a measurement.
#[derive(Clone)]
pub(crate) struct Look {
    pub(crate) platform: Platform,
    pub(crate) surroundings: Arc<Surroundings>,
    vicinity: OnceLock<Vicinity>,
}

impl Look {
    pub(crate) fn new(platform: Platform, surroundings: Arc<Surroundings>) -> Self {
        Self { platform, surroundings, vicinity: OnceLock::new() }
    }

    /// What is around the robot. All sensors of the robot that ask for it must be within `ring`, the same one.
    pub(super) fn vicinity(&self, ring: &Ring) -> &Vicinity {
        let Platform { pose, robot, .. } = &self.platform;
        self.vicinity
            .get_or_init(|| self.surroundings.scene.vicinity(pose.translation.vector.into(), ring, *robot))
    }
}

/// A sensor without its readings.
pub(crate) trait Device {
    /// A reading of the sensor.
    type Reading;
    /// The random streams from which a measurement draws.
    type Streams: Clone;

    /// Measures. The memory of `spare`, an older reading, may be used again.
    fn measure(
        &self,
        look: &Look,
        streams: &mut Self::Streams,
        spare: Option<Self::Reading>,
    ) -> Self::Reading;

    /// Draws what a measurement draws.
    fn skip(&self, streams: &mut Self::Streams);

    /// The time of a reading, s.
    fn time_s(reading: &Self::Reading) -> f64;
}

/// A sensor whose readings are computed when they are first read. A reading has the same bits, whether the readings
/// before were read or not.
#[derive(Clone)]
pub(crate) struct OnDemand<D: Device> {
    pub(super) device: D,
    /// Before the draws of the pending measurement, and of those that were skipped.
    streams: D::Streams,
    /// The number of measurements since that nobody read.
    skipped: u64,
    /// The latest reading; an older one while a measurement is pending.
    reading: Option<D::Reading>,
    pending: Option<Arc<Look>>,
    /// The result of the pending measurement, and the streams after it, as soon as it was read.
    result: OnceLock<(D::Reading, D::Streams)>,
}

impl<D: Device> OnDemand<D> {
    pub(super) fn new(device: D, streams: D::Streams) -> Self {
        Self { device, streams, skipped: 0, reading: None, pending: None, result: OnceLock::new() }
    }

    /// The sensor is to measure, unless there is already a reading of this time.
    pub(super) fn request(&mut self, look: &Arc<Look>) {
        if !self.has_measured(look.surroundings.time_s) {
            self.settle();
            self.pending = Some(Arc::clone(look));
        }
    }

    /// Measures at once, unless there is already a reading of this time.
    pub(super) fn measure(&mut self, look: &Look) {
        if !self.has_measured(look.surroundings.time_s) {
            self.settle();
            self.compute(look);
        } else {
            self.finish();
        }
    }

    /// The latest reading; `None` before the first measurement.
    pub(super) fn reading(&self) -> Option<&D::Reading> {
        let Some(look) = &self.pending else { return self.reading.as_ref() };
        let result = self.result.get_or_init(|| {
            let mut streams = self.streams.clone();
            (0..self.skipped).for_each(|_| self.device.skip(&mut streams));
            let reading = self.device.measure(look, &mut streams, None);
            (reading, streams)
        });
        Some(&result.0)
    }

    /// Removes the latest reading.
    pub(super) fn clear(&mut self) {
        self.settle();
        self.reading = None;
    }

    /// The random streams and the latest reading, with nothing pending.
    pub(super) fn state(&mut self) -> (&mut D::Streams, &mut Option<D::Reading>) {
        self.finish();
        (&mut self.streams, &mut self.reading)
    }

    /// Whether there is already a reading of a time (s), or a measurement that is pending.
    pub(super) fn has_measured(&self, time_s: f64) -> bool {
        let last_s = match &self.pending {
            Some(pending) => Some(pending.surroundings.time_s),
            None => self.reading.as_ref().map(D::time_s),
        };
        last_s == Some(time_s)
    }

    /// Nothing is pending any more: a result that was read becomes the reading. Returns a measurement whose result was not
    /// read.
    fn take_pending(&mut self) -> Option<Arc<Look>> {
        let look = self.pending.take()?;
        let Some((reading, streams)) = self.result.take() else { return Some(look) };
        (self.reading, self.streams, self.skipped) = (Some(reading), streams, 0);
        None
    }

    /// Skips a pending measurement whose result was not read.
    fn settle(&mut self) {
        self.skipped += u64::from(self.take_pending().is_some());
    }

    /// Computes a pending measurement.
    fn finish(&mut self) {
        match self.take_pending() {
            Some(look) => self.compute(&look),
            None => self.catch_up(),
        }
    }

    fn compute(&mut self, look: &Look) {
        self.catch_up();
        let spare = self.reading.take();
        self.reading = Some(self.device.measure(look, &mut self.streams, spare));
    }

    /// Makes the draws of the skipped measurements.
    fn catch_up(&mut self) {
        (0..std::mem::take(&mut self.skipped)).for_each(|_| self.device.skip(&mut self.streams));
    }
}

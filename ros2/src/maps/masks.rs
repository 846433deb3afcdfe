//! Masks for the costmap filters of Nav2, as topics: the speed mask and the keepout mask of the place as it is known.

use super::{cut, known_part};
use crate::message::{CostmapFilterInfo, Header, Message, OccupancyGrid, Topic};
use crate::parameters::Parameters;
use interfaces::CellState;
use mapper::Mapper;
use std::time::{Duration, Instant};
use survey::masks_ahead;

/// When the masks were published.
pub(crate) struct PublishedMasks {
    interval: Duration,
    /// How far ahead the keepout mask looks, s.
    ahead_s: f64,
    last: Option<Instant>,
}

impl PublishedMasks {
    /// Publishes masks as these parameters say.
    pub(crate) fn new(parameters: &Parameters) -> Self {
        let mut masks = Self { interval: Duration::ZERO, ahead_s: 0.0, last: None };
        masks.set(parameters);
        masks
    }

    /// Takes over parameters that have changed.
    pub(crate) fn set(&mut self, parameters: &Parameters) {
        self.interval = Duration::from_secs_f64(parameters.mask_update_interval_s);
        self.ahead_s = parameters.prediction_horizon_s;
    }

    /// The messages that are due. `name` is the full name of a topic, which the filters subscribe.
    pub(crate) fn due<'a>(
        &mut self,
        mapper: &Mapper,
        header: &Header,
        now: Instant,
        name: impl Fn(Topic) -> &'a str,
    ) -> Vec<(Topic, Message)> {
        let is_first = self.last.is_none();
        if self.interval.is_zero() || self.last.is_some_and(|last| now.duration_since(last) < self.interval) {
            return Vec::new();
        }
        let Some(frame) = known_part(mapper.states()) else { return Vec::new() };
        self.last = Some(now);
        let [speed, keepout] = masks_ahead(mapper, self.ahead_s);
        let mut messages = Vec::new();
        for (topic, mask) in [(Topic::SpeedMask, speed), (Topic::KeepoutMask, keepout)] {
            let value = |_: &CellState, index: usize| i8::try_from(mask.cells()[index]).unwrap_or(i8::MAX);
            let part = cut(mapper.states(), frame, value);
            messages.push((topic, Message::Grid(OccupancyGrid::of(&part, header.clone()))));
        }
        if is_first {
            messages.extend(filter_infos(header, name));
        }
        messages
    }
}

/// What the values mean: the filters subscribe the masks after these messages. A speed mask of v allows 100 − v percent of the
/// full speed.
fn filter_infos<'a>(header: &Header, name: impl Fn(Topic) -> &'a str) -> [(Topic, Message); 2] {
    let info = |topic, mask, kind, base, multiplier| {
        let filter_mask_topic = name(mask).to_owned();
        let info = CostmapFilterInfo { header: header.clone(), kind, filter_mask_topic, base, multiplier };
        (topic, Message::FilterInfo(info))
    };
    [
        info(Topic::SpeedFilterInfo, Topic::SpeedMask, CostmapFilterInfo::SPEED_PERCENT, 100.0, -1.0),
        info(Topic::KeepoutFilterInfo, Topic::KeepoutMask, CostmapFilterInfo::KEEPOUT, 0.0, 1.0),
    ]
}

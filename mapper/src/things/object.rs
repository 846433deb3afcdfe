//! Something that comes and goes as a whole, and what looks at it say.

use super::presence::{Parts, Presence};
use crate::change::{CellMap, Evidence};
use crate::look_counts::LookCounts;
use interfaces::CellState;

/// A cell counts as blocked in this share of a number of looks before the first one: while its thing is away, and while it is there.
const PRIOR: [f64; 2] = [0.03, 0.6];
const PRIOR_LOOKS: f64 = 4.0;
/// The probability of a cell says no more than this, however often it was seen: maps err.
const SURE: f64 = 0.03;
/// Cells near each other err together: all of those in view say at most as much as this number of them.
const INDEPENDENT: f64 = 4.0;
/// A look says whether the thing is there if this is more than so many times as probable as the contrary, in the logarithm.
const MIN_LOG_ODDS: f64 = 2.5;
/// In a look at this number of cells, some are blocked if more than the first share is, and most if more than the second share is.
const PART_CELLS: f64 = 5.0;
const PART: [f64; 2] = [0.15, 0.6];
/// The cells are not those of one thing if looks that found some of them blocked outnumber those that found most of them blocked by
/// more than this.
const PARTLY: u32 = 20;
/// A cell belongs to the thing if its probability of being blocked is higher by more than this while the thing is there.
const OWN: f64 = 0.5;
/// Something that comes and goes as a whole: a toy, a chair, a box.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize, serde::Serialize)]
pub(crate) struct Object {
    pub(super) parts: Parts,
    pub(super) presence: Presence,
    /// Whether it was seen while it was there, since it was found.
    was_seen: bool,
    /// The number of looks in which some of its cells were blocked, and in which most of them were.
    looks: [u32; 2],
    /// The time at which it was found, s.
    pub(super) found_s: f64,
    /// Whether it was a thing when this was last asked.
    pub(super) is_thing: bool,
}

impl Object {
    /// An object that has just come or gone: by its cells that changed, with the looks at the one that is known best.
    pub(super) fn new(cells: &[u32], is_there: bool, map: &CellMap) -> Self {
        let known_s = |cell: &&u32| map.evidence(**cell as usize).known_s();
        let best = cells.iter().max_by(|a, b| known_s(a).total_cmp(&known_s(b)).then(b.cmp(a)));
        let best = best.map_or(0, |cell| *cell as usize);
        let presence = Presence::new(is_there, map.last_seen(best), map.evidence(best), true);
        let mut object = Self { presence, found_s: map.time(), ..Self::default() };
        object.add(cells);
        object
    }

    /// Adds cells that have turned out to belong to it.
    pub(super) fn add(&mut self, cells: &[u32]) {
        let mut parts = Parts::default();
        parts.set(cells);
        self.parts.join(parts);
    }

    /// Takes over another object that is the same one, and keeps the longer record.
    pub(super) fn join(&mut self, other: Self) {
        self.parts.join(other.parts);
        self.was_seen |= other.was_seen;
        if other.presence.evidence.known_s() > self.presence.evidence.known_s() {
            self.presence = other.presence;
        }
    }

    /// Its cells, in ascending order.
    pub(super) fn cells(&self) -> impl ExactSizeIterator<Item = u32> {
        self.parts.iter().map(|(cell, _)| *cell)
    }

    /// The probability that one of its cells is blocked, while the object is away, and while it is there; `None` of a cell that was
    /// not seen when the object was: it may be behind it.
    pub(super) fn shares(&self, cell: u32) -> Option<[f64; 2]> {
        self.parts.counts(cell).filter(|[_, there]| !self.was_seen || !there.is_empty()).map(shares)
    }

    /// Learns from the open reading. `is_doubted`: whether it speaks against the state of a cell in the map.
    pub(super) fn observe(&mut self, map: &CellMap, is_doubted: impl Fn(usize) -> bool) {
        let (mut seen, mut log_odds) = (0.0, 0.0);
        let (mut own, mut blocked, mut doubted) = (0.0, 0.0, false);
        for (cell, counts) in self.parts.iter() {
            let index = *cell as usize;
            if !map.is_seen_now(index) {
                continue;
            }
            let shares = shares(*counts);
            if is_doubted(index) {
                doubted |= is_own(shares);
                continue;
            }
            let is_blocked = map.state(index) == CellState::Blocked;
            if self.was_seen && counts[1].is_empty() && !is_blocked {
                continue;
            }
            let [away, there] = shares.map(|share| if is_blocked { share } else { 1.0 - share }.max(SURE));
            seen += 1.0;
            log_odds += libm::log(there / away);
            if is_own(shares) {
                own += 1.0;
                blocked += f64::from(u8::from(is_blocked));
            }
        }
        if own >= PART_CELLS && blocked > PART[0] * own {
            self.looks[usize::from(blocked > PART[1] * own)] += 1;
        }
        let log_odds = log_odds * f64::min(1.0, INDEPENDENT / seen);
        let is_clear = seen > 0.0 && log_odds.abs() >= MIN_LOG_ODDS;
        if doubted && !is_clear {
            self.presence.hold(map.time());
        }
        if is_clear && self.presence.see(map.time(), log_odds > 0.0) {
            self.was_seen |= self.presence.is_there;
            self.parts.learn(self.presence.is_there, map, is_doubted);
        }
    }

    /// The population of the map is learned anew: decides whether this is a thing, and not people who pass. They stay for a moment,
    /// cover a part of the cells at a time, and change them more often than anything comes and goes. Somebody who stands still is
    /// told apart when he has gone and does not come back.
    pub(super) fn renew(&mut self, map: &CellMap) {
        self.presence.renew();
        let own = self.parts.iter().filter(|(_, counts)| is_own(shares(*counts)));
        let mut cells: Vec<Evidence> = own.map(|(cell, _)| map.evidence(*cell as usize)).collect();
        cells.sort_by_key(Evidence::changes);
        let evidence = &self.presence.evidence;
        self.is_thing = evidence.stands()
            && self.looks[0] <= self.looks[1] + PARTLY
            // The median: cells at its edges flicker.
            && cells.get(cells.len().saturating_sub(1) / 2).is_some_and(|cell| evidence.explains(cell));
    }
}

/// Whether a cell belongs to the thing, and is not only near it.
fn is_own([away, there]: [f64; 2]) -> bool {
    there - away > OWN
}

fn shares(counts: [LookCounts; 2]) -> [f64; 2] {
    [0, 1].map(|state| counts[state].share(PRIOR[state], PRIOR_LOOKS))
}

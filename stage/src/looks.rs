//! What a thing is called, and what it is to others.

use super::body::Body;
use super::place::Place;
use super::tree::Thing;
use super::world::Builder;

/// What a thing is called, and what it is to others.
pub(super) struct Looks {
    pub(super) name: String,
    pub(super) color: Option<String>,
    /// Whether robots bump into it.
    collides: bool,
    /// Whether lasers see it.
    is_seen: bool,
    /// Its tag, and where the file speaks of it.
    pub(super) tag: Option<(u32, Place)>,
}

impl Looks {
    /// Whether robots bump into it or lasers see it.
    pub(super) fn is_there(&self) -> bool {
        self.collides || self.is_seen
    }
}

impl Builder<'_, '_> {
    pub(super) fn looks(&mut self, thing: &Thing) -> Looks {
        let name = self.name(thing);
        let color = self.reader.text(thing, "color").map(|(color, place)| {
            self.reader.sources.harmless(place, "color");
            color
        });
        let collides = self.reader.flag(thing, "obstacle_return").unwrap_or(true);
        let is_seen_by_rangers =
            self.reader.number(thing, "ranger_return", -1e5..=1e5).is_none_or(|value| value >= 0.0);
        let is_seen_by_lasers = self.reader.flag(thing, "laser_return").unwrap_or(true);
        let is_seen = is_seen_by_rangers && is_seen_by_lasers;
        if let Some((_, place)) =
            self.reader.numbers(thing, "mass", 1..=1).filter(|_| thing.kind != "position")
        {
            let help = "robots push nothing in Stage, and no walls here; in a world file of ours they push an \
                        `[[obstacle]]` of `kind = \"box\"`";
            self.reader.sources.note(place, "the `mass` of what is no robot changes nothing", help);
        }
        Looks { name, color, collides, is_seen, tag: self.reader.tag(thing) }
    }

    /// A name that no other thing has.
    fn name(&mut self, thing: &Thing) -> String {
        let given = self.reader.text(thing, "name");
        let mut name = given.as_ref().map_or_else(|| thing.kind.clone(), |(name, _)| name.clone());
        if given.is_none() || self.names.contains(&name) {
            // As Stage makes names up.
            let count = self.made_up.entry(name.clone()).or_default();
            let mut free = format!("{name}:{count}");
            while self.names.contains(&free) {
                *count += 1;
                free = format!("{name}:{count}");
            }
            *count += 1;
            if let Some((_, place)) = given {
                let what = format!("two things are called `{name}`");
                self.reader.sources.warning(place, &what, "", &format!("this one is called `{free}` here"));
            }
            name = free;
        }
        self.names.insert(name.clone());
        name
    }

    /// Warns of a body that in Stage is only bumped into, or only seen.
    pub(super) fn warn_of_half_ghost(&mut self, thing: &Thing, looks: &Looks, body: &Body) {
        if looks.collides == looks.is_seen || body.is_empty() {
            return;
        }
        let (what, help) = match looks.collides {
            true => ("this thing cannot be seen in Stage", "here lasers see whatever robots bump into"),
            false => ("nothing bumps into this thing in Stage", "here robots bump into whatever lasers see"),
        };
        self.reader.sources.warning(thing.place, what, "", help);
    }
}

//! From tokens to a tree of entities, with every definition written out.
//!
//! A `define` gives a name to a kind of entity with some of its keys and parts; an entity of that kind
//! has these, then its own keys instead of or beside them, then its own parts. As in Stage, the first
//! definition of a name holds.

use super::lexer::{Kind, Span, Token};
use super::sources::Sources;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::rc::Rc;

/// The maximum depth of brackets and of definitions in each other.
const MAX_DEPTH: usize = 64;
/// The maximum number of keys and parts, with all definitions written out.
const MAX_ITEMS: usize = 1 << 19;

/// A key with its values.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: Span,
    pub(super) values: Vec<Token>,
    /// Whether a reader has asked for it.
    pub(super) is_used: Cell<bool>,
}

impl Property {
    /// From the name to the last value.
    pub(super) fn place(&self) -> Span {
        let end = self.values.last().filter(|last| last.place.file == self.name.file);
        Span { end: end.map_or(self.name.end, |last| last.place.end), ..self.name }
    }
}

/// What has keys and parts: the world, a model, a block, a sensor.
#[derive(Debug)]
pub(super) struct Entity {
    /// Such as `position`: Stage's own name for the kind, once definitions are written out.
    pub(super) kind: String,
    /// The name of its kind where it is used.
    pub(super) place: Span,
    pub(super) properties: BTreeMap<String, Rc<Property>>,
    pub(super) parts: Vec<Entity>,
}

impl Entity {
    fn new(kind: &str, place: Span) -> Self {
        Self { kind: kind.to_owned(), place, properties: BTreeMap::new(), parts: Vec::new() }
    }

    fn set(&mut self, name: &str, property: Rc<Property>) {
        if let Some(old) = self.properties.insert(name.to_owned(), property) {
            // It shall not be reported as unused: the key that overrides it counts.
            old.is_used.set(true);
        }
    }

    /// The key, if the entity has it. From now on it counts as used.
    pub(super) fn get(&self, name: &str) -> Option<&Property> {
        let property = self.properties.get(name)?;
        property.is_used.set(true);
        Some(property)
    }

    /// Where it gives this key, or else where it begins.
    pub(super) fn place_of(&self, name: &str) -> Span {
        self.properties.get(name).map_or(self.place, |property| property.place())
    }

    /// The parts that are not blocks of its body.
    pub(super) fn carried(&self) -> impl Iterator<Item = &Self> {
        self.parts.iter().filter(|part| part.kind != "block")
    }
}

/// The tree of a file: the keys of the world itself and its models. `None` if there are errors.
pub(super) fn read(sources: &mut Sources<'_>, tokens: &[Token]) -> Option<Entity> {
    let start = tokens.first().map_or(Span::default(), |token| token.place);
    let mut parser = Parser { sources, tokens, at: 0, definitions: BTreeMap::new(), items: 0 };
    let (mut world, mut models) = (Entity::new("world", start), Vec::new());
    while parser.at < tokens.len() {
        if parser.is_word("define") {
            parser.define()?;
            continue;
        }
        parser.item(&mut world, 0)?;
        if let Some(model) = world.parts.pop() {
            models.push(parser.expand(&model, 0)?);
        }
    }
    world.parts = models;
    Some(world)
}

struct Parser<'a, 'b> {
    sources: &'a mut Sources<'b>,
    tokens: &'a [Token],
    at: usize,
    /// As they are in the file, by their names.
    definitions: BTreeMap<String, Rc<Entity>>,
    /// Keys and parts written out so far.
    items: usize,
}

impl Parser<'_, '_> {
    fn error<T>(&mut self, place: Span, what: &str, help: &str) -> Option<T> {
        self.sources.error(place, what, help);
        None
    }

    /// The next token, or an error at the last one.
    fn next(&mut self, missing: &str) -> Option<Token> {
        let Some(token) = self.tokens.get(self.at) else {
            let last = self.tokens.last()?.place;
            return self.error(last, "the file ends too early", &format!("{missing} is missing after this"));
        };
        self.at += 1;
        Some(*token)
    }

    fn is_word(&self, word: &str) -> bool {
        let next = self.tokens.get(self.at);
        next.is_some_and(|next| next.kind == Kind::Word && self.sources.text(next.place) == word)
    }

    fn word(&mut self, help: &str) -> Option<Span> {
        let token = self.next(help)?;
        if token.kind == Kind::Word {
            return Some(token.place);
        }
        let what = format!("`{}` is out of place", self.sources.text(token.place));
        self.error(token.place, &what, &format!("{help} is expected here"))
    }

    fn define(&mut self) -> Option<()> {
        self.at += 1;
        let name = self.word("the name of a definition")?;
        let kind = self.word("the kind of thing to define")?;
        let open = self.next("`(`")?;
        if open.kind != Kind::Open {
            let what = "this definition has no body";
            return self.error(open.place, what, "write it as in `define sick laser( … )`");
        }
        let entity = self.body(kind, 1)?;
        match self.definitions.entry(self.sources.text(name).to_owned()) {
            Entry::Vacant(place) => {
                place.insert(Rc::new(entity));
            }
            Entry::Occupied(first) => {
                let what = format!("`{}` is defined again", first.key());
                let help = "this definition has no effect: as in Stage, the first one holds";
                self.sources.warning(name, what, help);
            }
        }
        Some(())
    }

    /// Reads a key with its value, or a part, into an entity.
    fn item(&mut self, entity: &mut Entity, depth: usize) -> Option<()> {
        let name = self.word("a key or a thing")?;
        let next = self.next("a value or `(`")?;
        let values = match next.kind {
            Kind::Open => {
                entity.parts.push(self.body(name, depth + 1)?);
                return Some(());
            }
            Kind::Number(_) | Kind::Text => vec![next],
            Kind::OpenTuple => self.list()?,
            _ => {
                let what = format!("`{}` has no value", self.sources.text(name));
                let help =
                    "a key is followed by a number, a text in quotes or a list in `[ ]`, a thing by `( )`";
                return self.error(name, &what, help);
            }
        };
        let property = Rc::new(Property { name, values, is_used: Cell::new(false) });
        entity.set(self.sources.text(name), property);
        Some(())
    }

    /// The values of a list, of which the first bracket is read.
    fn list(&mut self) -> Option<Vec<Token>> {
        let mut values = Vec::new();
        loop {
            let value = self.next("`]`")?;
            match value.kind {
                Kind::Number(_) | Kind::Text => values.push(value),
                Kind::CloseTuple => return Some(values),
                _ => {
                    let what = format!("`{}` is out of place in a list", self.sources.text(value.place));
                    let help = "a list holds numbers and texts, and ends with `]`";
                    return self.error(value.place, &what, help);
                }
            }
        }
    }

    /// An entity of which the first bracket is read.
    fn body(&mut self, kind: Span, depth: usize) -> Option<Entity> {
        if depth > MAX_DEPTH {
            return self.error(kind, "too many brackets in each other", "64 are the most");
        }
        let mut entity = Entity::new(self.sources.text(kind), kind);
        while self.tokens.get(self.at).is_none_or(|next| next.kind != Kind::Close) {
            self.item(&mut entity, depth)?;
        }
        self.at += 1;
        Some(entity)
    }

    /// Writes out all definitions in an entity.
    fn expand(&mut self, entity: &Entity, depth: usize) -> Option<Entity> {
        let Entity { kind, place, .. } = entity;
        if depth > MAX_DEPTH {
            let help = "it is made of itself, or of too many definitions in each other";
            return self.error(*place, &format!("the definition `{kind}` has no end"), help);
        }
        let mut whole = match self.definitions.get(kind).cloned() {
            Some(definition) => Entity { place: *place, ..self.expand(&definition, depth + 1)? },
            None => Entity::new(kind, *place),
        };
        for (name, property) in &entity.properties {
            self.count(property.name)?;
            whole.set(name, Rc::clone(property));
        }
        for part in &entity.parts {
            self.count(part.place)?;
            whole.parts.push(self.expand(part, depth + 1)?);
        }
        Some(whole)
    }

    fn count(&mut self, place: Span) -> Option<()> {
        self.items += 1;
        if self.items > MAX_ITEMS {
            let help = "half a million keys and things are the most, with all definitions written out";
            return self.error(place, "too many things", help);
        }
        Some(())
    }
}

//! From tokens to a tree of things, with every definition written out.
//!
//! A `define` gives a name to a kind of thing with some of its keys and parts; a thing of that kind
//! has these, then its own keys instead of or beside them, then its own parts. As in Stage, the first
//! definition of a name holds.

use super::lexer::{Kind, Token};
use super::place::Place;
use super::sources::Sources;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::rc::Rc;

/// Brackets may not lie deeper in each other, nor definitions.
const MAX_DEPTH: usize = 64;
/// A definition of definitions of definitions can be long: the maximum number of keys and parts.
const MAX_ITEMS: usize = 1 << 19;

/// A thing with keys and parts, before definitions are written out.
struct Node {
    kind: Place,
    items: Vec<Item>,
}

enum Item {
    Property(Rc<Property>),
    Part(Rc<Node>),
}

/// A key with its values.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: Place,
    pub(super) values: Vec<Token>,
    /// Whether anybody has asked for it.
    pub(super) is_used: Cell<bool>,
}

impl Property {
    /// From the name to the last value.
    pub(super) fn place(&self) -> Place {
        let end = self.values.last().filter(|last| last.place.file == self.name.file);
        Place { end: end.map_or(self.name.end, |last| last.place.end), ..self.name }
    }
}

/// A thing of one of Stage's kinds, with all its keys and parts.
#[derive(Debug)]
pub(super) struct Thing {
    /// Stage's own name for the kind, such as `position`.
    pub(super) kind: String,
    /// Where it is called for.
    pub(super) place: Place,
    pub(super) properties: BTreeMap<String, Rc<Property>>,
    pub(super) parts: Vec<Thing>,
}

/// The tree of a file: the keys of the world itself and the things in it. `None` if there are
/// errors.
pub(super) fn read(sources: &mut Sources<'_>, tokens: &[Token]) -> Option<Thing> {
    let start = tokens.first().map_or(Place { file: 0, start: 0, end: 0 }, |token| token.place);
    let mut parser = Parser { sources, tokens, at: 0, definitions: BTreeMap::new(), items: 0 };
    let mut world =
        Thing { kind: "world".to_owned(), place: start, properties: BTreeMap::new(), parts: Vec::new() };
    while parser.at < tokens.len() {
        if parser.is_word("define") {
            parser.define()?;
            continue;
        }
        match parser.item(0)? {
            Item::Property(property) => parser.set(&mut world, property)?,
            Item::Part(node) => {
                let thing = parser.expand(&node, 0)?;
                world.parts.push(thing);
            }
        }
    }
    Some(world)
}

struct Parser<'a, 'b> {
    sources: &'a mut Sources<'b>,
    tokens: &'a [Token],
    at: usize,
    definitions: BTreeMap<String, Rc<Node>>,
    /// Keys and parts written out so far.
    items: usize,
}

impl Parser<'_, '_> {
    fn error<T>(&mut self, place: Place, what: &str, help: &str) -> Option<T> {
        self.sources.error(place, what, "", help);
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

    fn word(&mut self, help: &str) -> Option<Place> {
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
        let node = self.body(kind, 1)?;
        let text = self.sources.text(name).to_owned();
        match self.definitions.entry(text) {
            Entry::Vacant(place) => {
                place.insert(Rc::new(node));
            }
            Entry::Occupied(first) => {
                let what = format!("`{}` is defined again", first.key());
                let help = "this definition has no effect: as in Stage, the first one holds";
                self.sources.warning(name, &what, "", help);
            }
        }
        Some(())
    }

    /// A key with its value, or a thing.
    fn item(&mut self, depth: usize) -> Option<Item> {
        let name = self.word("a key or a thing")?;
        let next = self.next("a value or `(`")?;
        match next.kind {
            Kind::Open => Some(Item::Part(Rc::new(self.body(name, depth + 1)?))),
            Kind::Number(_) | Kind::Text => Some(property(name, vec![next])),
            Kind::OpenTuple => {
                let mut values = Vec::new();
                loop {
                    let value = self.next("`]`")?;
                    match value.kind {
                        Kind::Number(_) | Kind::Text => values.push(value),
                        Kind::CloseTuple => return Some(property(name, values)),
                        _ => {
                            let what =
                                format!("`{}` is out of place in a list", self.sources.text(value.place));
                            return self.error(
                                value.place,
                                &what,
                                "a list holds numbers and texts, and ends with `]`",
                            );
                        }
                    }
                }
            }
            _ => {
                let what = format!("`{}` has no value", self.sources.text(name));
                self.error(
                    name,
                    &what,
                    "a key is followed by a number, a text in quotes or a list in `[ ]`, a thing by `( )`",
                )
            }
        }
    }

    /// What stands in the brackets of a thing, the first of which is read.
    fn body(&mut self, kind: Place, depth: usize) -> Option<Node> {
        if depth > MAX_DEPTH {
            return self.error(kind, "too many brackets in each other", "64 are the most");
        }
        let mut items = Vec::new();
        loop {
            if self.tokens.get(self.at).is_some_and(|next| next.kind == Kind::Close) {
                self.at += 1;
                return Some(Node { kind, items });
            }
            items.push(self.item(depth)?);
        }
    }

    /// Writes out all definitions in a thing.
    fn expand(&mut self, node: &Node, depth: usize) -> Option<Thing> {
        let kind = self.sources.text(node.kind).to_owned();
        if depth > MAX_DEPTH {
            let help = "it is made of itself, or of too many definitions in each other";
            return self.error(node.kind, &format!("the definition `{kind}` has no end"), help);
        }
        let mut thing = match self.definitions.get(&kind).cloned() {
            Some(definition) => Thing { place: node.kind, ..self.expand(&definition, depth + 1)? },
            None => Thing { kind, place: node.kind, properties: BTreeMap::new(), parts: Vec::new() },
        };
        for item in &node.items {
            match item {
                Item::Property(property) => self.set(&mut thing, Rc::clone(property))?,
                Item::Part(part) => {
                    self.count(part.kind)?;
                    let part = self.expand(part, depth + 1)?;
                    thing.parts.push(part);
                }
            }
        }
        Some(thing)
    }

    fn set(&mut self, thing: &mut Thing, property: Rc<Property>) -> Option<()> {
        self.count(property.name)?;
        let name = self.sources.text(property.name).to_owned();
        if let Some(old) = thing.properties.insert(name, property) {
            // Nobody will ask for it: what overrides it counts.
            old.is_used.set(true);
        }
        Some(())
    }

    fn count(&mut self, place: Place) -> Option<()> {
        self.items += 1;
        if self.items > MAX_ITEMS {
            return self.error(
                place,
                "too many things",
                "half a million keys and things are the most, with all definitions written out",
            );
        }
        Some(())
    }
}

fn property(name: Place, values: Vec<Token>) -> Item {
    Item::Property(Rc::new(Property { name, values, is_used: Cell::new(false) }))
}

//! Which module defines what a path names.

use crate::modules::Modules;
use std::collections::BTreeSet;

/// What a path names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Target {
    Module(usize),
    /// Something that this module defines.
    Item(usize),
}

impl Target {
    fn is_item(&self) -> bool {
        matches!(self, Self::Item(_))
    }
}

/// A use of one module by another.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Edge {
    pub(crate) user: usize,
    pub(crate) defines: usize,
    /// The path as the user writes it.
    pub(crate) path: String,
}

/// The part before `::`, which is a module or a type, or the end of a path.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Position {
    Before,
    Last,
}

/// The names that are being looked up, since stars and re-exports may form a ring.
type Seen = BTreeSet<(usize, String)>;

impl Modules {
    /// All uses between modules, by the module that defines what is used.
    pub(crate) fn edges(&self) -> BTreeSet<Edge> {
        let mut edges = BTreeSet::new();
        for (user, module) in self.modules.iter().enumerate() {
            let imports = module.imports.iter().map(|import| &import.path);
            for path in imports.chain(&module.references) {
                for target in self.resolve(user, path, Position::Last, &mut Seen::new()) {
                    if let Target::Item(defines) = target
                        && defines != user
                    {
                        edges.insert(Edge { user, defines, path: path.join("::") });
                    }
                }
            }
        }
        edges
    }

    fn resolve(&self, from: usize, path: &[String], end: Position, seen: &mut Seen) -> BTreeSet<Target> {
        let mut targets = BTreeSet::new();
        for (index, name) in path.iter().enumerate() {
            let position = if index + 1 == path.len() { end } else { Position::Before };
            let parent = |module: usize| self.modules[module].parent.map(Target::Module);
            targets = match (name.as_str(), index) {
                ("crate", 0) => BTreeSet::from([Target::Module(0)]),
                ("self", 0) => BTreeSet::from([Target::Module(from)]),
                ("super", 0) => parent(from).into_iter().collect(),
                (name, 0) => self.lookup(from, name, position, seen),
                (name, _) => {
                    let next = targets.into_iter().flat_map(|target| match target {
                        Target::Module(module) if name == "super" => parent(module).into_iter().collect(),
                        Target::Module(module) => self.lookup(module, name, position, seen),
                        // A variant, or a function of a type.
                        item => BTreeSet::from([item]),
                    });
                    next.collect()
                }
            };
        }
        targets
    }

    fn lookup(&self, at: usize, name: &str, position: Position, seen: &mut Seen) -> BTreeSet<Target> {
        let module = &self.modules[at];
        let mut targets: BTreeSet<Target> =
            module.children.get(name).copied().map(Target::Module).into_iter().collect();
        if position == Position::Before && !targets.is_empty() || !seen.insert((at, name.to_owned())) {
            return targets;
        }
        if module.items.contains(name) {
            targets.insert(Target::Item(at));
        }
        for import in module.imports.iter().filter(|import| import.name.as_deref() == Some(name)) {
            targets.extend(self.resolve(at, &import.path, position, seen));
        }
        // A module and a function may have the same name, and only one of them come through a star.
        if !targets.iter().any(Target::is_item) {
            let is_module = !targets.is_empty();
            for import in module.imports.iter().filter(|import| import.name.is_none()) {
                for source in self.resolve(at, &import.path, Position::Before, seen) {
                    if let Target::Module(module) = source {
                        let found = self.lookup(module, name, position, seen).into_iter();
                        targets.extend(found.filter(|target| target.is_item() || !is_module));
                    }
                }
            }
        }
        if targets.is_empty() {
            targets.extend(self.macros.get(name).copied().map(Target::Item));
        }
        seen.remove(&(at, name.to_owned()));
        targets
    }
}

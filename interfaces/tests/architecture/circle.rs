//! No circles between sibling modules.

use crate::modules::Modules;
use crate::workspace::packages;
use std::collections::{BTreeMap, BTreeSet};

/// Sibling modules each of which uses each other one.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Circle {
    /// The module around them.
    pub(crate) parent: String,
    pub(crate) modules: BTreeSet<String>,
    /// For every use within the circle one path as an example.
    pub(crate) uses: BTreeMap<(String, String), String>,
}

/// All circles of a crate, at every level.
pub(crate) fn circles(modules: &Modules) -> Vec<Circle> {
    // Per containing module: for every use between two modules directly in it, an example.
    let mut levels: BTreeMap<String, BTreeMap<(String, String), String>> = BTreeMap::new();
    for edge in modules.edges() {
        let (user, defines) = (&modules.modules[edge.user].path, &modules.modules[edge.defines].path);
        let common = user.iter().zip(defines).take_while(|(one, other)| one == other).count();
        // One contains the other.
        if common == user.len() || common == defines.len() {
            continue;
        }
        let example = format!("{} uses {}", user.join("::"), edge.path);
        let level = levels.entry(user[..common].join("::")).or_default();
        level.entry((user[common].clone(), defines[common].clone())).or_insert(example);
    }
    levels.into_iter().flat_map(|(parent, uses)| circles_of(&parent, &uses)).collect()
}

fn circles_of(parent: &str, uses: &BTreeMap<(String, String), String>) -> Vec<Circle> {
    let reached: BTreeMap<&str, BTreeSet<&str>> =
        uses.keys().map(|(user, _)| (user.as_str(), reached_from(user, uses))).collect();
    let mutual = |one: &str| -> BTreeSet<String> {
        let back = |other: &&&str| reached.get(**other).is_some_and(|names| names.contains(one));
        reached[one].iter().filter(back).map(|name| (*name).to_owned()).collect()
    };
    let sets: BTreeSet<BTreeSet<String>> = reached.keys().map(|name| mutual(name)).collect();
    let circles = sets.into_iter().filter(|set| set.len() > 1).map(|set| {
        let inside = uses.iter().filter(|((user, defines), _)| set.contains(user) && set.contains(defines));
        let uses = inside.map(|(names, example)| (names.clone(), example.clone())).collect();
        Circle { parent: parent.to_owned(), modules: set, uses }
    });
    circles.collect()
}

fn reached_from<'a>(name: &str, uses: &'a BTreeMap<(String, String), String>) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut open = vec![name.to_owned()];
    while let Some(user) = open.pop() {
        for (_, defines) in uses.keys().filter(|(other, _)| *other == user) {
            if reached.insert(defines.as_str()) {
                open.push(defines.clone());
            }
        }
    }
    reached
}

impl std::fmt::Display for Circle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let modules: Vec<&str> = self.modules.iter().map(String::as_str).collect();
        write!(f, "{}: {}", self.parent, modules.join(" "))
    }
}

impl Circle {
    /// The circle with an example of every use.
    pub(crate) fn explained(&self) -> String {
        let uses =
            self.uses.iter().map(|((user, defines), path)| format!("    {user} -> {defines}: {path}\n"));
        format!("{self}\n{}", uses.collect::<String>())
    }
}

#[test]
fn no_circles_between_sibling_modules() {
    let targets = packages().into_iter().flat_map(|package| package.targets);
    let circles = targets.flat_map(|(name, root)| circles(&Modules::read(&name, &root)));
    let errors: String =
        circles.map(|circle| format!("a circle between modules: {}", circle.explained())).collect();
    assert!(errors.is_empty(), "{errors}");
}

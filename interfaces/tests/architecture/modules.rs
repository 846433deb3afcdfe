//! The tree of modules of a crate, from its sources.

use crate::references::{References, is_test};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::{Item, ItemMod};

/// A path as written: `crate::map::Map` is `["crate", "map", "Map"]`.
pub(crate) type Names = Vec<String>;

/// A name that a `use` brings into a module.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Import {
    /// The name in the module; `None` for `*`.
    pub(crate) name: Option<String>,
    pub(crate) path: Names,
}

/// A module.
#[derive(Debug, Default)]
pub(crate) struct Module {
    /// The name, with the names of all containing modules, beginning with the crate.
    pub(crate) path: Names,
    pub(crate) parent: Option<usize>,
    pub(crate) children: BTreeMap<String, usize>,
    /// The names of all items (types, functions, constants and so on) that are defined here.
    pub(crate) items: BTreeSet<String>,
    pub(crate) imports: BTreeSet<Import>,
    /// All paths in the code of the module.
    pub(crate) references: BTreeSet<Names>,
}

/// The modules of a crate; the crate itself is the first.
#[derive(Debug)]
pub(crate) struct Modules {
    pub(crate) modules: Vec<Module>,
    /// Macros of `macro_rules`, which are known by name in the whole crate.
    pub(crate) macros: BTreeMap<String, usize>,
}

impl Modules {
    /// Reads a crate from its root file on.
    pub(crate) fn read(name: &str, root: &Path) -> Self {
        let folder = root.parent().unwrap().to_path_buf();
        Self::of(name, &source(root), &folder)
    }

    /// Reads a crate whose modules are all in one text.
    pub(crate) fn parse(text: &str) -> Self {
        Self::of("krate", text, Path::new("nowhere"))
    }

    fn of(name: &str, text: &str, folder: &Path) -> Self {
        let mut modules = Self { modules: vec![], macros: BTreeMap::new() };
        let file = syn::parse_file(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        modules.add(vec![name.to_owned()], None, &file.items, folder);
        modules
    }

    /// Adds a module and all modules in it. `folder` is the folder of its files.
    fn add(&mut self, path: Names, parent: Option<usize>, items: &[Item], folder: &Path) -> usize {
        let index = self.modules.len();
        self.modules.push(Module { path: path.clone(), parent, ..Module::default() });
        let mut references = References::default();
        for item in items.iter().filter(|item| !is_test(attributes(item))) {
            if let Item::Mod(module) = item {
                let name = module.ident.to_string();
                let child =
                    self.add_child([path.clone(), vec![name.clone()]].concat(), index, module, folder);
                self.modules[index].children.insert(name, child);
                continue;
            }
            if let Item::Macro(item) = item
                && let Some(name) = &item.ident
            {
                self.macros.insert(name.to_string(), index);
            }
            self.modules[index].items.extend(defined(item));
            references.read(item);
        }
        self.modules[index].imports = references.imports;
        self.modules[index].references = references.paths;
        index
    }

    fn add_child(&mut self, path: Names, parent: usize, module: &ItemMod, folder: &Path) -> usize {
        let below = folder.join(path.last().unwrap());
        if let Some((_, items)) = &module.content {
            return self.add(path, Some(parent), items, &below);
        }
        let file = file_of(module, folder, &below);
        let parsed =
            syn::parse_file(&source(&file)).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        self.add(path, Some(parent), &parsed.items, &below)
    }
}

fn source(file: &Path) -> String {
    std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// The file of `mod name;`.
fn file_of(module: &ItemMod, folder: &Path, below: &Path) -> PathBuf {
    for attribute in &module.attrs {
        assert!(!attribute.path().is_ident("path"), "#[path] of `mod {}` is not supported", module.ident);
    }
    let beside = folder.join(format!("{}.rs", module.ident));
    if beside.exists() { beside } else { below.join("mod.rs") }
}

fn attributes(item: &Item) -> &[syn::Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

fn defined(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        _ => return None,
    };
    Some(name.to_string())
}

//! All paths in the code of a module.

use crate::modules::{Import, Names};
use proc_macro2::{TokenStream, TokenTree};
use std::collections::BTreeSet;
use syn::visit::{self, Visit};
use syn::{Attribute, Item, Meta, Path, UseTree};

/// Collects the imports and the paths of items.
#[derive(Default)]
pub(crate) struct References {
    pub(crate) imports: BTreeSet<Import>,
    pub(crate) paths: BTreeSet<Names>,
}

/// Whether an item is built only for tests.
pub(crate) fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) if list.path.is_ident("cfg") => {
            let condition = list.tokens.to_string();
            condition == "test" || condition.starts_with("all (test")
        }
        meta => meta.path().is_ident("test"),
    })
}

impl References {
    pub(crate) fn read(&mut self, item: &Item) {
        self.visit_item(item);
    }

    fn import(&mut self, tree: &UseTree, before: &Names) {
        let with = |name: &syn::Ident| [before.clone(), vec![name.to_string()]].concat();
        // `self` at the end of a path is the module before it.
        let path = |name: &syn::Ident| {
            if name == "self" && !before.is_empty() { before.clone() } else { with(name) }
        };
        match tree {
            UseTree::Path(tree) => self.import(&tree.tree, &with(&tree.ident)),
            UseTree::Group(group) => group.items.iter().for_each(|tree| self.import(tree, before)),
            UseTree::Glob(_) => _ = self.imports.insert(Import { name: None, path: before.clone() }),
            UseTree::Name(tree) => {
                let path = path(&tree.ident);
                self.imports.insert(Import { name: path.last().cloned(), path });
            }
            UseTree::Rename(tree) => {
                let name = Some(tree.rename.to_string());
                self.imports.insert(Import { name, path: path(&tree.ident) });
            }
        }
    }

    /// Paths in the tokens of a macro's call, where there is no syntax to go by.
    fn tokens(&mut self, tokens: TokenStream) {
        let mut path = Names::new();
        let mut colons = 0;
        // A field or a method follows `.`, the name of a lifetime follows `'`.
        let mut is_other = false;
        for token in tokens {
            match token {
                TokenTree::Punct(mark) if mark.as_char() == ':' && colons < 2 => {
                    colons += 1;
                    continue;
                }
                TokenTree::Ident(name) => {
                    if colons != 2 {
                        self.paths.insert(std::mem::take(&mut path));
                    }
                    if !is_other {
                        path.push(name.to_string());
                    }
                    is_other = false;
                }
                other => {
                    self.paths.insert(std::mem::take(&mut path));
                    is_other =
                        matches!(&other, TokenTree::Punct(mark) if ['.', '\''].contains(&mark.as_char()));
                    if let TokenTree::Group(group) = other {
                        self.tokens(group.stream());
                    }
                }
            }
            colons = 0;
        }
        self.paths.insert(path);
        self.paths.remove(&Names::new());
    }

    /// Functions and modules that serde's attributes name in a text.
    fn serde(&mut self, tokens: TokenStream) {
        const KEYS: [&str; 9] = [
            "default",
            "with",
            "serialize_with",
            "deserialize_with",
            "from",
            "into",
            "try_from",
            "remote",
            "skip_serializing_if",
        ];
        let mut is_path = false;
        for token in tokens {
            match token {
                TokenTree::Ident(name) => is_path = KEYS.contains(&name.to_string().as_str()),
                TokenTree::Literal(text) if is_path => {
                    let text = text.to_string();
                    let names = text.trim_matches('"').split('<').next().unwrap().split("::");
                    self.paths.insert(names.map(|name| name.trim().to_owned()).collect());
                }
                TokenTree::Group(group) => self.serde(group.stream()),
                _ => {}
            }
        }
    }
}

impl<'a> Visit<'a> for References {
    fn visit_item(&mut self, item: &'a Item) {
        match item {
            Item::Use(item) if !is_test(&item.attrs) => self.import(&item.tree, &Names::new()),
            Item::Fn(item) if is_test(&item.attrs) => {}
            Item::Mod(_) | Item::Use(_) => {}
            item => visit::visit_item(self, item),
        }
    }

    fn visit_impl_item(&mut self, item: &'a syn::ImplItem) {
        let attributes = match item {
            syn::ImplItem::Fn(item) => &item.attrs[..],
            syn::ImplItem::Const(item) => &item.attrs,
            _ => &[],
        };
        if !is_test(attributes) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_path(&mut self, path: &'a Path) {
        if path.leading_colon.is_none() {
            self.paths.insert(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'a syn::Macro) {
        self.visit_path(&call.path);
        self.tokens(call.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'a Attribute) {
        match &attribute.meta {
            Meta::List(list) if list.path.is_ident("serde") => self.serde(list.tokens.clone()),
            Meta::List(list) if list.path.is_ident("derive") => self.tokens(list.tokens.clone()),
            _ => {}
        }
    }

    fn visit_visibility(&mut self, _: &'a syn::Visibility) {}
}

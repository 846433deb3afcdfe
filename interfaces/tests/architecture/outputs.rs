//! Only the crate `files` makes, replaces, renames and removes files: it knows which of them a run wrote. The
//! programs, the crates and the examples are checked; tests, build scripts and the studies are not.

use crate::references::is_test;
use crate::workspace::root;
use quote::ToTokens;
use std::path::Path;
use syn::fold::Fold;

/// Calls that write, as tokens.
const WRITE: [&str; 20] = [
    " File :: create",
    " File :: options",
    "fs :: write",
    "fs :: rename",
    "fs :: copy",
    " OpenOptions ",
    " create_new ",
    " create_dir ",
    " create_dir_all ",
    " remove_file ",
    " remove_dir ",
    " remove_dir_all ",
    " hard_link ",
    " symlink ",
    " set_permissions ",
    " renameat ",
    " unlinkat ",
    " . persist (",
    "SVGBackend :: new",
    "BitMapBackend :: new",
];

/// Leaves out what is built only for tests.
struct Product;

impl Fold for Product {
    fn fold_item_mod(&mut self, item: syn::ItemMod) -> syn::ItemMod {
        let keep = |content: Vec<syn::Item>| content.into_iter().filter(|item| !is_of_tests(item)).collect();
        let content = item.content.map(|(brace, items)| (brace, keep(items)));
        syn::fold::fold_item_mod(self, syn::ItemMod { content, ..item })
    }
}

fn is_of_tests(item: &syn::Item) -> bool {
    match item {
        syn::Item::Fn(item) => is_test(&item.attrs),
        syn::Item::Impl(item) => is_test(&item.attrs),
        syn::Item::Mod(item) => is_test(&item.attrs),
        syn::Item::Use(item) => is_test(&item.attrs),
        _ => false,
    }
}

/// The calls that write in a text.
fn found(text: &str) -> Vec<&'static str> {
    let mut file = syn::parse_file(text).unwrap();
    file.items.retain(|item| !is_of_tests(item));
    let text = format!(" {} ", Product.fold_file(file).to_token_stream());
    WRITE.into_iter().filter(|call| text.contains(call)).collect()
}

/// Calls `check` with every file of Rust below a folder.
fn walk(folder: &Path, check: &mut dyn FnMut(&Path)) {
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let (path, name) = (entry.path(), entry.file_name().into_string().unwrap());
        let is_left_out =
            ["target", "tests", "fuzz", "benches", "build.rs", "tests.rs"].contains(&name.as_str());
        if is_left_out
            || name.starts_with('.')
            || ["files", "studies"].map(|name| root().join(name)).contains(&path)
        {
            continue;
        }
        if path.is_dir() {
            walk(&path, check);
        } else if name.ends_with(".rs") {
            check(&path);
        }
    }
}

#[test]
fn only_the_crate_of_files_writes_files() {
    let (mut errors, mut count) = (Vec::new(), 0);
    walk(root(), &mut |path| {
        count += 1;
        let calls = found(&std::fs::read_to_string(path).unwrap());
        errors.extend(calls.iter().map(|call| format!("{}: {}", path.display(), call.trim())));
    });
    assert!(count > 500, "{count}");
    assert!(errors.is_empty(), "use files::UnfinishedFile or files::RunFolder:\n{}", errors.join("\n"));
}

#[test]
fn a_call_that_writes_is_found() {
    let wrong = "fn a() { std::fs::write(\"a\", \"b\").unwrap(); } mod b { use std::fs::create_dir_all; }";
    assert_eq!(found(wrong), ["fs :: write", " create_dir_all "]);
    let right = "#[cfg(test)] mod a { fn b() { std::fs::write(\"a\", \"b\"); } } mod c { #[cfg(test)] fn d() { File::create(e) } }";
    assert_eq!(found(right), [""; 0]);
}

/// Examples of Python write by `curious.Output`.
#[test]
fn examples_of_python_write_by_the_same_rule() {
    for entry in std::fs::read_dir(root().join("python/examples")).unwrap().map(Result::unwrap) {
        let Ok(text) = std::fs::read_to_string(entry.path()) else { continue };
        for (before, line) in text.lines().zip(text.lines().skip(1)) {
            let writes = [".save(", "savez(", "savefig(", "\"w\")"].iter().any(|call| line.contains(call));
            let is_checked = [before, line]
                .iter()
                .any(|line| line.contains("Output(") || line.contains("NamedTemporaryFile("));
            let is_inside = before.starts_with("    ") && text.contains("with curious.Output(");
            assert!(!writes || is_checked || is_inside, "{}: {line}", entry.path().display());
        }
    }
}

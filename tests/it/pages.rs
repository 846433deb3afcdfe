//! The pages: every link leads to a file and a heading that exist, every flag that a command of a page has exists, and user pages
//! do not speak of how they came about.

use crate::run::{PROGRAMS, Run};
use pulldown_cmark::{Event, Parser, Tag, TagEnd};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The folders that have pages, below the root of the repository.
const FOLDERS: [&str; 8] =
    ["", "docs", "docs/estimators", "docs/figure3", "python", "worldfile", ".github", "docs/notebook"];
/// Pages that may speak of versions and of machines: the history, and what was tried.
const HISTORY: [&str; 2] = ["CHANGELOG.md", "docs/notebook"];
/// What a user page does not say: what an older program did, and how busy the machine of a measurement was.
const NOTES: [&str; 5] = ["earlier version", "a load of", "the target was", "later session", "slow session"];

struct Page {
    /// From the root of the repository.
    path: PathBuf,
    text: String,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn pages() -> Vec<Page> {
    let mut pages = Vec::new();
    for folder in FOLDERS.map(Path::new) {
        let Ok(entries) = std::fs::read_dir(root().join(folder)) else { continue };
        let names = entries.map(|entry| entry.unwrap().file_name());
        let mut paths: Vec<PathBuf> = names.map(|name| folder.join(name)).collect();
        paths.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
        paths.sort();
        pages.extend(paths.into_iter().map(|path| {
            let text = std::fs::read_to_string(root().join(&path)).unwrap();
            Page { path, text }
        }));
    }
    assert!(pages.len() > 25, "{} pages", pages.len());
    pages
}

/// The destinations of all links and pictures.
fn links(text: &str) -> Vec<String> {
    let mut links: Vec<String> = Parser::new(text)
        .filter_map(|event| match event {
            Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                Some(dest_url.into_string())
            }
            _ => None,
        })
        .collect();
    links.extend(
        text.split("<img src=\"").skip(1).filter_map(|rest| Some(rest.split_once('"')?.0.to_owned())),
    );
    links
}

/// The anchors of all headings, as web sites for repositories make them: lower case, without punctuation, hyphens for spaces; a
/// repeated one is numbered.
fn anchors(text: &str) -> BTreeSet<String> {
    let (mut anchors, mut heading) = (BTreeSet::new(), None);
    for event in Parser::new(text) {
        match (event, &mut heading) {
            (Event::Start(Tag::Heading { .. }), _) => heading = Some(String::new()),
            (Event::Text(text) | Event::Code(text), Some(heading)) => heading.push_str(&text),
            (Event::End(TagEnd::Heading(_)), Some(title)) => {
                let kept = |letter: char| match letter {
                    ' ' => Some('-'),
                    '-' | '_' => Some(letter),
                    _ => letter.is_alphanumeric().then_some(letter),
                };
                let anchor: String = title.to_lowercase().chars().filter_map(kept).collect();
                let numbered = (1..).map(|number| format!("{anchor}-{number}"));
                let free =
                    std::iter::once(anchor.clone()).chain(numbered).find(|name| !anchors.contains(name));
                anchors.extend(free);
                heading = None;
            }
            _ => {}
        }
    }
    anchors
}

#[test]
fn every_link_leads_somewhere() {
    let mut broken = Vec::new();
    for Page { path, text } in pages() {
        for link in links(&text) {
            if link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            let (file, anchor) =
                link.split_once('#').map_or((link.as_str(), None), |(file, at)| (file, Some(at)));
            let target = if file.is_empty() {
                root().join(&path)
            } else {
                root().join(path.parent().unwrap()).join(file)
            };
            let has_anchor = |anchor: &str| {
                std::fs::read_to_string(&target).is_ok_and(|text| anchors(&text).contains(anchor))
            };
            if !target.exists() || !anchor.is_none_or(has_anchor) {
                broken.push(format!("{}: {link}", path.display()));
            }
        }
    }
    assert!(broken.is_empty(), "links that lead nowhere:\n{}", broken.join("\n"));
}

/// The commands of the blocks of shell commands: joined where they are continued, without comments.
fn commands(text: &str) -> Vec<String> {
    let (mut commands, mut is_shell) = (Vec::new(), false);
    for event in Parser::new(text) {
        match event {
            Event::Start(Tag::CodeBlock(kind)) => {
                is_shell =
                    matches!(kind, pulldown_cmark::CodeBlockKind::Fenced(language) if &*language == "sh");
            }
            Event::Text(block) if is_shell => {
                let block = block.replace("\\\n", " ");
                let lines = block.lines().map(|line| line.split(" #").next().unwrap_or(line));
                commands.extend(lines.map(|line| line.trim().to_owned()));
            }
            Event::End(TagEnd::CodeBlock) => is_shell = false,
            _ => {}
        }
    }
    commands
}

#[test]
fn every_flag_of_a_command_exists() {
    let help = BTreeMap::from(PROGRAMS.map(|name| (name, Run::of(name).goes_well("--help").stdout)));
    let (mut unknown, mut tried) = (Vec::new(), 0);
    for Page { path, text } in pages().iter().filter(|page| !page.path.starts_with("CHANGELOG.md")) {
        for command in commands(text) {
            let Some((_, after)) = command.split_once("--bin ") else { continue };
            let (name, arguments) = after.split_once(" -- ").unwrap_or((after, ""));
            let Some(help) = help.get(name.trim()) else { continue };
            let flags = arguments.split_whitespace().filter(|word| word.starts_with("--"));
            for flag in flags.map(|flag| flag.split('=').next().unwrap_or(flag)) {
                tried += 1;
                let is_known = help.split(|letter: char| !(letter.is_alphanumeric() || letter == '-'));
                if !is_known.into_iter().any(|word| word == flag) {
                    unknown.push(format!("{}: {flag} of `{command}`", path.display()));
                }
            }
        }
    }
    assert!(tried > 80, "{tried} flags");
    assert!(unknown.is_empty(), "flags that do not exist:\n{}", unknown.join("\n"));
}

#[test]
fn user_pages_have_no_laboratory_notes() {
    let mut notes = Vec::new();
    for Page { path, text } in pages() {
        if HISTORY.iter().any(|history| path.starts_with(history)) {
            continue;
        }
        // A phrase can be broken by the end of a line.
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        let found = NOTES.iter().filter(|note| text.contains(*note));
        notes.extend(found.map(|note| format!("{}: {note}", path.display())));
    }
    assert!(notes.is_empty(), "laboratory notes belong into docs/notebook:\n{}", notes.join("\n"));
}

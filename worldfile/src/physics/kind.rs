//! Tables whose `kind` decides on their other keys.

use crate::reader::{Table, has};

/// A kind, its own keys, and what such a thing does.
pub(super) type KindOf = (&'static str, &'static str, &'static str);

/// The kind of a `thing`: the first one if the table gives none. A key that only other kinds have is an error.
pub(super) fn kind_of(table: &Table<'_>, kinds: &[KindOf], thing: &str) -> Option<&'static str> {
    let word = table.get("kind").map_or(Some(kinds[0].0), |kind| kind.text())?;
    let noun = thing.split_once(' ')?.1;
    let Some((kind, keys, does)) = kinds.iter().find(|(name, _, _)| *name == word) else {
        let names: Vec<String> = kinds.iter().map(|(name, _, _)| format!("\"{name}\"")).collect();
        let (what, help) = (format!("`{word}` is no kind of {noun}"), names.join(", "));
        let mark = (table.at("kind"), "not known");
        return table.error(&what, mark, &[], &format!("it must be one of {help}"));
    };
    let listed = if keys.is_empty() { String::new() } else { format!("; its keys are {keys}") };
    let help = format!("leave it out: such {thing} {does}{listed}");
    let is_foreign = |key: &str| !has(keys, key) && kinds.iter().any(|(_, keys, _)| has(keys, key));
    let foreign = table.given().filter(|(key, _)| is_foreign(key)).map(|(key, span)| {
        let what = format!("{thing} that is `{kind}` has no `{key}`");
        table.error::<()>(&what, (span, &format!("not for this {noun}")), &[], &help)
    });
    // If such a key is given, the kind may be invalid, or missing: nothing else is checked by it.
    let most = if table.has("kind") { usize::MAX } else { 1 };
    (foreign.take(most).count() == 0).then_some(*kind)
}

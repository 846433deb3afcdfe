//! Tables whose `kind` decides on their other keys.

use crate::reader::{Table, has};

/// A kind, its keys, and what such a thing does.
pub(super) type KindOf = (&'static str, &'static str, &'static str);

/// The kind with the name `word`; `noun`: what it is a kind of.
pub(super) fn kind_of<'a>(
    table: &Table<'_>,
    word: &str,
    kinds: &'a [KindOf],
    noun: &str,
) -> Option<&'a KindOf> {
    kinds.iter().find(|(name, _, _)| *name == word).or_else(|| {
        let names: Vec<String> = kinds.iter().map(|(name, _, _)| format!("\"{name}\"")).collect();
        let help = format!("it must be one of {}", names.join(", "));
        table.error(&format!("`{word}` is no {noun}"), (table.at("kind"), "not known"), &[], &help)
    })
}

/// Records every key that is neither in `common` nor a key of this kind of `thing`.
pub(super) fn has_only_own_keys(
    table: &Table<'_>,
    (kind, keys, does): &KindOf,
    common: &str,
    thing: &str,
) -> Option<()> {
    let noun = thing.split_once(' ')?.1;
    let listed = if keys.is_empty() { String::new() } else { format!("; its keys are {keys}") };
    let help = format!("leave it out: such {thing} {does}{listed}");
    let foreign = table.given().filter(|(key, _)| !has(common, key) && !has(keys, key)).map(|(key, span)| {
        let what = format!("{thing} that is `{kind}` has no `{key}`");
        table.error::<()>(&what, (span, &format!("not for this {noun}")), &[], &help)
    });
    // If such a key is given, the kind may be invalid, or missing: nothing else is checked by it.
    let most = if table.has("kind") { usize::MAX } else { 1 };
    (foreign.take(most).count() == 0).then_some(())
}

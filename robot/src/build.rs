//! Which algorithms this program was built from.
//!
//! Two programs of the same version can compute different bits, if they were built from different commits. What promises the
//! same bits (a shard, a run that goes on) carries the [`BUILD`], and is refused where it differs.

/// A hash of the sources of the algorithms and of `Cargo.lock`: 16 hexadecimal digits. Equal builds compute equal bits.
pub const BUILD: &str = env!("CURIOUS_BUILD");

/// The advice where a build differs, after the name of what has it.
pub(crate) fn other_build(found: &str) -> String {
    let found = if found.is_empty() { "an earlier version" } else { found };
    format!(
        "is of another build ({found}, this program is {BUILD}), whose results can differ; use that program, or \
         --allow-other-build"
    )
}

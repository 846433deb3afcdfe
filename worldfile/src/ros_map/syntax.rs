//! What is invalid in a text that is not a list of keys with values, in other words than those of the parser, which
//! are about its settings and its types.

use super::EXAMPLE;
use serde_saphyr::Error;

/// The fault at which the parser has stopped: its line, what it is, and what is valid.
pub(super) fn fault(error: &Error) -> (usize, &'static str, &'static str) {
    let line = error.location().map_or(1, |at| at.line() as usize);
    let (what, help) = match error {
        Error::DuplicateMappingKey { .. } => ("a key is given twice", "leave one of them out"),
        Error::MultipleDocuments { .. } => {
            ("this file has more than one document", "a map is one document: leave `---` and the rest out")
        }
        Error::NullIntoString { .. } => ("a key without a name", EXAMPLE),
        Error::Budget { .. } => ("this file has too many values, or lists in too many others", EXAMPLE),
        Error::UnknownAnchor { .. }
        | Error::AliasError { .. }
        | Error::AliasReplayLimitExceeded { .. }
        | Error::AliasExpansionLimitExceeded { .. }
        | Error::AliasReplayStackDepthExceeded { .. }
        | Error::RecursiveReferencesRequireWeakTypes { .. }
        | Error::MergeValueNotMapOrSeqOfMaps { .. } => (
            "a reference (`*name` or `<<`) to nothing, to itself or to too much",
            "write the value itself: a map needs no references",
        ),
        Error::Unexpected { .. } | Error::SerdeInvalidType { .. } => {
            ("this is not a list of keys with values", EXAMPLE)
        }
        _ => ("this is not a key with a value, here or in a line before", EXAMPLE),
    };
    (line, what, help)
}

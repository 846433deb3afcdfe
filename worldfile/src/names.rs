//! Names of worlds and of the things in them.

use crate::error::{Source, WorldError};
use crate::together::Together;
use serde_spanned::Spanned;
use std::collections::BTreeMap;

impl Source<'_> {
    /// The name in the table at `path` (empty for the file as a whole), if it is not empty.
    pub(crate) fn name(&self, path: &str, value: &Spanned<String>) -> Result<String, WorldError> {
        if !value.get_ref().trim().is_empty() {
            return Ok(value.get_ref().clone());
        }
        let what = match path {
            "" => "`name` is empty".to_owned(),
            path => format!("`{path}.name` is empty"),
        };
        let help = "give it a name, as in `name = \"curious\"`";
        Err(self.error(&what, (value.span(), "empty"), &[], help))
    }

    /// Refuses every name that a thing shares with an earlier one of its kind.
    pub(crate) fn unique<'a>(
        &self,
        kind: &str,
        names: impl Iterator<Item = &'a Spanned<String>>,
    ) -> Result<(), WorldError> {
        let mut seen = BTreeMap::new();
        let twice = names.filter_map(|name| {
            let first = seen.insert(name.get_ref(), name.span())?;
            let what = format!("two {kind}s are called `{}`", name.get_ref());
            let help = format!("every {kind} needs a name of its own");
            Some(Err(self.error(&what, (name.span(), "again here"), &[(first, "first here")], &help)))
        });
        twice.collect::<Vec<Result<(), _>>>().together().map(|_| ())
    }
}

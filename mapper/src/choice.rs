//! A part of the mapper that is chosen by name: a built-in one, or one of the user.

use std::fmt;
use std::sync::Arc;

/// A part that has a name and a list of built-in alternatives.
pub trait Named: fmt::Debug + Send + Sync + 'static {
    /// The name on the command line, in files and in reports.
    fn name(&self) -> &'static str;

    /// The built-in alternatives.
    fn built_in() -> Vec<Arc<Self>>;
}

/// One of several alternatives, shared between settings and mappers. Two choices are equal when their names are:
/// give your own part a name of its own. Serialises as its name; only names of built-in parts deserialise.
#[derive(serde::Deserialize, serde::Serialize)]
#[serde(into = "String", try_from = "String", bound = "")]
pub struct Choice<T: Named + ?Sized>(pub(crate) Arc<T>);

impl<T: Named + ?Sized> Choice<T> {
    /// Every built-in alternative.
    pub fn all() -> Vec<Self> {
        T::built_in().into_iter().map(Self).collect()
    }

    /// The built-in alternative of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().into_iter().find(|choice| choice.name() == name)
    }

    /// The name on the command line, in files and in reports.
    pub fn name(&self) -> &'static str {
        self.0.name()
    }
}

impl<T: Named + ?Sized> Clone for Choice<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T: Named + ?Sized> fmt::Debug for Choice<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl<T: Named + ?Sized> PartialEq for Choice<T> {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl<T: Named + ?Sized> Eq for Choice<T> {}

impl<T: Named + ?Sized> From<Choice<T>> for String {
    fn from(choice: Choice<T>) -> Self {
        choice.name().to_owned()
    }
}

impl<T: Named + ?Sized> TryFrom<String> for Choice<T> {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::named(&name).ok_or_else(|| {
            let names: Vec<_> = Self::all().iter().map(Self::name).collect();
            format!("`{name}` is not one of {}", names.join(", "))
        })
    }
}

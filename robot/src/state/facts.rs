use super::format::StateError;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// What a snapshot belongs to, as names with values, in order: `world` = `house`, `mapper.max_gap` = `8.0`. A snapshot fits
/// a part only if all facts are equal, except for [settings that nobody has chosen](Self::with_learned_settings).
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
pub struct Facts(Vec<Fact>);

#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
struct Fact {
    name: String,
    value: String,
    /// Whether the value is only the default of the program.
    is_default: bool,
}

/// A difference between facts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Difference {
    pub(crate) name: String,
    pub(crate) saved: Option<String>,
    pub(crate) expected: Option<String>,
}

impl Facts {
    /// Adds a fact.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl ToString) -> Self {
        self.push(name, value.to_string(), false);
        self
    }

    /// Adds every field of some settings, as `name.field`.
    #[must_use]
    pub fn with_settings<S: Serialize>(self, name: &str, settings: &S) -> Self {
        self.with_learned_settings(name, settings, None)
    }

    /// Adds every field of some settings on which the layout of a snapshot does not depend. Where a field is the default
    /// of the program that saved and of the program that reads, the two can differ: a later version has other defaults,
    /// and what was learned remains.
    #[must_use]
    pub fn with_learned_settings<S: Serialize>(
        mut self,
        name: &str,
        settings: &S,
        defaults: Option<&S>,
    ) -> Self {
        let value = |settings: &S| serde_json::to_value(settings).unwrap_or_default();
        self.add(name, &value(settings), defaults.map(value).as_ref());
        self
    }

    fn add(&mut self, name: &str, value: &Value, default: Option<&Value>) {
        let is_default = default == Some(value);
        match value {
            Value::Object(fields) => fields.iter().for_each(|(field, value)| {
                let default = default.and_then(|default| default.get(field));
                self.add(&format!("{name}.{field}"), value, default);
            }),
            Value::String(text) => self.push(name, text.clone(), is_default),
            other => self.push(name, other.to_string(), is_default),
        }
    }

    fn push(&mut self, name: &str, value: String, is_default: bool) {
        self.0.push(Fact { name: name.to_owned(), value, is_default });
    }

    /// Some settings of which every field was added, with this name; `None` if they are not settings of this program. A field
    /// that was not added has its default.
    pub fn settings<S: DeserializeOwned>(&self, name: &str) -> Option<S> {
        let mut settings = Value::Object(serde_json::Map::new());
        for (path, text) in self.iter() {
            let Some(path) = path.strip_prefix(name).and_then(|path| path.strip_prefix('.')) else {
                continue;
            };
            let field = path.split('.').fold(&mut settings, |table, field| &mut table[field]);
            *field = serde_json::from_str(text).unwrap_or_else(|_| Value::String(text.to_owned()));
        }
        serde_json::from_value(settings).ok()
    }

    /// The value of a fact.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.iter().find(|(other, _)| *other == name).map(|(_, value)| value)
    }

    /// All names and values.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|fact| (fact.name.as_str(), fact.value.as_str()))
    }

    /// The settings in which `self`, as saved, differs from what is expected, other than by a changed default: their names and saved
    /// values. The frame of a map can differ.
    ///
    /// # Errors
    ///
    /// When one of them is in `must_agree`.
    pub(crate) fn agree(&self, expected: &Self, must_agree: &[&str]) -> Result<Vec<String>, StateError> {
        let differences = self.differences(expected);
        match differences.iter().find(|other| must_agree.contains(&other.name.as_str())) {
            Some(other) => Err(other.clone().into()),
            None => Ok(differences
                .into_iter()
                .map(|Difference { name, saved, .. }| format!("{name} = {}", saved.unwrap_or_default()))
                .collect()),
        }
    }

    /// The facts in which `self`, as saved, differs from what is expected, other than by a changed default.
    pub(crate) fn differences(&self, expected: &Self) -> Vec<Difference> {
        let find = |facts: &Self, name: &str| facts.0.iter().find(|fact| fact.name == name).cloned();
        let mut names: Vec<&String> = expected.0.iter().map(|fact| &fact.name).collect();
        names.extend(self.0.iter().map(|fact| &fact.name).filter(|name| expected.get(name).is_none()));
        let pairs = names.into_iter().map(|name| (find(self, name), find(expected, name), name.clone()));
        pairs
            .filter_map(|(saved, expected, name)| {
                let is_default = |fact: &Option<Fact>| fact.as_ref().is_none_or(|fact| fact.is_default);
                let is_other_default = is_default(&saved) && is_default(&expected);
                let [saved, expected] = [saved, expected].map(|fact| fact.map(|fact| fact.value));
                (saved != expected && !is_other_default).then_some(Difference { name, saved, expected })
            })
            .collect()
    }
}

impl From<Difference> for StateError {
    fn from(Difference { name, saved, expected }: Difference) -> Self {
        let text = |value: Option<String>| value.map_or("not set".to_owned(), |value| format!("`{value}`"));
        Self::OtherFacts { name, saved: text(saved), expected: text(expected) }
    }
}

use serde::Serialize;
use serde_json::Value;

/// What a snapshot belongs to, as names with values, in order: `world` = `house`, `mapper.max_gap` = `8.0`. A snapshot fits
/// a part only if all facts are equal.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Deserialize, Serialize)]
pub struct Facts(Vec<(String, String)>);

/// The first difference between facts.
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
        self.0.push((name.to_owned(), value.to_string()));
        self
    }

    /// Adds every field of some settings, as `name.field`.
    #[must_use]
    pub fn with_settings(mut self, name: &str, settings: &impl Serialize) -> Self {
        self.add(name, &serde_json::to_value(settings).unwrap_or_default());
        self
    }

    fn add(&mut self, name: &str, value: &Value) {
        match value {
            Value::Object(fields) => {
                fields.iter().for_each(|(field, value)| self.add(&format!("{name}.{field}"), value));
            }
            Value::String(text) => self.0.push((name.to_owned(), text.clone())),
            other => self.0.push((name.to_owned(), other.to_string())),
        }
    }

    /// The first fact in which `self`, as saved, differs from what is expected.
    pub(crate) fn difference(&self, expected: &Self) -> Option<Difference> {
        let value = |facts: &Self, name: &str| {
            facts.0.iter().find(|(other, _)| other == name).map(|(_, value)| value.clone())
        };
        let names = expected.0.iter().chain(&self.0).map(|(name, _)| name);
        let mut differences = names.map(|name| Difference {
            name: name.clone(),
            saved: value(self, name),
            expected: value(expected, name),
        });
        differences.find(|difference| difference.saved != difference.expected)
    }
}

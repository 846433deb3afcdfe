//! The values of parameters.

use serde::{Deserialize, Serialize};
use std::fmt;

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// Yes or no.
    Bool(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Float(f64),
    /// A text.
    Text(String),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bool(value) => value.fmt(f),
            Self::Integer(value) => value.fmt(f),
            Self::Float(value) => write!(f, "{value:?}"),
            Self::Text(value) => value.fmt(f),
        }
    }
}

/// The value of a parameter, and where it is given.
#[derive(Clone, Debug, PartialEq)]
pub struct Given {
    /// For which nodes: a full name, in which `*` is any part and `**` any number of parts.
    pub(crate) nodes: String,
    /// The name; parameters in a table have the name of the table and a dot before theirs.
    pub name: String,
    /// The value; `None`: a list, or nothing.
    pub value: Option<Value>,
    /// The file; `None`: the command line.
    pub place: Option<String>,
}

impl Given {
    /// Whether other nodes may be meant, so that a node need not know the parameter.
    pub fn is_for_others_too(&self) -> bool {
        self.place.is_some() && self.nodes.contains('*')
    }
}

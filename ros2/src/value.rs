//! The values of parameters.

use std::fmt;

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
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

impl Value {
    /// The value of a text on the command line, as YAML has it: `true`, `5`, `0.05`, `"text"`, `text`.
    pub fn parse(text: &str) -> Self {
        let text = text.trim();
        match text {
            "true" | "True" | "TRUE" => return Self::Bool(true),
            "false" | "False" | "FALSE" => return Self::Bool(false),
            _ => {}
        }
        let first = text.chars().next();
        let is_quoted =
            matches!(first, Some('"' | '\'')) && text.len() > 1 && text.chars().next_back() == first;
        if is_quoted {
            return Self::Text(text[1..text.len() - 1].to_owned());
        }
        if let Ok(number) = text.parse() {
            return Self::Integer(number);
        }
        // `nan` and `inf` are names; YAML writes them as `.nan` and `.inf`.
        match text.parse() {
            Ok(number) if text.contains(|c: char| c.is_ascii_digit()) => Self::Float(number),
            _ => Self::Text(text.to_owned()),
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_types_of_yaml() {
        assert_eq!(Value::parse("true"), Value::Bool(true));
        assert_eq!(Value::parse("-5"), Value::Integer(-5));
        assert_eq!(Value::parse("0.05"), Value::Float(0.05));
        assert_eq!(Value::parse("1e-3"), Value::Float(0.001));
        assert_eq!(Value::parse("'5'"), Value::Text("5".into()));
        assert_eq!(Value::parse("inf"), Value::Text("inf".into()));
        assert_eq!(Value::parse("/scan"), Value::Text("/scan".into()));
        assert_eq!(Value::parse("\""), Value::Text("\"".into()));
        assert_eq!(Value::parse(""), Value::Text(String::new()));
    }
}

//! How goals are selected: by the strategy that is named, or by the one that is best for a purpose.

use super::{ParameterError, Parameters};
use agent::{PURPOSES, Policy};

impl Parameters {
    /// The strategy: as `strategy` says, or else as is best for `purpose`.
    ///
    /// # Errors
    ///
    /// When there is no such strategy or purpose, or when both are given.
    pub(crate) fn policy(&self) -> Result<Policy, ParameterError> {
        let Self { strategy, purpose, .. } = self;
        match (strategy.as_str(), purpose.as_str()) {
            ("", "") => Ok(Policy::default()),
            ("", name) => {
                let known = || PURPOSES.map(|[name, ..]| name).join(", ");
                Policy::for_purpose(name).ok_or_else(|| unknown("purpose", known(), name))
            }
            (name, "") => {
                let known = || Policy::built_in().iter().map(Policy::name).collect::<Vec<_>>().join(", ");
                Policy::named(name).ok_or_else(|| unknown("strategy", known(), name))
            }
            _ => Err(ParameterError::Both { strategy: strategy.clone(), purpose: purpose.clone() }),
        }
    }
}

fn unknown(name: &'static str, known: String, found: &str) -> ParameterError {
    ParameterError::Name { name, known, found: found.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn policy(strategy: &str, purpose: &str) -> Result<String, String> {
        let parameters = Parameters {
            strategy: strategy.to_owned(),
            purpose: purpose.to_owned(),
            ..Parameters::default()
        };
        assert_eq!(parameters.check().is_ok(), parameters.policy().is_ok());
        parameters.policy().map(|policy| policy.name().to_owned()).map_err(|error| error.to_string())
    }

    #[test]
    fn a_purpose_names_a_strategy_where_none_is_given() {
        assert_eq!(policy("", ""), Ok("curious".to_owned()));
        assert_eq!(policy("", "fresh-map"), Ok("fresh-map".to_owned()));
        assert_eq!(policy("", "learn-rates"), Ok("information-gain".to_owned()));
        assert_eq!(policy("", "paper"), Ok("curious".to_owned()));
        assert_eq!(policy("recency", ""), Ok("recency".to_owned()));
    }

    #[test]
    fn wrong_names_and_both_names_are_refused() {
        assert_eq!(
            policy("", "fame").unwrap_err(),
            "the parameter `purpose` must be one of fresh-map, learn-rates, paper, not `fame`"
        );
        let error = policy("clever", "").unwrap_err();
        assert!(error.starts_with("the parameter `strategy` must be one of curious, recency, "), "{error}");
        assert!(error.ends_with(", not `clever`"), "{error}");
        assert_eq!(
            policy("curious", "paper").unwrap_err(),
            "the parameters `strategy` (`curious`) and `purpose` (`paper`) both name a strategy: leave one of them empty"
        );
    }
}

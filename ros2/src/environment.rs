//! What the environment says about the network, as for every node of ROS.

use anyhow::Context;

/// With which hosts a node speaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Range {
    /// With all hosts that multicast reaches.
    #[default]
    Subnet,
    /// Only with programs on this host.
    Localhost,
    /// With nobody.
    Off,
}

/// The domain of a node, and how far it reaches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Environment {
    /// `ROS_DOMAIN_ID`: nodes of other domains are not seen.
    pub domain: u16,
    /// `ROS_AUTOMATIC_DISCOVERY_RANGE`; before Jazzy `ROS_LOCALHOST_ONLY`.
    pub range: Range,
    /// `RMW_IMPLEMENTATION`: whether services and actions are exchanged with nodes of CycloneDDS, which match requests and answers by
    /// a header in the message. All others match them by what DDS writes beside a message. Topics need no choice.
    pub is_cyclone: bool,
}

/// The largest domain whose ports exist.
const MAX_DOMAIN: u16 = 232;

impl Environment {
    /// Reads the variables. `variable` gives the value of one; an empty one counts as not set.
    ///
    /// # Errors
    ///
    /// When a value is not valid.
    pub fn read(variable: impl Fn(&str) -> Option<String>) -> anyhow::Result<Self> {
        let variable = |name: &str| variable(name).filter(|value| !value.is_empty());
        let domain = parsed(variable, "ROS_DOMAIN_ID", "a whole number from 0 to 232", |value| {
            value.parse().ok().filter(|domain| *domain <= MAX_DOMAIN)
        })?;
        let expected = "SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT";
        let range = parsed(variable, "ROS_AUTOMATIC_DISCOVERY_RANGE", expected, |value| match value {
            "SUBNET" | "SYSTEM_DEFAULT" => Some(Range::Subnet),
            "LOCALHOST" => Some(Range::Localhost),
            "OFF" => Some(Range::Off),
            _ => None,
        })?;
        let is_local = parsed(variable, "ROS_LOCALHOST_ONLY", "0 or 1", |value| match value {
            "0" => Some(false),
            "1" => Some(true),
            _ => None,
        })?;
        // As in ROS, the older variable wins.
        let range = if is_local == Some(true) { Range::Localhost } else { range.unwrap_or_default() };
        // Beside others, as rmw_zenoh_cpp, the node would wait for ever.
        let expected =
            "rmw_fastrtps_cpp, rmw_cyclonedds_cpp, rmw_connextdds or not set, since this node speaks DDS";
        let is_cyclone = parsed(variable, "RMW_IMPLEMENTATION", expected, |value| match value {
            "rmw_cyclonedds_cpp" => Some(true),
            "rmw_fastrtps_cpp" | "rmw_fastrtps_dynamic_cpp" | "rmw_connextdds" | "rmw_gurumdds_cpp" => {
                Some(false)
            }
            _ => None,
        })?;
        let is_cyclone = is_cyclone.unwrap_or_default();
        Ok(Self { domain: domain.unwrap_or_default(), range, is_cyclone })
    }
}

/// The value of a variable; `None` if it is not set.
fn parsed<T>(
    variable: impl Fn(&str) -> Option<String>,
    name: &str,
    expected: &str,
    parse: impl Fn(&str) -> Option<T>,
) -> anyhow::Result<Option<T>> {
    let Some(found) = variable(name) else { return Ok(None) };
    Ok(Some(parse(&found).with_context(|| format!("{name} must be {expected}, not `{found}`"))?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(variables: &[(&str, &str)]) -> Result<Environment, String> {
        let variable = |name: &str| {
            variables.iter().find(|(other, _)| *other == name).map(|(_, value)| (*value).to_owned())
        };
        Environment::read(variable).map_err(|error| error.to_string())
    }

    #[test]
    fn the_environment_is_that_of_ros() {
        let is_cyclone = false;
        assert_eq!(read(&[]), Ok(Environment { domain: 0, range: Range::Subnet, is_cyclone }));
        assert_eq!(read(&[("ROS_DOMAIN_ID", "")]), Ok(Environment::default()));
        let local = read(&[("ROS_DOMAIN_ID", "42"), ("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")]);
        assert_eq!(local, Ok(Environment { domain: 42, range: Range::Localhost, is_cyclone }));
        let both = [("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"), ("ROS_LOCALHOST_ONLY", "1")];
        assert_eq!(read(&both).unwrap().range, Range::Localhost);
        assert_eq!(read(&[("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF")]).unwrap().range, Range::Off);
        assert!(read(&[("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")]).unwrap().is_cyclone);
    }

    #[test]
    fn what_is_not_valid_is_refused() {
        let error = |name, value| read(&[(name, value)]).unwrap_err();
        insta::assert_snapshot!(error("ROS_DOMAIN_ID", "233"), @"ROS_DOMAIN_ID must be a whole number from 0 to 232, not `233`");
        insta::assert_snapshot!(error("ROS_AUTOMATIC_DISCOVERY_RANGE", "localhost"), @"ROS_AUTOMATIC_DISCOVERY_RANGE must be SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT, not `localhost`");
        insta::assert_snapshot!(error("RMW_IMPLEMENTATION", "rmw_zenoh_cpp"), @"RMW_IMPLEMENTATION must be rmw_fastrtps_cpp, rmw_cyclonedds_cpp, rmw_connextdds or not set, since this node speaks DDS, not `rmw_zenoh_cpp`");
        assert_eq!(error("ROS_LOCALHOST_ONLY", "yes"), "ROS_LOCALHOST_ONLY must be 0 or 1, not `yes`");
    }
}

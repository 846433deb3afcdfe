/// The error for a name that no built-in part has.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no {kind} is called `{name}`; there are {}", known.join(", "))]
pub struct UnknownName {
    /// The kind of the part, as in "strategy".
    pub kind: &'static str,
    /// The unknown name.
    pub name: String,
    /// The names of the built-in parts of this kind.
    pub known: Vec<&'static str>,
}

/// Implements the traits of a part that users choose by its name.
///
/// The type `$part` needs a method `name(&self) -> &'static str`. `$all` is the list of the built-in values of this
/// type; `$kind` is the name of the type in messages. Two values are equal if they have the same name. `Debug`,
/// `Display`, `FromStr` and serde use the name; only built-in values can be read.
#[macro_export]
macro_rules! chosen_by_name {
    ($part:ty, $kind:literal, $all:expr) => {
        impl PartialEq for $part {
            fn eq(&self, other: &Self) -> bool {
                self.name() == other.name()
            }
        }

        impl Eq for $part {}

        impl std::fmt::Debug for $part {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.name())
            }
        }

        impl std::fmt::Display for $part {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $part {
            type Err = $crate::UnknownName;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                let all = $all;
                all.iter().find(|part| part.name() == name).cloned().ok_or_else(|| {
                    let known = all.iter().map(Self::name).collect();
                    $crate::UnknownName { kind: $kind, name: name.to_owned(), known }
                })
            }
        }

        impl<'de> serde::Deserialize<'de> for $part {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
            }
        }

        impl serde::Serialize for $part {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.name())
            }
        }
    };
}

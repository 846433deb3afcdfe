//! What is wrong with several things at once.

use crate::error::{WorldError, Wrong};

/// Results that do not depend on each other.
pub(crate) trait Together {
    /// What they are if all of them are right.
    type All;

    /// All of them, or everything that is wrong with any: `(a, b).together()?` tells both of two errors
    /// where `(a?, b?)` would tell the first.
    fn together(self) -> Result<Self::All, WorldError>;
}

impl<T> Together for Vec<Result<T, WorldError>> {
    type All = Vec<T>;

    fn together(self) -> Result<Self::All, WorldError> {
        let mut wrong = Wrong::default();
        let all = self.into_iter().filter_map(|result| wrong.keep(result)).collect();
        if wrong.is_empty() { Ok(all) } else { Err(wrong.into_part()) }
    }
}

macro_rules! tuples {
    ($($result:ident)*) => {
        impl<$($result),*> Together for ($(Result<$result, WorldError>,)*) {
            type All = ($($result,)*);

            #[expect(non_snake_case, reason = "a result is called what its type is called")]
            fn together(self) -> Result<Self::All, WorldError> {
                let mut wrong = Wrong::default();
                let ($($result,)*) = self;
                match ($(wrong.keep($result),)*) {
                    ($(Some($result),)*) => Ok(($($result,)*)),
                    _ => Err(wrong.into_part()),
                }
            }
        }
    };
}

tuples!(A B);
tuples!(A B C);
tuples!(A B C D);
tuples!(A B C D E);
tuples!(A B C D E F);
tuples!(A B C D E F G);

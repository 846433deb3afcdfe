//! Pages of the documentation whose tables are made from files of results, so that they cannot go stale.
//!
//! A table is what is between `<!-- NAME WHICH -->` and `<!-- end -->`: the name is that of the program that makes it.

pub mod layout;
mod rows;

use crate::paired_test;
pub use rows::{Rows, columns_of, commit, write_rows};

const END: &str = "<!-- end -->";

/// A page whose tables cannot be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PageError {
    /// A comment that begins a table has no ` -->`.
    #[error("`{0}` is not closed")]
    NotClosed(String),
    /// There is no comment that ends the table.
    #[error("`{0}` has no `{END}`")]
    NoEnd(String),
    /// A table is not known, or its results are missing.
    #[error("`{which}`: {why}")]
    NoTable {
        /// What the comment asks for.
        which: String,
        /// Why there is no such table.
        why: String,
    },
}

/// The page with all tables of a program made anew.
///
/// # Errors
///
/// When a comment is not complete, or when `table` fails.
pub fn with_tables(
    page: &str,
    name: &str,
    table: impl Fn(&str) -> Result<String, String>,
) -> Result<String, PageError> {
    let begin = format!("<!-- {name} ");
    let (mut text, mut rest) = (String::new(), page);
    while let Some((before, after)) = rest.split_once(&begin) {
        let (which, after) = after.split_once(" -->").ok_or_else(|| PageError::NotClosed(begin.clone()))?;
        let (_, after) = after.split_once(END).ok_or_else(|| PageError::NoEnd(format!("{begin}{which}")))?;
        let made = table(which).map_err(|why| PageError::NoTable { which: which.to_owned(), why })?;
        text += &format!("{before}{begin}{which} -->\n\n{}\n\n{END}", made.trim_end());
        rest = after;
    }
    Ok(text + rest)
}

/// The mean of the values that are numbers.
pub fn mean(values: &[f64]) -> f64 {
    let finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    finite.iter().sum::<f64>() / finite.len() as f64
}

/// The ratio of two means, with the p-value of the paired t test of the differences: `0.751, p = 2.1e-7`. One
/// pair has no p-value.
pub fn ratio(values: &[f64], others: &[f64]) -> String {
    let ratio = mean(values) / mean(others);
    if values.len() < 2 {
        return format!("{ratio:.3}");
    }
    let p = paired_test(values.iter().zip(others).map(|(value, other)| value - other)).p_value;
    let p = match p {
        p if p < 1e-3 => format!("{p:.1e}"),
        p if p < 0.01 => format!("{p:.4}"),
        p => format!("{p:.2}"),
    };
    format!("{ratio:.3}, p = {p}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_pair_has_a_ratio_and_no_p_value() {
        assert_eq!(ratio(&[1.0], &[4.0]), "0.250");
        assert_eq!(ratio(&[1.0, 2.0, 4.0], &[2.0, 4.0, 5.0]), "0.636, p = 0.06");
    }

    #[test]
    fn tables_are_made_anew_and_all_else_stays() {
        let page = "a\n<!-- x 1 -->\nold\n<!-- end -->\nb\n<!-- y 2 -->\nkept\n<!-- end -->\n<!-- x 3 --><!-- end -->";
        let made = with_tables(page, "x", |which| Ok(format!("new {which}\n"))).unwrap();
        let first = "a\n<!-- x 1 -->\n\nnew 1\n\n<!-- end -->\nb\n<!-- y 2 -->\nkept\n<!-- end -->\n";
        assert_eq!(made, format!("{first}<!-- x 3 -->\n\nnew 3\n\n<!-- end -->"));
        assert_eq!(with_tables(&made, "x", |which| Ok(format!("new {which}"))), Ok(made));
    }

    #[test]
    fn what_is_not_complete_is_refused() {
        let made = |page| with_tables(page, "x", |_| Err("there is no such table".to_owned()));
        assert_eq!(made("<!-- x 1"), Err(PageError::NotClosed("<!-- x ".to_owned())));
        assert_eq!(made("<!-- x 1 --> old"), Err(PageError::NoEnd("<!-- x 1".to_owned())));
        assert_eq!(made("<!-- x 1 --><!-- end -->").unwrap_err().to_string(), "`1`: there is no such table");
    }
}

//! The format of numbers in the table, the figures and the verdict.

/// A value with `decimals`; a dash where it is not a number.
pub(super) fn value(value: f64, decimals: usize) -> String {
    if value.is_finite() { format!("{value:.decimals$}") } else { "-".into() }
}

/// A difference, with its sign; zero has none.
pub(super) fn difference(value: f64, decimals: usize) -> String {
    let text = if value.is_finite() { format!("{value:+.decimals$}") } else { return "-".into() };
    let is_zero = !text.contains(|letter: char| ('1'..='9').contains(&letter));
    if is_zero { text.replace(['+', '-'], " ") } else { text }
}

/// `p = 0.012`, `p < 0.001`, or `no test` for a single pair.
pub(super) fn p_value(p_value: f64) -> String {
    match p_value {
        p if p.is_nan() => "no test".into(),
        p if p < 0.001 => "p < 0.001".into(),
        p => format!("p = {p:.3}"),
    }
}

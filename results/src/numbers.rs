//! Numbers as text.

/// A share with one decimal of a percent, as `97.3 %`. A part is never rounded to all or to nothing: `>99.9 %` is less
/// than `100.0 %`, and `<0.1 %` is more than `0.0 %`.
pub fn percent(share: f64) -> String {
    match format!("{:.1} %", 100.0 * share) {
        all if all == "100.0 %" && share < 1.0 => ">99.9 %".into(),
        none if none == "0.0 %" && share > 0.0 => "<0.1 %".into(),
        text => text,
    }
}

/// Rounds to millionths: a sum of tenths of a second is 31.4, not 31.400000000000002.
pub fn rounded(value: f64) -> f64 {
    libm::round(1e6 * value) / 1e6
}

/// `12345` as `12,345`.
pub fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join(",")
}

/// A time with a unit that suits it, as in `12 min`.
pub fn duration(time_s: f64) -> String {
    match time_s {
        time_s if time_s < 100.0 => format!("{time_s:.0} s"),
        time_s if time_s < 6000.0 => format!("{:.0} min", time_s / 60.0),
        time_s => format!("{:.0} h", time_s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn a_part_is_neither_all_nor_nothing() {
        let texts = [0.0, 1e-6, 0.0006, 0.973, 0.9994, 0.9996, 1.0 - 1e-9, 1.0, 2.51].map(percent);
        let expected =
            ["0.0 %", "<0.1 %", "0.1 %", "97.3 %", "99.9 %", ">99.9 %", ">99.9 %", "100.0 %", "251.0 %"];
        assert_eq!(texts, expected);
    }
}

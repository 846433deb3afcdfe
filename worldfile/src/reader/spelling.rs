//! The key that a misspelled one means.

/// The known key that is close enough to be what was meant.
pub(super) fn nearest<'a>(unknown: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let length = unknown.chars().count();
    let most = 1 + length / 3;
    // Each character that one key is longer takes an edit: a key of a megabyte is near to none.
    let candidates = known.filter(|known| known.len().abs_diff(length) <= most);
    let edits = |known| (strsim::levenshtein(unknown, known), known.len().abs_diff(length), known);
    candidates.map(edits).min().filter(|(edits, _, _)| *edits <= most).map(|(_, _, known)| known)
}

#[cfg(test)]
mod tests {
    #[test]
    fn near_names_are_found_and_far_ones_are_not() {
        let known = ["radius_m", "heading_deg", "name"];
        let nearest = |unknown: &str, known: &[&'static str]| super::nearest(unknown, known.iter().copied());
        assert_eq!(nearest("raduis_m", &known), Some("radius_m"));
        assert_eq!(nearest("nmae", &["map", "name"]), Some("name"));
        assert_eq!(nearest("heading", &known), None);
        assert_eq!(nearest("colour", &known), None);
    }
}

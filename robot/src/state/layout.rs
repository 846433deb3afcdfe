/// The types in a source text that serde can read, without comments and spaces: what is saved of them follows from their fields, and
/// a list of values from the function that makes it.
pub(crate) fn layout(text: &str) -> String {
    let mut layout = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let indent = &line[..line.len() - line.trim_start().len()];
        let is_type = line.trim_start().starts_with("#[derive(") && line.contains("Deserialize");
        if !is_type && !(line.contains("fn values(") && line.ends_with('{')) {
            continue;
        }
        let mut is_item = !is_type;
        for line in std::iter::once(line).chain(lines.by_ref()) {
            let code = line.split("//").next().unwrap_or_default().trim();
            layout.extend(code.split_whitespace());
            is_item |= ["struct ", "enum "].iter().any(|word| code.contains(word));
            let is_end =
                code.ends_with(';') || line.strip_prefix(indent).is_some_and(|rest| rest.starts_with('}'));
            if is_item && (is_end && line.starts_with(indent) || code.ends_with("{}")) {
                break;
            }
        }
        layout.push('\n');
    }
    layout
}

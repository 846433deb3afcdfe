//! The documentation agrees with the code.

#[test]
fn every_line_that_hello_explains_is_in_hello() {
    let (text, program) = (include_str!("../../../hello.md"), include_str!("../../../examples/hello.rs"));
    let table = &text[text.find("| line |").unwrap()..];
    let mut rest = program;
    for row in table.lines().skip(2) {
        let line = row.split('`').nth(1).unwrap().replace("\\|", "|");
        // In the order of the program.
        let at = rest.find(&line).unwrap_or_else(|| panic!("not there, or not in this order: {line}"));
        rest = &rest[at + line.len()..];
    }
    let shown = text.split("```").nth(1).unwrap().trim();
    assert!(program.trim().ends_with(shown));
    assert!(program.lines().count() < 60);
}

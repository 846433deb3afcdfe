//! Text from files and command lines, made safe to print.

use std::borrow::Cow;

/// Whether a character can be printed: no control character, no line separator, no mark that turns the direction
/// of writing, and none that XML forbids. Others could reach the terminal, forge lines of a report, or break a
/// picture.
pub fn is_printable(character: char) -> bool {
    let is_special = matches!(
        character,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{fffe}' | '\u{ffff}'
    );
    !character.is_control() && !is_special
}

/// The text as one printable line: every other character is escaped, as in `\n` or `\u{1b}`.
pub fn printable(text: &str) -> Cow<'_, str> {
    if text.chars().all(is_printable) {
        return Cow::Borrowed(text);
    }
    let shown = |character: char| match is_printable(character) {
        true => character.to_string(),
        false => character.escape_default().to_string(),
    };
    text.chars().map(shown).collect()
}

/// The text with its lines, each of them [`printable`].
pub fn printable_lines(text: &str) -> Cow<'_, str> {
    text.split('\n').map(printable).collect::<Vec<_>>().join("\n").into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_printable_is_escaped() {
        assert!(matches!(printable("räume 日本 <&> \\ \""), Cow::Borrowed(_)));
        assert_eq!(printable("a\u{1b}[2J\nb\t\0\u{9b}\u{7f}"), "a\\u{1b}[2J\\nb\\t\\u{0}\\u{9b}\\u{7f}");
        assert_eq!(printable("x\u{202e}y\u{2028}\u{ffff}"), "x\\u{202e}y\\u{2028}\\u{ffff}");
        assert_eq!(printable_lines("a\r\nb\u{85}\n"), "a\\r\nb\\u{85}\n");
        assert_eq!(printable_lines("a\nb\n"), "a\nb\n");
    }
}

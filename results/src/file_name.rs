//! Names of worlds as names of files.

/// The maximum length of a name, bytes. File systems allow 255; the files of a report have more in their names.
pub const MAX_NAME_BYTES: usize = 100;

/// Whether a name can be the name of a file on every common system.
///
/// # Errors
/// When the name is empty, too long, begins with a dot, or has a character that separates folders or is not printable: the reason.
pub fn check(name: &str) -> Result<(), String> {
    let invalid = |letter: &char| "/\\".contains(*letter) || !interfaces::is_printable(*letter);
    match name.len() {
        0 => Err("it is empty".into()),
        bytes if bytes > MAX_NAME_BYTES => {
            Err(format!("it has {bytes} bytes, and {MAX_NAME_BYTES} are the most"))
        }
        _ if name.starts_with('.') => Err("it begins with a dot".into()),
        _ => name
            .chars()
            .find(invalid)
            .map_or(Ok(()), |letter| Err(format!("it has the character `{}`", letter.escape_default()))),
    }
}

/// The name of a file for any name: letters, digits, `-`, `_` and `.` stay, other characters become `_`. A name that
/// is too long is cut. Two names can become one.
pub fn of(name: &str) -> String {
    let keep = |letter: char| if letter.is_alphanumeric() || "-_.".contains(letter) { letter } else { '_' };
    let mut file_name: String = name.chars().map(keep).collect();
    if file_name.starts_with('.') || file_name.is_empty() {
        file_name.replace_range(..file_name.len().min(1), "_");
    }
    file_name.truncate(file_name.floor_char_boundary(MAX_NAME_BYTES));
    file_name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files() {
        for name in ["two blocks", "räume-3.b", "a..b", "-", "a<b & c", &"n".repeat(100)] {
            assert_eq!(check(name), Ok(()), "{name}");
        }
        for (name, why) in [
            ("", "it is empty"),
            ("..", "it begins with a dot"),
            ("../up", "it begins with a dot"),
            ("a/b", "it has the character `/`"),
            ("a\\b", "it has the character `\\\\`"),
            ("a\0b", "it has the character `\\u{0}`"),
            (&"ü".repeat(51), "it has 102 bytes, and 100 are the most"),
        ] {
            assert_eq!(check(name), Err(why.to_owned()), "{name}");
        }
    }

    #[test]
    fn every_name_becomes_the_name_of_a_file() {
        assert_eq!(of("two blocks: a/b"), "two_blocks__a_b");
        assert_eq!(of("räume-3.b"), "räume-3.b");
        assert_eq!((of(""), of(".."), of(".x")), ("_".to_owned(), "_.".to_owned(), "_x".to_owned()));
        for name in ["", "..", "/etc", "a\u{1b}[2J\n", &"ü".repeat(200), &".".repeat(300)] {
            assert_eq!(check(&of(name)), Ok(()), "{name}");
        }
    }
}

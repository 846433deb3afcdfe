//! Names of worlds as names of files.

/// The maximum length of a name, bytes. File systems allow 255; the files of a report have more in their names.
pub const MAX_NAME_BYTES: usize = 100;

/// The reason why a name cannot be the name of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileNameError {
    /// The name has no characters.
    #[error("it is empty")]
    Empty,
    /// The name is too long.
    #[error("it has {bytes} bytes, and {MAX_NAME_BYTES} are the most")]
    Long {
        /// The length of the name, bytes.
        bytes: usize,
    },
    /// The name begins with a dot: the file would be hidden, or be a folder.
    #[error("it begins with a dot")]
    Dot,
    /// A character that separates folders, or that is not printable.
    #[error("it has the character `{}`", .0.escape_default())]
    Character(char),
}

/// Whether a name can be the name of a file on every common system.
///
/// # Errors
///
/// When the name is empty, too long, begins with a dot, or has a character that separates folders or is not
/// printable.
pub fn check(name: &str) -> Result<(), FileNameError> {
    if name.is_empty() {
        return Err(FileNameError::Empty);
    }
    if name.len() > MAX_NAME_BYTES {
        return Err(FileNameError::Long { bytes: name.len() });
    }
    if name.starts_with('.') {
        return Err(FileNameError::Dot);
    }
    let invalid = name.chars().find(|&letter| "/\\".contains(letter) || !interfaces::is_printable(letter));
    invalid.map_or(Ok(()), |letter| Err(FileNameError::Character(letter)))
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
        for (name, error) in [
            ("", FileNameError::Empty),
            (".", FileNameError::Dot),
            ("..", FileNameError::Dot),
            (".hidden", FileNameError::Dot),
            ("../up", FileNameError::Dot),
            ("a/b", FileNameError::Character('/')),
            ("a\\b", FileNameError::Character('\\')),
            ("a\0b", FileNameError::Character('\0')),
            ("a\nb", FileNameError::Character('\n')),
            (&"ü".repeat(51), FileNameError::Long { bytes: 102 }),
        ] {
            assert_eq!(check(name), Err(error), "{name}");
        }
        assert_eq!(FileNameError::Character('\0').to_string(), "it has the character `\\u{0}`");
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

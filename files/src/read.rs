//! The one reader of files that a user names. A pipe, a device or a folder in their place could wait or send forever, and a file
//! that is longer than any of its kind could fill the memory.

use std::fs::{self, File};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Opens a regular file.
///
/// # Errors
///
/// When the file cannot be opened or is not regular.
pub fn open(path: &Path) -> Result<File> {
    // Before it is opened: opening a pipe waits for its other end.
    if !fs::metadata(path)?.is_file() {
        return Err(Error::other("it is not a regular file (but a folder, a pipe or a device)"));
    }
    File::open(path)
}

/// The content of a regular file.
///
/// # Errors
///
/// When the file cannot be read, is not regular, or has more than `max_bytes` bytes.
pub fn read(path: &Path, max_bytes: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.take(max_bytes.saturating_add(1)).read_to_end(&mut bytes)?;
    within(bytes, max_bytes)
}

/// The bytes of a file, if there are at most `max_bytes`.
///
/// # Errors
///
/// When there are more.
pub fn within(bytes: Vec<u8>, max_bytes: u64) -> Result<Vec<u8>> {
    if bytes.len() as u64 > max_bytes {
        return Err(Error::new(ErrorKind::FileTooLarge, format!("it has more than {max_bytes} bytes")));
    }
    Ok(bytes)
}

/// The content of a regular text file.
///
/// # Errors
///
/// As [`read`], and when it is not UTF-8.
pub fn read_text(path: &Path, max_bytes: u64) -> Result<String> {
    let not_text = |_| Error::new(ErrorKind::InvalidData, "it is not a text file (UTF-8)");
    String::from_utf8(read(path, max_bytes)?).map_err(not_text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_up_to_a_length_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        fs::write(&path, "four").unwrap();
        assert_eq!(read_text(&path, 4).unwrap(), "four");
        assert_eq!(read(&path, 3).unwrap_err().to_string(), "it has more than 3 bytes");
        fs::write(&path, [0xff]).unwrap();
        assert_eq!(read_text(&path, 4).unwrap_err().to_string(), "it is not a text file (UTF-8)");
        for other in [folder.path(), Path::new("/dev/zero")].into_iter().filter(|path| path.exists()) {
            let why = read(other, 4).unwrap_err().to_string();
            assert_eq!(why, "it is not a regular file (but a folder, a pipe or a device)");
        }
        assert_eq!(read(&folder.path().join("none"), 4).unwrap_err().kind(), ErrorKind::NotFound);
    }
}

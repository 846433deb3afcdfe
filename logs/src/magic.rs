//! The first bytes of files, by which a format is known whatever the name is.

/// MCAP.
pub(crate) const MCAP: [u8; 8] = *b"\x89MCAP0\r\n";
/// SQLite.
pub(crate) const SQLITE: [u8; 16] = *b"SQLite format 3\0";
/// A bag of ROS 1.
pub(crate) const ROS1: &[u8] = b"#ROSBAG V";
/// A file that is compressed with zstd.
pub(crate) const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
/// A file that is compressed with gzip.
pub(crate) const GZIP: [u8; 2] = [0x1f, 0x8b];
/// A zip archive, with files or without.
pub(crate) const ZIP: [&[u8]; 2] = [b"PK\x03\x04", b"PK\x05\x06"];
/// A tar archive has this after 257 bytes.
pub(crate) const TAR: &[u8] = b"ustar";
pub(crate) const TAR_AT: usize = 257;
/// Formats that are not looked into: the name, the first bytes, and the command that unpacks.
pub(crate) const OTHERS: [(&str, &[u8], &str); 5] = [
    ("bzip2", b"BZh", "bzip2 -d FILE"),
    ("xz", b"\xfd7zXZ\0", "xz -d FILE"),
    ("lz4", b"\x04\x22\x4d\x18", "lz4 -d FILE"),
    ("7-Zip", b"7z\xbc\xaf\x27\x1c", "7z x FILE"),
    ("RAR", b"Rar!\x1a\x07", "unrar x FILE"),
];

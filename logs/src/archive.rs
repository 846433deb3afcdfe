//! Files that are no log but can have one inside: bags of ROS 1, archives, and other compressions. They are named as what they are,
//! with what would be right.

use crate::bytes::{Bytes, GZIP, MCAP, SQLITE, ZSTD};
use flate2::bufread::MultiGzDecoder;
use std::io::{self, BufReader, Read};

/// The bytes by which a file is known: a tar archive has its name after 257 bytes.
const HEAD: u64 = 512;
/// The name of a format, its first bytes and the number of bytes before them, and what to do with it.
const FORMATS: [(&str, &[u8], usize, &str); 12] = [
    (
        "bag of ROS 1",
        b"#ROSBAG V",
        0,
        "convert it with `rosbags-convert --src FILE.bag --dst FOLDER` (from PyPI: pip install rosbags)",
    ),
    (
        "bag of ROS before 0.11",
        b"#ROSRECORD V",
        0,
        "convert it with `rosbag migrate` of ROS 1, and the result with `rosbags-convert --src FILE.bag --dst FOLDER`",
    ),
    ("MATLAB file", b"MATLAB 5.0 MAT-file", 0, MATLAB),
    ("MATLAB file", b"MATLAB 7.3 MAT-file", 0, MATLAB),
    ("tar archive", b"ustar", 257, "unpack it with `tar -xf FILE`"),
    ("zip archive", b"PK\x03\x04", 0, "unpack it with `unzip FILE`"),
    ("zip archive", b"PK\x05\x06", 0, "unpack it with `unzip FILE`"),
    ("file compressed with bzip2", b"BZh", 0, "unpack it with `bzip2 -d FILE`"),
    ("file compressed with xz", b"\xfd7zXZ\0", 0, "unpack it with `xz -d FILE`"),
    ("file compressed with lz4", b"\x04\x22\x4d\x18", 0, "unpack it with `lz4 -d FILE`"),
    ("7-Zip archive", b"7z\xbc\xaf\x27\x1c", 0, "unpack it with `7z x FILE`"),
    ("RAR archive", b"Rar!\x1a\x07", 0, "unpack it with `unrar x FILE`"),
];

const MATLAB: &str =
    "read it with `scipy.io.loadmat` or h5py, and write a CARMEN log or a bag (docs/bags.md)";

/// What a file is, and what would be right; `None` for a log, and for what is not known.
///
/// # Errors
///
/// When the file cannot be read.
pub(crate) fn named(bytes: &Bytes) -> io::Result<Option<String>> {
    let start = head(bytes.open()?);
    let packed = BufReader::new(bytes.open()?);
    let (inside, compression) = match () {
        () if start.is_empty() => return Ok(Some("an empty file: copy the log again".to_owned())),
        () if start.starts_with(&GZIP) => (head(MultiGzDecoder::new(packed)), "gzip"),
        () if start.starts_with(&ZSTD) => (head(zstd::stream::read::Decoder::with_buffer(packed)?), "zstd"),
        () => return Ok(format(&start).map(|(name, what)| format!("a {name}; {what}"))),
    };
    if let Some((name, what)) = format(&inside) {
        let unpack = format!("after `{compression} -d FILE`");
        return Ok(Some(format!("a {name}, compressed with {compression}: {unpack}, {what}")));
    }
    let is_bag = inside.starts_with(&MCAP) || inside.starts_with(&SQLITE);
    let what = "a bag of ROS 2, compressed with gzip, which is not read: unpack it with `gzip -d FILE`";
    Ok((is_bag && compression == "gzip").then(|| what.to_owned()))
}

/// The name of the format of a file with these first bytes, and what to do with it.
fn format(head: &[u8]) -> Option<(&'static str, &'static str)> {
    let is_this = |(_, magic, at, _): &&(_, &[u8], usize, _)| {
        head.get(*at..).is_some_and(|rest| rest.starts_with(magic))
    };
    FORMATS.iter().find(is_this).map(|(name, _, _, what)| (*name, *what))
}

/// The first bytes; fewer where they cannot be read.
fn head(from: impl Read) -> Vec<u8> {
    let mut bytes = Vec::new();
    let _ = from.take(HEAD).read_to_end(&mut bytes);
    bytes
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{Log, TopicChoice};
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use std::io::Write;

    const ROS1: &[u8] = b"#ROSBAG V2.0\nand so on";
    const MCAP: &[u8] = b"\x89MCAP0\r\nand so on";
    const CARMEN: &[u8] = b"# a log\nPARAM robot_frontlaser_offset 0.1\n";

    fn what(bytes: &[u8]) -> String {
        let named = named(&Bytes::Memory(bytes.into())).unwrap();
        named.unwrap_or_else(|| "a log, or not known".to_owned())
    }

    pub(crate) fn gzipped(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn what_is_no_log_is_named() {
        let zstd = zstd::encode_all(ROS1, 0).unwrap();
        let mut tar = vec![0; 257];
        tar.extend(b"ustar");
        insta::assert_snapshot!(what(ROS1), @"a bag of ROS 1; convert it with `rosbags-convert --src FILE.bag --dst FOLDER` (from PyPI: pip install rosbags)");
        insta::assert_snapshot!(what(&gzipped(ROS1)), @"a bag of ROS 1, compressed with gzip: after `gzip -d FILE`, convert it with `rosbags-convert --src FILE.bag --dst FOLDER` (from PyPI: pip install rosbags)");
        assert_eq!(what(&zstd), what(&gzipped(ROS1)).replace("gzip", "zstd"));
        insta::assert_snapshot!(what(&gzipped(&tar)), @"a tar archive, compressed with gzip: after `gzip -d FILE`, unpack it with `tar -xf FILE`");
        insta::assert_snapshot!(what(b"PK\x03\x04"), @"a zip archive; unpack it with `unzip FILE`");
        insta::assert_snapshot!(what(b"MATLAB 7.3 MAT-file, Platform"), @"a MATLAB file; read it with `scipy.io.loadmat` or h5py, and write a CARMEN log or a bag (docs/bags.md)");
        insta::assert_snapshot!(what(b""), @"an empty file: copy the log again");
        assert!(what(b"#ROSRECORD V1.1\n").starts_with("a bag of ROS before 0.11; "));
        insta::assert_snapshot!(what(&gzipped(MCAP)), @"a bag of ROS 2, compressed with gzip, which is not read: unpack it with `gzip -d FILE`");
    }

    #[test]
    fn logs_are_no_archives() {
        for log in
            [CARMEN, &gzipped(CARMEN), MCAP, &zstd::encode_all(MCAP, 0).unwrap(), b"\x1f\x8b", b"hello"]
        {
            assert_eq!(what(log), "a log, or not known");
        }
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(b"PK\x03\x04").unwrap();
        let error = Log::open(file.path(), &TopicChoice::default()).unwrap_err().to_string();
        assert!(error.starts_with(&format!("{}: a zip archive; ", file.path().display())), "{error}");
    }
}

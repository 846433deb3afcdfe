use super::named;
use crate::Log;
use crate::bytes::Bytes;
use crate::choice::TopicChoice;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;

const ROS1: &[u8] = b"#ROSBAG V2.0\nand so on";
const MCAP: &[u8] = b"\x89MCAP0\r\nand so on";
const CARMEN: &[u8] = b"# a log\nPARAM robot_frontlaser_offset 0.1\n";

fn what(bytes: &[u8]) -> String {
    let named = named(&Bytes::Memory(bytes.into())).unwrap();
    named.unwrap_or_else(|| "a log, or not known".to_owned())
}

fn zipped(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        archive.start_file(*name, SimpleFileOptions::default()).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn tarred(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = tar::Builder::new(Vec::new());
    for (name, bytes) in files {
        let mut header = tar::Header::new_ustar();
        header.set_size(bytes.len() as u64);
        archive.append_data(&mut header, name, *bytes).unwrap();
    }
    archive.into_inner().unwrap()
}

fn gzipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn bags_of_ros_1_are_named_wherever_they_are() {
    let convert =
        |bag: &str| format!("`rosbags-convert --src {bag} --dst FOLDER` (from PyPI: pip install rosbags)");
    assert_eq!(what(ROS1), format!("a bag of ROS 1; convert it with {}", convert("FILE.bag")));
    let expected = "a bag of ROS 1, compressed with gzip: unpack it (`gzip -d FILE`), and convert it with ";
    assert_eq!(what(&gzipped(ROS1)), expected.to_owned() + &convert("FILE.bag"));
    let zstd = zstd::encode_all(ROS1, 0).unwrap();
    assert_eq!(what(&zstd), expected.replace("gzip", "zstd") + &convert("FILE.bag"));
    let files: [(&str, &[u8]); 2] = [("run/readme.txt", b"hello"), ("run/2.bag", ROS1)];
    let of = |kind: &str, command: &str| {
        format!(
            "an archive ({kind}) with a bag of ROS 1, `run/2.bag`: unpack it (`{command}`), and convert the bag with {}",
            convert("run/2.bag")
        )
    };
    assert_eq!(what(&zipped(&files)), of("zip", "unzip FILE"));
    assert_eq!(what(&tarred(&files)), of("tar", "tar -xf FILE"));
    assert_eq!(what(&gzipped(&tarred(&files))), of("tar with gzip", "tar -xf FILE"));
    let zstd = zstd::encode_all(&tarred(&files)[..], 0).unwrap();
    assert_eq!(what(&zstd), of("tar with zstd", "tar -xf FILE"));
}

#[test]
fn logs_in_archives_are_named() {
    let files: [(&str, &[u8]); 2] =
        [("drive/metadata.yaml", b"rosbag2_bagfile_information:"), ("drive/0.mcap", MCAP)];
    let expected = "an archive (zip) with a bag of ROS 2, `drive/0.mcap`: unpack it (`unzip FILE`), and give the folder `drive`";
    assert_eq!(what(&zipped(&files)), expected);
    let expected =
        "an archive (tar) with a bag of ROS 2: unpack it (`tar -xf FILE`), and give the file `0.mcap`";
    assert_eq!(what(&tarred(&[("0.mcap", MCAP)])), expected);
    let expected =
        "an archive (zip) with a CARMEN log: unpack it (`unzip FILE`), and give the file `a.log.gz`";
    assert_eq!(what(&zipped(&[("a.log.gz", &gzipped(CARMEN))])), expected);
    let expected =
        "a bag of ROS 2, compressed with gzip, which is not read: unpack it first (`gzip -d FILE`)";
    assert_eq!(what(&gzipped(MCAP)), expected);
    let expected = "a CARMEN log, compressed with zstd, which is not read: unpack it first (`zstd -d FILE`)";
    assert_eq!(what(&zstd::encode_all(CARMEN, 0).unwrap()), expected);
}

#[test]
fn archives_without_a_log_say_what_they_contain() {
    let logs = "logs are CARMEN logs and bags of ROS 2 (MCAP, SQLite)";
    assert_eq!(what(&zipped(&[])), format!("an archive (zip) without a log: it contains nothing; {logs}"));
    let text: &[u8] = b"text";
    let files: Vec<(&str, &[u8])> = ["a", "b", "c", "d", "e", "f", "g"].map(|name| (name, text)).into();
    let expected = format!("an archive (tar) without a log: it contains a, b, c, d, e and 2 more; {logs}");
    assert_eq!(what(&tarred(&files)), expected);
    let mut cut = zipped(&files);
    cut.truncate(100);
    let expected = "an archive (zip) that cannot be listed (";
    assert!(what(&cut).starts_with(expected), "{}", what(&cut));
    let expected = "a file in the format bzip2, which is not read: unpack it first (`bzip2 -d FILE`)";
    assert_eq!(what(b"BZh91AY&SY"), expected);
}

#[test]
fn logs_are_no_archives() {
    for log in
        [CARMEN, &gzipped(CARMEN), MCAP, &zstd::encode_all(MCAP, 0).unwrap(), b"", b"\x1f\x8b", b"hello"]
    {
        assert_eq!(what(log), "a log, or not known");
    }
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(&zipped(&[("2.bag", ROS1)])).unwrap();
    let error = Log::open(file.path(), &TopicChoice::default()).unwrap_err().to_string();
    let expected = format!("{}: an archive (zip) with a bag of ROS 1, `2.bag`: ", file.path().display());
    assert!(error.starts_with(&expected), "{error}");
}

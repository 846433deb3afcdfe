//! Files that are no log but can have one inside: bags of ROS 1, archives, and other compressions. They are named as what they are,
//! with what would be right.

mod content;
mod entries;

use crate::bounds::Unpacked;
use crate::bytes::Bytes;
use crate::magic::{GZIP, OTHERS, ZSTD};
use content::{Content, head};
use entries::{Listed, of_tar, of_zip};
use flate2::bufread::MultiGzDecoder;
use std::io::{self, BufReader, Read, Seek, SeekFrom};

/// What a file is, and what would be right; `None` for a log, and for what is not known.
///
/// # Errors
///
/// When the file cannot be read.
pub(crate) fn named(bytes: &Bytes) -> io::Result<Option<String>> {
    let mut file = bytes.open()?;
    let packed = file.seek(SeekFrom::End(0))?;
    file.rewind()?;
    let start = head(&mut file);
    file.rewind()?;
    match Content::of(&start) {
        Content::Ros1 => {
            return Ok(Some(format!("a bag of ROS 1; convert it with {}", converter("FILE.bag"))));
        }
        Content::Zip => return Ok(Some(archive("zip", "unzip FILE", of_zip(file)))),
        Content::Tar => return Ok(Some(archive("tar", "tar -xf FILE", of_tar(file)))),
        _ => {}
    }
    if let Some((name, _, command)) = OTHERS.iter().find(|(_, magic, _)| start.starts_with(magic)) {
        return Ok(Some(format!(
            "a file in the format {name}, which is not read: unpack it first (`{command}`)"
        )));
    }
    let open = || -> io::Result<Box<dyn Read>> {
        let input = BufReader::new(bytes.open()?);
        Ok(match start.starts_with(&GZIP) {
            true => Box::new(Unpacked::new(MultiGzDecoder::new(input), packed, "gzip -d FILE")),
            false => Box::new(Unpacked::new(
                zstd::stream::read::Decoder::with_buffer(input)?,
                packed,
                "zstd -d FILE",
            )),
        })
    };
    let (name, command) = match () {
        () if start.starts_with(&GZIP) => ("gzip", "gzip -d FILE"),
        () if start.starts_with(&ZSTD) => ("zstd", "zstd -d FILE"),
        () => return Ok(None),
    };
    let is_gzip = name == "gzip";
    Ok(match Content::of(&head(&mut open()?)) {
        Content::Ros1 => Some(format!(
            "a bag of ROS 1, compressed with {name}: unpack it (`{command}`), and convert it with {}",
            converter("FILE.bag")
        )),
        Content::Ros2 if is_gzip => Some(format!(
            "a bag of ROS 2, compressed with gzip, which is not read: unpack it first (`{command}`)"
        )),
        Content::Carmen if !is_gzip => Some(format!(
            "a CARMEN log, compressed with zstd, which is not read: unpack it first (`{command}`)"
        )),
        Content::Tar => Some(archive(&format!("tar with {name}"), "tar -xf FILE", of_tar(open()?))),
        Content::Zip => Some(format!("a zip archive, compressed with {name}: unpack it first (`{command}`)")),
        _ => None,
    })
}

/// The command that converts a bag of ROS 1.
fn converter(bag: &str) -> String {
    format!("`rosbags-convert --src {bag} --dst FOLDER` (from PyPI: pip install rosbags)")
}

/// What to do with an archive with these files.
fn archive(kind: &str, command: &str, listed: io::Result<Listed>) -> String {
    let what = format!("an archive ({kind})");
    let Listed { log, names, files } = match listed {
        Ok(listed) => listed,
        Err(error) => return format!("{what} that cannot be listed ({error}); unpack it (`{command}`)"),
    };
    let Some((name, content)) = log else {
        let names = if names.is_empty() { "nothing".to_owned() } else { names.join(", ") };
        let more = if files > names_shown(files) {
            format!(" and {} more", files - names_shown(files))
        } else {
            String::new()
        };
        return format!(
            "{what} without a log: it contains {names}{more}; logs are CARMEN logs and bags of ROS 2 (MCAP, SQLite)"
        );
    };
    match content {
        Content::Ros1 => format!(
            "{what} with a bag of ROS 1, `{name}`: unpack it (`{command}`), and convert the bag with {}",
            converter(&name)
        ),
        Content::Ros2 => match name.rsplit_once('/') {
            Some((folder, _)) => {
                format!(
                    "{what} with a bag of ROS 2, `{name}`: unpack it (`{command}`), and give the folder `{folder}`"
                )
            }
            None => {
                format!("{what} with a bag of ROS 2: unpack it (`{command}`), and give the file `{name}`")
            }
        },
        _ => format!("{what} with a CARMEN log: unpack it (`{command}`), and give the file `{name}`"),
    }
}

fn names_shown(files: usize) -> usize {
    files.min(entries::NAMED)
}

#[cfg(test)]
mod tests;

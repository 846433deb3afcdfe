//! Recordings on disks that are missing, small or large.

use super::*;
use std::io::{self, Write};
use std::sync::{Arc, Mutex};

/// A disk with room for a number of bytes.
#[derive(Clone)]
struct SmallDisk(Arc<Mutex<usize>>);

impl Write for SmallDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut room = self.0.lock().unwrap();
        *room = room.checked_sub(bytes.len()).ok_or(io::ErrorKind::StorageFull)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_is_reported_once() {
    let mut run = FakeRun::new();
    run.step();
    let mut record = |room: usize| {
        let mut recorder = Recorder::new(None, &[], run.scene.clone()).unwrap();
        let disk = SmallDisk(Arc::new(room.into()));
        let file = file::RrdFile::with_output(Path::new("run.rrd"), Box::new(disk.clone())).unwrap();
        recorder.sinks = Sinks::of_file(file);
        recorder.stream.set_sink(Box::new(recorder.sinks.clone()));
        run.with_view(|view| recorder.log(view, false)).unwrap();
        let early = recorder.flush(); // the SDK writes in its own time
        recorder.stream.flush_blocking().unwrap();
        let late = recorder.flush();
        assert!(early.is_ok() || late.is_ok(), "the error is reported twice");
        let meanwhile = early.and(late).map_err(|error| error.to_string());
        let end = run.with_view(|view| recorder.log(view, true)).map_err(|error| error.to_string());
        (meanwhile, end, *disk.0.lock().unwrap())
    };
    let full = Err("cannot write the recording run.rrd: no storage space".to_owned());
    let (meanwhile, end, _) = record(20_000);
    assert_eq!((meanwhile, end), (full.clone(), Ok(())));

    const AMPLE: usize = 10_000_000;
    let (meanwhile, end, left) = record(AMPLE);
    assert_eq!((meanwhile, end), (Ok(()), Ok(())));

    // Room for all but the end, which is more than a thousand bytes long.
    let (meanwhile, end, _) = record(AMPLE - left - 1000);
    assert_eq!((meanwhile, end), (Ok(()), full));
}

#[test]
fn a_long_recording_has_no_footer() {
    let (stream, memory) = rerun::RecordingStreamBuilder::new(APPLICATION).memory().unwrap();
    stream.log("/log", &rerun::TextLog::new("a line")).unwrap();
    stream.flush_blocking().unwrap();
    let messages = memory.take();
    let footer_bytes = |count: usize| {
        let disk = SmallDisk(Arc::new(usize::MAX.into()));
        let mut file = file::RrdFile::with_output(Path::new("run.rrd"), Box::new(disk.clone())).unwrap();
        messages.iter().cycle().take(count).for_each(|message| file.send(message));
        let before = *disk.0.lock().unwrap();
        file.finish();
        file.check().unwrap();
        before - *disk.0.lock().unwrap()
    };
    assert!(footer_bytes(messages.len()) > 1000);
    assert_eq!(footer_bytes(5000), 0);
}

fn main() {
    let _ = rerun::RecordingStreamBuilder::new("x").save("/tmp/x.rrd");
}

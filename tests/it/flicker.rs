//! The map of `naive` shows what `steady` removes: walls that flicker.

use crate::run::Run;

#[test]
fn walls_flicker_in_the_naive_map_alone() {
    let false_events = |occupancy: &str| {
        let run = Run::quiet(&format!("--duration 5m --seed 3 --drive tour --occupancy {occupancy}"));
        let summary = run.summary();
        assert_eq!(summary.text("/occupancy"), occupancy);
        summary.number("/false_change_events")
    };
    assert_eq!(false_events("steady"), 0.0);
    let naive = false_events("naive");
    assert!(naive > 100.0, "only {naive} false changes");
}

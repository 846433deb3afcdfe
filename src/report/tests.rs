//! From trials to files.

use super::synthetic::{experiment, picture};
use super::*;

#[test]
#[ignore = "draws figures to look at"]
fn look() {
    let folder = std::path::Path::new("/tmp/report_look");
    for (name, worlds, estimators, strategies, seeds) in [
        ("one", 1, vec!["two-state"], vec!["curious", "recency", "poisson", "random", "coin"], 5),
        (
            "all",
            3,
            vec!["two-state"],
            vec![
                "curious",
                "recency",
                "poisson",
                "random",
                "coin",
                "information-gain",
                "revisit",
                "frontier",
                "oracle",
            ],
            20,
        ),
        ("many", 24, vec!["paper"], vec!["curious", "recency", "poisson", "information-gain"], 10),
        ("single", 1, vec!["paper"], vec!["curious", "recency"], 1),
    ] {
        let (settings, trials) = experiment(worlds, &estimators, &strategies, seeds);
        let start = std::time::Instant::now();
        let report = Report::new(settings, trials);
        let made = start.elapsed();
        let pictures: Vec<_> = (0..worlds).map(picture).collect();
        let start = std::time::Instant::now();
        let files = report.write(&folder.join(name), &pictures).unwrap();
        println!("{name}: statistics in {made:?}, {} files in {:?}", files.len(), start.elapsed());
        println!("{}", report.table());
        for run in report.runs() {
            if let Some(claim) = report.claim(&run.world, &run.estimator) {
                println!("{}", claim.markdown_row());
            }
        }
    }
}

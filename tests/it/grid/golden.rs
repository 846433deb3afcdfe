//! The same worlds, strategies and estimators give the same results on every machine, bit for bit. This test
//! detects every change of the results, whether intended or not.

use super::{ran, results};

#[test]
fn what_is_learned_in_the_shipped_worlds() {
    let shipped = curious::worlds::SHIPPED_GRID.map(|(name, _)| format!("--world {name}")).join(" ");
    let run = ran(&format!(
        "{shipped} --steps 3000 --trials 1 --estimator paper --strategy recency --strategy curious"
    ));
    let line = |result: super::Result| {
        let hash = &result.hashes[0].1;
        format!("{:<20} {:<8} {hash}", result.world, result.strategy)
    };
    let lines: Vec<String> = results(&run).into_iter().map(line).collect();
    insta::assert_snapshot!(lines.join("\n"), @"
    two blocks           curious  9b0cfd6508c99f6076dc81ba43ee0602
    two blocks           recency  c4c8718e3a3d6474aef4d759d6d95c3e
    open hall            curious  becbab6d77cd64b55db90abddb077456
    open hall            recency  62a582d8572b912509fac30706de1a26
    corridor with doors  curious  e27c30e940143f99e5720a217e06f933
    corridor with doors  recency  df92fed8199d265ccc9bea5a33c47c98
    many slow blocks     curious  2a4809e06042bfd260b5b25304c40553
    many slow blocks     recency  6d8c7a41c8338b568750e0b92d5aef59
    one fast block       curious  a452ed8189cb9c0d1292f81724547db9
    one fast block       recency  4f1b4660e9665ff28e6876b648b2460a
    ");
}

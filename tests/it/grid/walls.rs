//! Static cells never change in the map, in any world.

use super::{ran, results};

#[test]
fn no_world_makes_a_false_change() {
    let shipped = curious::worlds::SHIPPED_GRID.map(|(name, _)| format!("--world {name}")).join(" ");
    for chance in ["", "--stochastic"] {
        let run = ran(&format!(
            "{shipped} --generate 10 --steps 3000 --trials 1 --strategy curious --strategy random {chance}"
        ));
        let results = results(&run);
        assert_eq!(results.len(), 15 * 2 * 2);
        for result in results {
            assert_eq!(result.entry["false_change_events"], 0, "{} in {}", result.strategy, result.world);
        }
    }
}

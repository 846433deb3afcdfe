//! What a run reports while it goes on.

use agent::Policy;
use evaluation::physics_trial::{self, PhysicsTrial};
use std::collections::BTreeMap;

/// The example of docs/worlds.md: a box that is there from 20 to 30 s.
#[test]
fn what_appears_and_disappears_is_reported_once() {
    let page = include_str!("../../../docs/worlds.md");
    let text = page.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let spec = worldfile::physics::parse_world_with("room.toml", text, &BTreeMap::new()).unwrap();
    let settings = physics_trial::settings(&spec).unwrap();
    let pilot = settings.pilot(settings.agent(&Policy::default(), 1).unwrap(), 1).unwrap();
    let mut trial = PhysicsTrial::new(&spec, 1, &settings, None, pilot).unwrap();
    let mut found = Vec::new();
    while trial.world.time_s() < 40.0 {
        trial.turn().unwrap();
        let texts = trial.observer.messages.iter().filter(|message| message.text.contains("appeared"));
        found.extend(texts.map(|message| (message.text.clone(), trial.world.time_s().round())));
    }
    assert_eq!(found, [("parcel appeared".to_owned(), 20.0), ("parcel disappeared".to_owned(), 30.0)]);
}

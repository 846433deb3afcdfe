use sim::physics::*;
fn main() {
    for kind in ["rooms", "rooms-day"] {
        for seed in 0..60 {
            let name = format!("{kind}-{seed}");
            let world = WorldSpec::generated(&name).unwrap();
            let text = worldfile::physics::to_toml(world.fleet()).expect(&name);
            if seed < 4 { std::fs::write(format!("/tmp/{name}.toml"), &text).unwrap(); println!("{name} {}", world.description); }
            match worldfile::physics::parse_world(&name, &text) {
                Ok(read) => if read != world { println!("{name} DIFFERS");
                    for (a, b) in read.obstacles.iter().zip(&world.obstacles) { if a != b { println!("{a:?}\n{b:?}"); break; } } },
                Err(error) => println!("{error}"),
            }
        }
    }
}

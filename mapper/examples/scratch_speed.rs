//! scratch
#[path = "../tests/house/mod.rs"]
mod house;
use house::*;
use mapper::*;
use std::time::Instant;
fn main() {
    let beams: usize = std::env::args().nth(1).map_or(360, |a| a.parse().unwrap());
    let turn: f64 = std::env::args().nth(2).map_or(0.0, |a| a.parse().unwrap());
    let mut house = House::new(0.1, turn, if turn > 0.0 { 0.01 } else { 0.0 }, beams, 1);
    let mut rs: Vec<_> = (0..2000)
        .map(|k| {
            let t = k as f64 * 0.1;
            house.reading(t, house.tour(t), &[])
        })
        .collect();
    let mut m = Mapper::new(&MapperSettings::default(), house.frame).unwrap();
    let reference = || {
        let start = Instant::now();
        let mut x = 1.0f64;
        for i in 0..100_000u32 {
            x = (x + f64::from(i)).sqrt();
        }
        std::hint::black_box(x);
        start.elapsed().as_secs_f64() * 1e5
    };
    let (mut ratios, mut all) = (vec![], vec![]);
    for lap in 0..20 {
        for part in rs.chunks(100) {
            let before = reference();
            let start = Instant::now();
            for r in part {
                m.update(r).unwrap();
                std::hint::black_box(m.features());
            }
            let us = start.elapsed().as_secs_f64() * 1e6 / part.len() as f64;
            if lap > 0 {
                all.push(us);
                ratios.push(us / (0.5 * (before + reference())));
            }
        }
        for r in &mut rs {
            r.time_s += 200.0;
        }
    }
    all.sort_by(f64::total_cmp);
    ratios.sort_by(f64::total_cmp);
    println!(
        "ratio {:.3}; {beams} beams turn {turn}: 5 % {:.1} us, median {:.1} us per update",
        ratios[ratios.len() / 2],
        all[all.len() / 20],
        all[all.len() / 2]
    );
}

//! scratch
#[path = "../tests/house/mod.rs"]
mod house;
use geometry::CellState;
use house::*;
use mapper::*;
fn main() {
    for (name, th, turn, noise, beams) in [
        ("T", 0.05, 0.0, 0.0, 360),
        ("K", 0.1, 0.0, 0.0, 360),
        ("R", 0.1, 10.0, 0.01, 360),
        ("R720", 0.1, 10.0, 0.01, 720),
        ("R37", 0.1, 37.0, 0.01, 360),
        ("Rt", 0.05, 10.0, 0.01, 360),
    ] {
        let (mut fp, mut fneg, mut wrong_all) = (0, 0, vec![]);
        for seed in 1..=2 {
            let mut house = House::new(th, turn, noise, beams, seed);
            let mut mapper = Mapper::new(&MapperSettings::default(), house.frame).unwrap();
            for k in 0..1500 {
                let t = k as f64 * 0.1;
                let r = house.reading(t, house.tour(t), &[]);
                mapper.update(&r).unwrap();
            }
            for i in 0..house.frame.len() {
                let t = house.truth(i, 0.0);
                let s = mapper.states().cells()[i];
                if s == CellState::Blocked && t == CellState::Free {
                    fp += 1;
                    if wrong_all.len() < 12 {
                        wrong_all.push(house.frame.center(house.frame.cell(i)));
                    }
                }
                if s == CellState::Free && t == CellState::Blocked {
                    fneg += 1;
                }
            }
        }
        println!(
            "{name}: blocked but free {fp}, free but blocked {fneg}; {:?}",
            wrong_all.iter().map(|p| format!("{:.3},{:.3}", p.x, p.y)).collect::<Vec<_>>()
        );
    }
}

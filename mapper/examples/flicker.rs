//! scratch
#[path = "../tests/house/mod.rs"]
mod house;
use geometry::CellState;
use house::*;
use mapper::*;
use nalgebra::Point2;
use std::time::Instant;

fn run(name: &str, thickness: f64, turn: f64, noise: f64, beams: usize, settings: &MapperSettings) {
    let mut house = House::new(thickness, turn, noise, beams, 1);
    let readings: Vec<_> = (0..6000)
        .map(|k| {
            let t = k as f64 * 0.1;
            house.reading(t, house.tour(t), &[])
        })
        .collect();
    let mut mapper = Mapper::new(settings, house.frame).unwrap();
    let start = Instant::now();
    let mut flips = 0;
    let mut per = vec![0u32; house.frame.len()];
    let mut late = [0; 6];
    for r in &readings {
        mapper.update(r).unwrap();
        for t in mapper.transitions() {
            if t.event().is_some() {
                flips += 1;
                per[house.frame.index(t.cell).unwrap()] += 1;
                late[(r.time_s / 100.0) as usize] += 1;
            }
        }
    }
    let el = start.elapsed().as_secs_f64();
    let cells = per.iter().filter(|&&n| n > 0).count();
    let maxn = per.iter().max().unwrap();
    let free = mapper.states().cells().iter().filter(|&&s| s == CellState::Free).count();
    let blocked = mapper.states().cells().iter().filter(|&&s| s == CellState::Blocked).count();
    if std::env::args().len() > 1 {
        let m = Point2::new(6.0, 6.0);
        let mut v: Vec<_> = (0..per.len()).filter(|&i| per[i] > 0).collect();
        v.sort_by_key(|&i| std::cmp::Reverse(per[i]));
        for &i in v.iter().take(9) {
            let p = house.frame.center(house.frame.cell(i));
            let q = m + geometry::rotation(-house.turn_rad) * (p - m);
            println!("   {:.3} {:.3} flips {} {:?}", q.x, q.y, per[i], mapper.statistics(i));
        }
    }
    println!(
        "{name:28} flips {flips:6} in {cells} cells, max {maxn}, by 100 s {late:?}; {:.0} scans/s; free {free} blocked {blocked}",
        6000.0 / el
    );
}
fn main() {
    let steady = MapperSettings::default();
    let _naive = MapperSettings { occupancy: OccupancyModel::Naive, ..Default::default() };
    for (n, s) in [("steady", &steady)] {
        if std::env::var("ONLY").is_ok() {
            for _ in 0..3 {
                run(&format!("R {n}"), 0.1, 10.0, 0.01, 360, s);
            }
            return;
        }
        run(&format!("T {n}"), 0.05, 0.0, 0.0, 360, s);
        run(&format!("K {n}"), 0.1, 0.0, 0.0, 360, s);
        run(&format!("R {n}"), 0.1, 10.0, 0.01, 360, s);
        run(&format!("R720 {n}"), 0.1, 10.0, 0.01, 720, s);
        run(
            &format!("R 3cm {n}"),
            0.1,
            10.0,
            0.03,
            360,
            &MapperSettings {
                steady: SteadySettings { range_noise_std_m: 0.03, ..s.steady.clone() },
                ..s.clone()
            },
        );
        run(&format!("R 37deg {n}"), 0.1, 37.0, 0.01, 360, s);
        run(&format!("R thin {n}"), 0.05, 10.0, 0.01, 360, s);
    }
    // a box that goes, in the open and beside the wall
    for (turn, noise) in [(0.0, 0.0), (10.0, 0.01)] {
        let mut house = House::new(0.1, turn, noise, 360, 2);
        house.add(Thing { corners: rectangle(1.5, 3.0, 1.9, 3.4), from_s: -1.0, until_s: 30.0 });
        house.add(Thing { corners: rectangle(0.1, 1.0, 0.5, 1.4), from_s: -1.0, until_s: 30.0 });
        house.add(Thing { corners: rectangle(4.0, 3.0, 4.4, 3.4), from_s: 30.0, until_s: 1e9 });
        let mut mapper = Mapper::new(&steady, house.frame).unwrap();
        let inside = |p: &Point2<f64>, c: (f64, f64, f64, f64), h: &House| {
            let m = Point2::new(6.0, 6.0);
            let q = m + geometry::rotation(-h.turn_rad) * (p - m);
            q.x > c.0 - 0.03 && q.x < c.2 + 0.03 && q.y > c.1 - 0.03 && q.y < c.3 + 0.03
        };
        let boxes = [(1.5, 3.0, 1.9, 3.4), (0.1, 1.0, 0.5, 1.4), (4.0, 3.0, 4.4, 3.4)];
        for k in 0..500 {
            let t = k as f64 * 0.1;
            let a = t * 0.1;
            let p = house.turned(Point2::new(3.0 + 0.8 * a.cos(), 2.0 + 0.8 * a.sin()));
            let r = house.reading(t, geometry::pose(p.x, p.y, a), &[]);
            mapper.update(&r).unwrap();
            if k >= 296 && k <= 340 && k % 6 == 2 || k == 499 {
                let n: Vec<usize> = boxes
                    .iter()
                    .map(|&b| {
                        (0..house.frame.len())
                            .filter(|&i| {
                                mapper.states().cells()[i] == CellState::Blocked
                                    && inside(&house.frame.center(house.frame.cell(i)), b, &house)
                            })
                            .count()
                    })
                    .collect();
                println!("t {t:.1} blocked cells in boxes {n:?}");
            }
        }
    }
}

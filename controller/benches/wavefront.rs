//! How long planning takes on a house of 12×12 m in cells of 0.05 m.
use controller::*;
use geometry::{Cell, GridFrame};
use nalgebra::Point2;
fn main() {
    divan::main()
}
fn house() -> Costmap {
    let frame = GridFrame::new(Point2::origin(), 0.05, 240, 240).unwrap();
    let mut map = Costmap::closed(frame);
    for y in 0..240 {
        for x in 0..240 {
            let gap = |v: i32| {
                let m = v % 120;
                m.min(119 - m)
            };
            let door = |v: i32| {
                let m = v % 120;
                (m - 60).abs()
            };
            let (gx, gy) = (gap(x), gap(y));
            let mut price = if gx < 6 || gy < 6 {
                0
            } else if gx < 10 || gy < 10 {
                3
            } else {
                1
            };
            let inner_x = (x - 120).abs() < 20;
            let inner_y = (y - 120).abs() < 20;
            if inner_x {
                let d = door(y);
                if d <= 1 {
                    price = 1
                } else if d <= 4 {
                    price = 3
                }
            }
            if inner_y {
                let d = door(x);
                if d <= 1 {
                    price = 1
                } else if d <= 4 {
                    price = 3
                }
            }
            map.set_price(Cell::new(x, y), price);
        }
    }
    map
}
#[divan::bench]
fn full_field(bencher: divan::Bencher) {
    let map = house();
    let mut wave = Wavefront::new(*map.frame(), Moves::Eight);
    bencher.bench_local(|| {
        wave.clear();
        wave.spread(&map, Cell::new(40, 40), None);
        wave.cost(Cell::new(200, 200))
    });
}

//! scratch
#[path = "../tests/house/mod.rs"]
mod house;
use house::*;
use mapper::*;
fn main() {
    let base = || SteadySettings::default();
    let sets: Vec<(&str, SteadySettings)> = vec![
        ("free 10", SteadySettings{..base()}),
        ("free 8", SteadySettings{misses_to_free:8,..base()}),
        ("free 6", SteadySettings{misses_to_free:6,..base()}),
        ("free 5", SteadySettings{misses_to_free:5,..base()}),
        ("free 6 stand 10", SteadySettings{misses_to_free:6,hits_to_stand:10,..base()}),
    ];
    for (name, noise, beams, seeds) in [("R",0.01,360,1..=4),("R720",0.01,720,1..=2),("3cm",0.03,360,1..=2)] {
        let data: Vec<_> = seeds.map(|seed| { let mut house = House::new(0.1, 10.0, noise, beams, seed);
            let r: Vec<_> = (0..6000).map(|k| { let t = k as f64*0.1; house.reading(t, house.tour(t), &[]) }).collect(); (house, r)}).collect();
        for (what, s) in &sets { let s = &SteadySettings{range_noise_std_m: s.range_noise_std_m*noise/0.01, ..s.clone()};
            let mut out = vec![];
            for (house, rs) in &data {
                let mut m = Mapper::new(&MapperSettings{steady:s.clone(),..Default::default()}, house.frame).unwrap();
                let (mut b, mut f) = (0,0);
                for r in rs { m.update(r).unwrap(); for t in m.transitions() { match t.event() { Some(geometry::Event::Block)=>b+=1, Some(_)=>f+=1, _=>{} } } }
                out.push((b,f));
            }
            println!("{name} {what}: block/free {out:?}");
        }
    }
}

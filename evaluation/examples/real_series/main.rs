//! Predictions of recorded doors and rooms.

mod models;
mod series;

use mapper::{Calendar, Look};
use models::Model;
use rayon::prelude::*;
use series::{LOOKS, Looks, STEP_S, Series};
use std::collections::BTreeMap;

const HORIZONS: [(&str, usize); 6] =
    [("1 min", 1), ("10 min", 10), ("30 min", 30), ("60 min", 60), ("24 h", 1440), ("7 d", 10080)];
const MIN_PROBABILITY: f64 = 0.001;

/// The scores of one model at one horizon.
#[derive(Clone, Copy, Default)]
struct Score {
    brier: f64,
    log: f64,
    n: usize,
}

fn scores(series: &Series, looks: Looks, seed: u64, history_s: f64, model: &mut dyn Model) -> Vec<Score> {
    let seen = looks.draw(series.states.len(), seed);
    let split = ((series.split_s - series.start_s) / STEP_S) as usize;
    let first = split.saturating_sub((history_s / STEP_S) as usize);
    let history: Vec<Look> = (first..split).filter(|step| seen[*step]).filter_map(|step| series.look(step)).collect();
    model.learn(&history);
    let mut scores = vec![Score::default(); HORIZONS.len()];
    for step in split..series.states.len() {
        if let Some(look) = series.look(step).filter(|_| seen[step]) {
            model.look(look);
        }
        for (score, (_, ahead)) in scores.iter_mut().zip(HORIZONS) {
            let Some(found) = series.look(step + ahead) else { continue };
            let predicted = model.predict(found.time_s).clamp(MIN_PROBABILITY, 1.0 - MIN_PROBABILITY);
            let found = f64::from(u8::from(found.is_blocked));
            score.brier += (predicted - found) * (predicted - found);
            score.log -= if found > 0.5 { predicted.ln() } else { (1.0 - predicted).ln() };
            score.n += 1;
        }
    }
    scores
}

fn main() {
    let mut files: Vec<String> = std::env::args().skip(1).collect();
    let days: f64 = std::env::var("DAYS").ok().and_then(|d| d.parse().ok()).unwrap_or(1e6);
    files.sort();
    let all: Vec<Series> = files.iter().map(|file| Series::read(file.as_ref()).unwrap()).collect();
    let calendar = Calendar::UTC;
    let names: Vec<(String, bool)> = models::all(&calendar).into_iter().map(|(n, b, _)| (n, b)).collect();
    let quick = std::env::var("QUICK").is_ok();
    let seeds: u64 = if days > 1e5 {3} else {2};
    let jobs: Vec<(usize, usize, u64)> = (0..all.len()).flat_map(|s| (0..LOOKS.len()).flat_map(move |l| (0..if l == 0 {1} else {seeds}).map(move |k| (s, l, k)))).collect();
    let results: Vec<Vec<Vec<Score>>> = jobs
        .par_iter()
        .map(|&(s, l, k)| {
            models::all(&calendar)
                .into_iter()
                .take(if quick { 1 } else { usize::MAX })
                .map(|(_, _, mut model)| scores(&all[s], LOOKS[l].1, k, days * 86400.0, model.as_mut()))
                .collect()
        })
        .collect();
    // set, looks, horizon -> model -> mean brier
    let mut cases: BTreeMap<(String, usize, usize), Vec<(f64, usize)>> = BTreeMap::new();
    for (&(s, l, _), by_model) in jobs.iter().zip(&results) {
        for (m, scores) in by_model.iter().enumerate() {
            for (h, score) in scores.iter().enumerate() {
                if score.n == 0 { continue; }
                if std::env::var("W").is_ok() && l == 0 && h >= 3 { println!("{:28} h{h} model {m:2} {:.4}", all[s].name, score.brier / score.n as f64); }
                let case = cases.entry((all[s].set().to_owned(), l, h)).or_insert_with(|| vec![(0.0, 0); names.len()]);
                case[m].0 += score.brier / score.n as f64;
                case[m].1 += 1;
            }
        }
    }
    let path = format!("/work/w/real_base_{days}.txt");
    let base: BTreeMap<String, Vec<f64>> = if quick {
        std::fs::read_to_string(&path).unwrap().lines().map(|l| { let mut w = l.split('|'); let k = w.next().unwrap().to_owned(); (k, w.map(|x| x.parse().unwrap()).collect()) }).collect()
    } else { BTreeMap::new() };
    let mut out = String::new();
    let mut logs = vec![0.0; names.len()];
    let (mut within2, mut chain2) = (0, 0);
    let mut by_set: BTreeMap<String, (f64, f64, usize)> = BTreeMap::new();
    let mut by_h: BTreeMap<String, (f64, f64, usize)> = BTreeMap::new();
    for ((set, l, h), values) in &cases {
        let key = format!("{set}/{l}/{h}");
        let mut briers: Vec<f64> = values.iter().map(|(sum, n)| sum / (*n).max(1) as f64).collect();
        if quick { let own = briers[0]; briers = base[&key].clone(); briers[0] = own; }
        else { out += &format!("{key}|{}\n", briers.iter().map(|b| b.to_string()).collect::<Vec<_>>().join("|")); }
        let (best, _) = names.iter().zip(&briers).filter(|((_, b), _)| *b).map(|((n, _), b)| (*b, n)).fold((f64::INFINITY, &names[0].0), |a, b| if b.0 < a.0 { b } else { a });
        for (log, b) in logs.iter_mut().zip(&briers) { *log += (b / best).ln(); }
        if briers[0] <= 1.02 * best { within2 += 1; }
        if briers[0] <= 1.02 * briers[3] { chain2 += 1; }
        for (map, key) in [(&mut by_set, set.clone()), (&mut by_h, format!("{} {}", LOOKS[*l].0, HORIZONS[*h].0))] {
            let e = map.entry(key).or_default();
            e.0 += (briers[0] / best).ln(); e.1 += (briers[3] / best).ln(); e.2 += 1;
        }
        if std::env::var("V").is_ok() || set == "tom" && (*l == 0 || *l == 2) {
            println!("{set:8} {:7} {:7} clock {:.4} last {:.4} chain {:.4} best {:.4} {}", LOOKS[*l].0, HORIZONS[*h].0, briers[0], briers[2], briers[3], best,
                names.iter().zip(&briers).filter(|((_, b), x)| *b && **x == best).map(|((n, _), _)| n.as_str()).collect::<String>());
        }
    }
    if !quick { std::fs::write(&path, out).unwrap(); }
    for (map, name) in [(&by_set, "set"), (&by_h, "case")] {
        println!("-- {name}: clock, chain ÷ best");
        for (k, (a, b, n)) in map { println!("{k:16} {:.3} {:.3}", (a / *n as f64).exp(), (b / *n as f64).exp()); }
    }
    let n = cases.len() as f64;
    for ((name, _), log) in names.iter().zip(&logs) { println!("{name:24} {:.4}", (log / n).exp()); }
    println!("cases {n} within 2 % of best {:.3}; at most 2 % worse than chain {:.3}", within2 as f64 / n, chain2 as f64 / n);
}

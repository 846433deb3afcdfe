//! Block worlds: things that stand for a fixed time and move on, seen by a robot that moves.

use crate::robots::{Habit, Robot};
use crate::score::{Mean, log_error};
use geometry::World;
use mapper::{Estimator, Mapper, MapperSettings};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use sim::grid::{GenerateSettings, GridSpec, GridTruth, GridWorld};

/// Cells in view for less than this share of the time count as sparse.
const SPARSE: f64 = 0.1;

/// What one estimator reached in one world.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BlockScore {
    /// Averaged per thing, then over things.
    pub(crate) log_error: f64,
    pub(crate) relative_error: f64,
    pub(crate) bias: f64,
    pub(crate) sparse: Mean,
    pub(crate) dense: Mean,
    pub(crate) false_rate: f64,
    pub(crate) brier: f64,
}

fn score(mapper: &Mapper, truth: &GridTruth, brier: &Mean) -> BlockScore {
    let mut things = Mean::default();
    let [mut relative, mut bias, mut sparse, mut dense, mut still] = [Mean::default(); 5];
    for thing in truth.things() {
        let mut cells = Mean::default();
        for &index in thing {
            let (rate, true_rate) = (mapper.rate(index), truth.cycle_rate(index));
            if true_rate == 0.0 {
                continue;
            }
            let error = log_error(rate, true_rate);
            cells.add(error);
            relative.add((rate / true_rate - 1.0).abs());
            bias.add(rate / true_rate - 1.0);
            let share = mapper.statistics(index).observed() / truth.time();
            if share < SPARSE { sparse.add(error) } else { dense.add(error) }
        }
        things.add_mean(&cells);
    }
    for index in 0..mapper.frame().len() {
        if !truth.is_swept(index) && mapper.was_ever_seen(index) {
            still.add(mapper.rate(index));
        }
    }
    BlockScore {
        log_error: things.mean(),
        relative_error: relative.mean(),
        bias: bias.mean(),
        sparse,
        dense,
        false_rate: still.mean(),
        brier: brier.mean(),
    }
}

/// Lets a robot live in a world, and every estimator learn from what it sees.
pub(crate) fn live(spec: &GridSpec, habit: Habit, steps: u64, seed: u64) -> anyhow::Result<Vec<BlockScore>> {
    let mut world = GridWorld::new(spec, seed);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(1);
    let mut robot = Robot::new(spec, habit, rng);
    let mut mappers = Estimator::ALL
        .map(|estimator| {
            Mapper::new(&MapperSettings { estimator, ..MapperSettings::default() }, *spec.frame())
        })
        .into_iter()
        .collect::<Result<Vec<_>, _>>()?;
    let mut visits: Vec<Vec<String>> = vec![Vec::new(); spec.frame().len()];
    let mut last: Vec<(i64, bool)> = vec![(-10, false); spec.frame().len()];
    let mut history: Vec<(Vec<(usize, bool)>, geometry::Cell)> = Vec::new();
    let mut briers = vec![Mean::default(); mappers.len()];
    for step in 0..=steps {
        let reading = world.sense();
        let mut turned: Vec<(usize, bool)> = Vec::new();
        for &(cell, b) in &reading.cells {
            let i = spec.frame().index(cell).unwrap();
            if last[i].0 >= 0 && last[i].1 != b {
                turned.push((i, b));
            }
        }
        history.push((turned.clone(), world.robot()));
        let between = |k: usize, i: usize, robot: geometry::Cell| {
            let f = spec.frame();
            let (k, c) = (f.cell(k), f.cell(i));
            let (vx, vy) = (f64::from(c.x - robot.x), f64::from(c.y - robot.y));
            let (kx, ky) = (f64::from(k.x - robot.x), f64::from(k.y - robot.y));
            let l2 = vx * vx + vy * vy;
            let t = (kx * vx + ky * vy) / l2;
            let off = (kx * vy - ky * vx).abs() / l2.sqrt();
            t > 0.0 && t < 1.0 && off <= 0.75
        };
        for &(cell, b) in &reading.cells {
            let i = spec.frame().index(cell).unwrap();
            if !world.truth().is_swept(i) {
                last[i] = (step as i64, b);
                continue;
            }
            if last[i].0 + 1 == step as i64 {
                if last[i].1 != b {
                    let v = visits[i].last_mut().unwrap();
                    v.push_str(&format!(" {step}"));
                }
            } else {
                let l = last[i].0;
                let fled = l >= 0 && {
                    let (t, r) = &history[l as usize + 1];
                    t.iter().any(|&(k, b)| b && between(k, i, *r))
                };
                let came = {
                    let (t, _) = &history[step as usize];
                    let r = if step > 0 { history[step as usize - 1].1 } else { world.robot() };
                    t.iter().any(|&(k, b)| !b && (between(k, i, world.robot()) || between(k, i, r)))
                };
                if let Some(v) = visits[i].last_mut() {
                    v.push_str(&format!(" {l} {}", u8::from(fled)));
                }
                visits[i].push(format!("{} {} {step}", u8::from(came), u8::from(b)));
            }
            last[i] = (step as i64, b);
        }
        for mapper in &mut mappers {
            mapper.update(&reading)?;
        }
        if step % 97 == 0 && step > steps / 2 {
            for (mapper, brier) in mappers.iter().zip(&mut briers) {
                for &index in world.truth().swept() {
                    if !mapper.is_in_view(index) {
                        let truth = f64::from(u8::from(world.truth().is_blocked(index)));
                        brier.add((mapper.blocked_probability(index) - truth).powi(2));
                    }
                }
            }
        }
        if step < steps {
            world.act(&robot.act(&reading));
        }
    }
    if std::env::var("DUMP").is_ok() {
        for (thing, cells) in world.truth().things().iter().enumerate() {
            let block = &spec.blocks()[thing];
            for &index in cells {
                let seen = mappers[5].statistics(index);
                let rates: Vec<String> = mappers.iter().map(|m| m.rate(index).to_string()).collect();
                println!(
                    "V;{};{};{thing};{index};{};{};{};{};{} {} 0",
                    habit.name(),
                    seed,
                    block.dwell,
                    cells.len(),
                    world.truth().cycle_rate(index),
                    mappers[0].rate(index),
                    visits[index].join("/"),
                    last[index].0
                );
                println!(
                    "{},{},{thing},{},{:?},{},{index},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
                    habit.name(),
                    seed,
                    block.dwell,
                    block.course,
                    cells.len(),
                    world.truth().cycle_rate(index),
                    world.truth().blocked_time(index) / world.truth().time(),
                    seen.watched_free,
                    seen.watched_blocked,
                    seen.block_events,
                    seen.free_events,
                    seen.block_events_after_gap,
                    seen.free_events_after_gap,
                    seen.gaps_from_free,
                    seen.gaps_from_blocked,
                    seen.unobserved,
                    seen.gap_worth.watched_free,
                    seen.gap_worth.watched_blocked,
                    seen.gap_worth.block_events,
                    seen.gap_worth.free_events,
                    seen.first_seen,
                    seen.last_seen,
                    rates.join(",")
                );
            }
        }
    }
    Ok(mappers.iter().zip(&briers).map(|(mapper, brier)| score(mapper, world.truth(), brier)).collect())
}

pub(crate) fn table(worlds: u64, steps: u64) -> anyhow::Result<()> {
    for habit in Habit::ALL {
        let mut sums = vec![[Mean::default(); 7]; Estimator::ALL.len()];
        for seed in 0..worlds {
            let spec = GridSpec::generate(&GenerateSettings::default(), seed);
            for (sum, score) in sums.iter_mut().zip(live(&spec, habit, steps, seed)?) {
                sum[0].add(score.log_error);
                sum[1].add(score.relative_error);
                sum[2].add(score.bias);
                sum[3].add_all(&score.dense);
                sum[4].add_all(&score.sparse);
                sum[5].add(score.false_rate);
                sum[6].add(score.brier);
            }
        }
        for (estimator, sum) in Estimator::ALL.iter().zip(&sums) {
            print!("| {} | {steps} | {} |", habit.name(), estimator.name());
            for mean in sum {
                print!(" {:.3} |", mean.mean());
            }
            println!();
        }
    }
    Ok(())
}

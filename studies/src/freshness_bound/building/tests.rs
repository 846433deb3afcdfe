use super::*;
use crate::calendar::{Habit, Stays};
use crate::freshness_bound::{LookLimits, freshness_bound};
use crate::{Belief, Kind, Model, Patrol, Plan, Room, STEP_S, Thing, ThingKind, Viewpoint};
use evaluation::metrics::Freshness;

const FINE: BoundSettings =
    BoundSettings { cell_steps: [1, 1], fineness: 16, longest_steps: usize::MAX, again: 1.0 };

fn building(
    habits: Vec<Habit>,
    viewpoints: Vec<Viewpoint>,
    rooms: Vec<Room>,
    steps: Vec<Vec<usize>>,
) -> Building {
    let thing = |habit| Thing { kind: ThingKind::Box, habit };
    Building { things: habits.into_iter().map(thing).collect(), rooms, viewpoints, dock: 0, steps }
}

fn in_hall(sees: &[usize]) -> Viewpoint {
    Viewpoint { room: None, sees: sees.to_vec() }
}

fn mixed(free_s: [f64; 2], blocked_s: [f64; 2]) -> Habit {
    let stays = [free_s, blocked_s].map(|[short_s, long_s]| Stays { short_s, long_s, long_share: 0.4 });
    Habit { active: stays, quiet: stays, ..Habit::chain(1.0, 1.0) }
}

/// The optimum by trying all choices: the smallest expected sum of variances over the steps that are left.
fn optimum(building: &Building, models: &[Model], beliefs: &[Belief], at: usize, left: usize) -> f64 {
    let variance = |beliefs: &[Belief]| {
        beliefs.iter().map(|belief| belief.probability()).map(|p| p * (1.0 - p)).sum::<f64>()
    };
    let advanced = |beliefs: &[Belief]| -> Vec<Belief> {
        let mut beliefs = beliefs.to_vec();
        beliefs.iter_mut().zip(models).for_each(|(belief, model)| belief.advance(model, 0));
        beliefs
    };
    let mut stay = 0.0;
    let mut later = beliefs.to_vec();
    for _ in 0..left {
        stay += variance(&later);
        later = advanced(&later);
    }
    let go = |to: usize| {
        let mut later = beliefs.to_vec();
        let mut sum = 0.0;
        for passed in 0..building.steps[at][to] {
            if passed == left {
                return sum;
            }
            sum += variance(&later);
            later = advanced(&later);
        }
        let left = left - building.steps[at][to];
        let sees = &building.viewpoints[to].sees;
        let outcomes = (0..1_usize << sees.len()).map(|outcome| {
            let (mut seen, mut probability) = (later.clone(), 1.0);
            for (bit, thing) in sees.iter().enumerate() {
                let is_blocked = outcome >> bit & 1 == 1;
                let p = seen[*thing].probability();
                probability *= if is_blocked { p } else { 1.0 - p };
                seen[*thing].look(is_blocked);
            }
            if left == 0 { 0.0 } else { probability * optimum(building, models, &seen, to, left) }
        });
        sum + outcomes.sum::<f64>()
    };
    (0..building.viewpoints.len()).map(go).fold(stay, f64::min)
}

#[test]
fn the_bound_is_at_most_the_optimum_and_near() {
    for (steps, travel) in [(7, 1), (9, 2)] {
        let habits = vec![mixed([30.0, 300.0], [40.0, 200.0]), mixed([20.0, 400.0], [60.0, 100.0])];
        let travel = vec![vec![1, travel], vec![travel, 1]];
        let building = building(habits, vec![in_hall(&[0]), in_hall(&[1])], Vec::new(), travel);
        let models: Vec<Model> = building.things.iter().map(|thing| Model::of(&thing.habit)).collect();
        let beliefs: Vec<Belief> = models.iter().map(Belief::new).collect();
        let best = optimum(&building, &models, &beliefs, 0, steps) / (2 * steps) as f64;
        // All prices give bounds: also other ones than those that are found.
        let mut of = BuildingBound::new(&building, Duty::ALWAYS, steps, FINE);
        let found = of.brier(1);
        let price = |at: usize| 0.02 * 1.4_f64.powi(at as i32);
        let pairs = (0..14).flat_map(|one| (0..14).map(move |two| [one, two].map(price)));
        let others = pairs.map(|prices| {
            of.prices = prices.map(|price| [price; 2]).to_vec();
            of.brier(1)
        });
        let highest = others.fold(found, f64::max);
        println!("{best:.5}: {:.4}, found {:.4}", highest / best, found / best);
        assert!(highest <= best && found > 0.3 * best, "{highest} {found} {best}");
    }
}

/// Two-state things without travel, one look per step: the bound over probabilities has no time cells.
#[test]
fn it_is_near_the_bound_without_travel() {
    let minutes = [[4.0, 3.0], [10.0, 25.0], [30.0, 15.0], [60.0, 90.0], [15.0, 15.0], [90.0, 20.0]];
    let habits: Vec<Habit> =
        minutes.iter().map(|stays| Habit::chain(60.0 * stays[0], 60.0 * stays[1])).collect();
    let steps = 720;
    let other = freshness_bound(&habits, &LookLimits::per_step(vec![0; steps], 1.0)).unwrap();
    let viewpoints = (0..habits.len()).map(|thing| in_hall(&[thing])).collect();
    let travel = vec![vec![1; habits.len()]; habits.len()];
    let building = building(habits, viewpoints, Vec::new(), travel);
    let bound = BuildingBound::new(&building, Duty::ALWAYS, steps, FINE).brier(1);
    println!("{bound:.5}, {:.3} of the bound without travel", bound / other);
    assert!(bound < 1.001 * other && bound > 0.8 * other, "{bound} {other}");
}

const SEEDS: u64 = 100;

/// The mean over the seeds of the difference between score and bound, and its standard error.
fn margins(plans: &[Plan], building: &Building, duty: Duty, steps: usize, settings: BoundSettings) {
    let of = BuildingBound::new(building, duty, steps, settings);
    let bounds: Vec<f64> = (0..SEEDS).into_par_iter().map(|seed| of.brier(seed)).collect();
    let mean_bound = bounds.iter().sum::<f64>() / SEEDS as f64;
    assert!(mean_bound > 0.0, "{mean_bound}");
    for plan in plans {
        let margin = |(seed, bound): (usize, &f64)| {
            let mut freshness = Freshness::new(STEP_S);
            let mut strategy = plan.strategy(building, duty);
            Patrol::new(building, duty, seed as u64).run(
                strategy.as_mut(),
                steps,
                |predicted, is_blocked| {
                    freshness.add(predicted, is_blocked);
                },
            );
            freshness.scores().brier - bound
        };
        let margins: Vec<f64> = bounds.par_iter().enumerate().map(margin).collect();
        let mean = margins.iter().sum::<f64>() / SEEDS as f64;
        let error = (margins.iter().map(|margin| (margin - mean).powi(2)).sum::<f64>()
            / (SEEDS * (SEEDS - 1)) as f64)
            .sqrt();
        println!("{plan:?}: {:.3} of the bound, {mean:.5} ± {error:.5}", (mean + mean_bound) / mean_bound);
        assert!(mean + 3.0 * error > 0.0, "{plan:?}: {mean} ± {error}");
    }
}

/// Two rooms behind doors at the ends of a hall.
#[test]
fn no_strategy_is_below_the_bound_in_two_rooms() {
    let door = || mixed([100.0, 1500.0], [100.0, 900.0]);
    let habits =
        vec![door(), door(), mixed([120.0, 1800.0], [90.0, 900.0]), mixed([60.0, 600.0], [80.0, 700.0])];
    let inside = |room: usize| Viewpoint { room: Some(room), sees: vec![room, 2 + room] };
    let viewpoints = vec![in_hall(&[0, 1]), inside(0), inside(1)];
    let rooms = [0, 1].map(|door| Room { door: Some(door), threshold: 0 }).to_vec();
    let travel = vec![vec![1, 3, 4], vec![3, 1, 6], vec![4, 6, 1]];
    let building = building(habits, viewpoints, rooms, travel);
    let plans = [Plan::Never, Plan::Curious(15), Plan::Round(15), Plan::Coverage(15), Plan::Gain];
    let settings = BoundSettings { cell_steps: [2, 2], fineness: 12, longest_steps: 360, again: 0.6 };
    margins(&plans, &building, Duty::ALWAYS, 360, settings);
    margins(&plans, &building, Duty::share(0.1), 360, settings);
}

#[test]
fn no_strategy_is_below_the_bound_in_generated_buildings() {
    let plans = [Plan::Coverage(15), Plan::Gain];
    // Into the first active hours of Monday.
    for (kind, share, hours) in [(Kind::Home, 1.0, 8), (Kind::Office, 0.1, 10)] {
        let building = Building::generate(kind, 100_000);
        let duty = Duty::share(share);
        let settings =
            BoundSettings { cell_steps: [180, 30], fineness: 4, ..BoundSettings::of(&building, duty) };
        margins(&plans, &building, duty, hours * 360, settings);
    }
}

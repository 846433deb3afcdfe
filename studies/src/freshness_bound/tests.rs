use super::*;
use crate::calendar::{Hours, Law, Stays};
use crate::{
    Building, Choice, Duty, Patrol, Plan, Strategy, Thing as PlacedThing, ThingKind, View, Viewpoint,
};
use evaluation::metrics::Freshness;
use interfaces::RandomStream;

const MINUTE_S: f64 = 60.0;

/// Things with a viewpoint each, and one look per step.
fn places(habits: &[Habit]) -> Building {
    let count = habits.len();
    let thing = |habit: &Habit| PlacedThing { kind: ThingKind::Box, habit: habit.clone() };
    Building {
        things: habits.iter().map(thing).collect(),
        rooms: Vec::new(),
        viewpoints: (0..count).map(|thing| Viewpoint { room: None, sees: vec![thing] }).collect(),
        dock: 0,
        steps: vec![vec![1; count]; count],
    }
}

/// The look that a restarting arm is worth most for: the index of a two-state chain whose rates do not change.
struct Index(Vec<[f64; 2]>);

impl Strategy for Index {
    fn choose(&mut self, view: &View<'_>, _: &mut RandomStream) -> Choice {
        let index = |thing: &usize| {
            let [variance, sum_hz] = self.0[*thing];
            let decay = 2.0 * sum_hz * view.age(*thing) as f64 * STEP_S;
            variance * (1.0 - (-decay).exp() * (1.0 + decay)) / (2.0 * sum_hz)
        };
        let things = 0..self.0.len();
        things.max_by(|a, b| index(a).total_cmp(&index(b))).map_or(Choice::Rest(1), Choice::Go)
    }
}

impl Index {
    fn new(habits: &[Habit]) -> Self {
        let rates = habits.iter().map(|habit| {
            let [free, blocked] = habit.active.map(|stays| stays.short_s);
            let share = blocked / (free + blocked);
            [share * (1.0 - share), 1.0 / free + 1.0 / blocked]
        });
        Self(rates.collect())
    }
}

/// Mean and standard error of the Brier score over 100 seeds.
fn brier(building: &Building, steps: usize, strategy: impl Fn() -> Box<dyn Strategy> + Sync) -> [f64; 2] {
    let scores: Vec<f64> = (0..100)
        .into_par_iter()
        .map(|seed| {
            let mut freshness = Freshness::new(STEP_S);
            let mut patrol = Patrol::new(building, Duty::ALWAYS, 200_000 + seed);
            patrol.run(strategy().as_mut(), steps, |predicted, is_blocked| {
                freshness.add(predicted, is_blocked);
            });
            freshness.scores().brier
        })
        .collect();
    let count = scores.len() as f64;
    let mean = scores.iter().sum::<f64>() / count;
    let variance = scores.iter().map(|score| (score - mean).powi(2)).sum::<f64>() / (count - 1.0);
    [mean, (variance / count).sqrt()]
}

/// Mean stays from a minute to six hours.
fn chains() -> Vec<Habit> {
    let minutes = [[1.0, 2.0], [4.0, 3.0], [10.0, 25.0], [30.0, 15.0], [60.0, 90.0], [200.0, 100.0]];
    let more = [[360.0, 300.0], [2.0, 20.0], [15.0, 15.0], [90.0, 20.0]];
    let chain = |[free, blocked]: &[f64; 2]| Habit::chain(free * MINUTE_S, blocked * MINUTE_S);
    minutes.iter().chain(&more).map(chain).collect()
}

#[test]
fn no_strategy_is_below_the_bound_and_the_best_is_near() {
    let (habits, steps) = (chains(), 2880);
    let bound = freshness_bound(&habits, &LookLimits::per_step(vec![0; steps], 1.0)).unwrap();
    let building = places(&habits);
    let plan = |plan: Plan| brier(&building, steps, || plan.strategy(&building, Duty::ALWAYS));
    let index = brier(&building, steps, || Box::new(Index::new(&habits)));
    let all = [plan(Plan::Round(1)), plan(Plan::Gain), index, plan(Plan::Coverage(1)), plan(Plan::Never)];
    for [mean, error] in all {
        println!("{mean:.5} ± {error:.5}, {:.3} of the bound", mean / bound);
        assert!(mean + 3.0 * error > bound, "{mean} ± {error}: bound {bound}");
    }
    let best = all[1][0].min(index[0]);
    assert!(best < 1.05 * bound, "{best}: bound {bound}");
}

/// Four hours, of which things are active in the second half, with a price for quiet hours and one for active ones.
#[test]
fn no_strategy_is_below_the_bound_with_a_calendar() {
    let hours = Hours::daily(&[0, 1, 2, 3, 4], 2.0, 18.0);
    let quiet = |habit: Habit| Habit { quiet: [100_000.0, 20_000.0].map(Stays::of_mean), ..habit };
    let habits: Vec<Habit> =
        chains().into_iter().map(|habit| Habit { hours: hours.clone(), ..quiet(habit) }).collect();
    let steps = 1440;
    let classes: Vec<usize> =
        (0..steps).map(|step| usize::from(hours.is_active(step as f64 * STEP_S))).collect();
    let bound = freshness_bound(&habits, &LookLimits::per_step(classes, 1.0)).unwrap();
    let one_price = freshness_bound(&habits, &LookLimits::in_all(steps, steps as f64)).unwrap();
    assert!(one_price <= bound, "{one_price} {bound}");
    let building = places(&habits);
    for plan in [Plan::Round(1), Plan::Gain] {
        let [mean, error] = brier(&building, steps, || plan.strategy(&building, Duty::ALWAYS));
        println!(
            "{mean:.5} ± {error:.5}, {:.3} of the bound, {:.3} of that of one price",
            mean / bound,
            mean / one_price
        );
        assert!(mean + 3.0 * error > bound, "{plan:?}: {mean} ± {error}, bound {bound}");
    }
}

/// The optimum by recursion over all that can be chosen and seen: one look per step, at one of two things or at none.
fn optimum(rates: &[[f64; 2]; 2], p: [f64; 2], left: usize) -> f64 {
    if left == 0 {
        return 0.0;
    }
    let advanced =
        |p: [f64; 2]| [0, 1].map(|thing| rates[thing][0] + p[thing] * (rates[thing][1] - rates[thing][0]));
    let later =
        |p: [f64; 2]| p.iter().map(|p| p * (1.0 - p)).sum::<f64>() + optimum(rates, advanced(p), left - 1);
    let looks = [0, 1].map(|thing| {
        let seen = |state: f64| later([0, 1].map(|other| if other == thing { state } else { p[other] }));
        (1.0 - p[thing]) * seen(0.0) + p[thing] * seen(1.0)
    });
    later(p).min(looks[0]).min(looks[1])
}

#[test]
fn the_bound_is_at_most_the_optimum_and_near() {
    for (one, two) in
        [([30.0, 60.0], [40.0, 50.0]), ([100.0, 300.0], [20.0, 60.0]), ([200.0, 200.0], [90.0, 90.0])]
    {
        let habits = [one, two].map(|[free, blocked]: [f64; 2]| Habit::chain(free, blocked));
        let rates = [0, 1].map(|thing| {
            let transitions = habits[thing].transitions(true, STEP_S);
            [0, 2].map(|phase| blocked_probability(&transitions[phase]))
        });
        let start = [one, two].map(|[free, blocked]| blocked / (free + blocked));
        let steps = 7;
        let exact = optimum(&rates, start, steps) / (2 * steps) as f64;
        let single = freshness_bound(&habits, &LookLimits::in_all(steps, steps as f64)).unwrap();
        let bound = freshness_bound(&habits, &LookLimits::per_step((0..steps).collect(), 1.0)).unwrap();
        println!("{exact:.5}: {:.4}, one price {:.4}", bound / exact, single / exact);
        assert!(bound <= exact && single <= bound + 1e-12, "{single} {bound} {exact}");
        assert!(bound > 0.9 * exact, "{bound} {exact}");
    }
}

#[test]
fn the_ends_of_the_limits() {
    let habits = chains();
    let bound = |looks: f64| freshness_bound(&habits, &LookLimits::in_all(500, looks)).unwrap();
    // Without looks: the variance of each thing at all times. With a look per step and thing: nothing.
    let variance: f64 = Index::new(&habits).0.iter().map(|thing| thing[0]).sum();
    assert!((bound(0.0) / (variance / habits.len() as f64) - 1.0).abs() < 0.01);
    assert!(bound(500.0 * habits.len() as f64).abs() < 1e-3);
    let mixed = Stays { short_s: 10.0, long_s: 1000.0, long_share: 0.5 };
    let mixture = Habit { active: [mixed, mixed], ..Habit::chain(100.0, 100.0) };
    assert_eq!(freshness_bound(&[mixture], &LookLimits::in_all(10, 1.0)), None);
}

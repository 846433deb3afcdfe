//! A robot that learns the habits of the things from its looks.

use interfaces::RandomStream;
use studies::calendar::{HOUR_S, Habit, Hours, Stays};
use studies::{
    Building, Choice, Duty, Habits, Kind, Patrol, Plan, STEP_S, Strategy, Thing, ThingKind, View, Viewpoint,
};

const DAY_STEPS: usize = 8640;

/// Things that are seen from viewpoints of their own; a look takes a step.
fn places(habits: &[Habit]) -> Building {
    let count = habits.len();
    let thing = |habit: &Habit| Thing { kind: ThingKind::Box, habit: habit.clone() };
    Building {
        things: habits.iter().map(thing).collect(),
        rooms: Vec::new(),
        viewpoints: (0..count).map(|thing| Viewpoint { room: None, sees: vec![thing] }).collect(),
        dock: 0,
        steps: vec![vec![1; count]; count],
    }
}

/// Looks at all things in turn, then waits.
struct Every {
    steps: usize,
    next: usize,
}

impl Strategy for Every {
    fn choose(&mut self, view: &View<'_>, _: &mut RandomStream) -> Choice {
        if self.next < view.building.viewpoints.len() {
            self.next += 1;
            return Choice::Go(self.next - 1);
        }
        // It goes to the dock first.
        if view.is_docked {
            self.next = 0;
        }
        Choice::Rest(self.steps)
    }
}

/// The Brier scores of each day.
fn daily(mut patrol: Patrol<'_>, strategy: &mut dyn Strategy, days: usize) -> Vec<f64> {
    let day = |_| {
        let (mut sum, mut count) = (0.0, 0.0);
        patrol.run(strategy, DAY_STEPS, |predicted, is_blocked| {
            for (p, x) in predicted.iter().zip(is_blocked) {
                sum += (p - f64::from(u8::from(*x))).powi(2);
                count += 1.0;
            }
        });
        sum / count
    };
    (0..days).map(day).collect()
}

/// Slow and fast things: a robot that looks every half hour soon predicts nearly as well as one that knows them.
#[test]
fn habits_are_learned() {
    let slow = Habit::chain(8.0 * HOUR_S, 3.0 * HOUR_S);
    let fast = Habit::chain(600.0, 200.0);
    let building = places(&[slow.clone(), slow.clone(), fast.clone(), fast, slow]);
    let every = || Every { steps: 174, next: 0 };
    let (mut known, mut learned) = (vec![0.0; 4], vec![0.0; 4]);
    for seed in 0..6 {
        let add = |sum: &mut Vec<f64>, scores: Vec<f64>| {
            sum.iter_mut().zip(scores).for_each(|(sum, score)| *sum += score);
        };
        add(&mut known, daily(Patrol::new(&building, Duty::ALWAYS, seed), &mut every(), 4));
        add(
            &mut learned,
            daily(Patrol::with(&building, Duty::ALWAYS, Habits::Learned, seed), &mut every(), 4),
        );
    }
    println!("known {known:?}, learned {learned:?}");
    let ratio = |days: std::ops::Range<usize>| {
        learned[days.clone()].iter().sum::<f64>() / known[days].iter().sum::<f64>()
    };
    assert!(ratio(0..4) > 1.0, "nothing is better than the truth");
    assert!(ratio(2..4) < 1.15, "days 3 and 4: {}", ratio(2..4));
}

/// Things that change by day only: on the fifth day the robot knows the hours, though it sees each thing every two hours.
#[test]
fn hours_are_learned() {
    let habit = Habit {
        hours: Hours::daily(&[0, 1, 2, 3, 4, 5, 6], 8.0, 18.0),
        active: [Stays::of_mean(2400.0), Stays::of_mean(2400.0)],
        quiet: [Stays::of_mean(4e5), Stays::of_mean(4e5)],
    };
    let building = places(&vec![habit; 8]);
    let mut patrol = Patrol::with(&building, Duty::ALWAYS, Habits::Learned, 5);
    let mut every = Every { steps: 711, next: 0 };
    patrol.run(&mut every, 5 * DAY_STEPS, |_, _| ());
    // In how many steps the prediction is nearer to what was seen than to one half, by hour.
    let (mut sure, mut all, mut step) = ([0.0; 24], [0.0; 24], 0);
    patrol.run(&mut every, DAY_STEPS, |predicted, _| {
        let hour = (step as f64 * STEP_S / HOUR_S) as usize;
        sure[hour] += predicted.iter().map(|p| (p - 0.5).abs()).sum::<f64>();
        all[hour] += predicted.len() as f64;
        step += 1;
    });
    let mean = |hours: std::ops::Range<usize>| {
        sure[hours.clone()].iter().sum::<f64>() / all[hours].iter().sum::<f64>()
    };
    let (night, day) = (mean(0..7), mean(10..17));
    println!("distance from 1/2: by night {night:.3}, by day {day:.3}");
    assert!(night > 0.42 && day < 0.35, "by night {night}, by day {day}");
}

/// What is predicted comes true as often as it says, in buildings that the robot does not know.
#[test]
fn learned_predictions_are_calibrated() {
    let (mut sums, mut counts) = ([[0.0; 2]; 10], [0.0; 10]);
    for seed in 0..8 {
        let building =
            Building::generate(if seed % 2 == 0 { Kind::Home } else { Kind::Office }, 200_000 + seed);
        let duty = Duty::share(0.05);
        let mut strategy = Plan::Round(18).strategy(&building, duty);
        let mut step = 0;
        Patrol::with(&building, duty, Habits::Learned, seed).run(
            strategy.as_mut(),
            7 * DAY_STEPS,
            |predicted, is_blocked| {
                step += 1;
                for (p, x) in predicted.iter().zip(is_blocked).filter(|_| step > DAY_STEPS) {
                    let bin = ((10.0 * p) as usize).min(9);
                    sums[bin][0] += p;
                    sums[bin][1] += f64::from(u8::from(*x));
                    counts[bin] += 1.0;
                }
            },
        );
    }
    let all: f64 = counts.iter().sum();
    let error = sums.iter().map(|[predicted, found]| (predicted - found).abs()).sum::<f64>() / all;
    for (bin, ([predicted, found], count)) in sums.iter().zip(counts).enumerate() {
        println!(
            "bin {bin}: {:.3} predicted, {:.3} found, {:.3} of all",
            predicted / count,
            found / count,
            count / all
        );
    }
    println!("expected calibration error {error:.4}");
    assert!(error < 0.06, "expected calibration error {error}");
}

use super::*;
use interfaces::{Cell, CellReading, CellState, Grid, GroundTruth, Step, TrueState, Twist, World};
use mapper::{Mapper, MapperSettings, Paper};
use nalgebra::Isometry2;
use sim::grid::GridWorld;
use sim::physics::{PhysicsGroundTruth, PhysicsWorld, WorldSpec};

fn physics_world() -> PhysicsWorld {
    let text = include_str!("../../../worlds/four_rooms.toml");
    PhysicsWorld::new(&worldfile::physics::parse_world("four_rooms.toml", text).unwrap(), 0)
}

/// The true map, with `otherwise` in partly covered cells.
fn true_map(truth: &PhysicsGroundTruth, otherwise: CellState) -> Grid<CellState> {
    let state = |index: usize| match truth.state(index) {
        TrueState::Free => CellState::Free,
        TrueState::Blocked => CellState::Blocked,
        TrueState::PartlyCovered => otherwise,
    };
    Grid::from_cells(*truth.frame(), (0..truth.frame().len()).map(state).collect()).unwrap()
}

#[test]
fn the_true_map_is_correct_and_the_empty_map_is_not() {
    let world = physics_world();
    for otherwise in [CellState::Free, CellState::Blocked, CellState::Unknown] {
        let map = true_map(world.truth(), otherwise);
        let known = Mapper::with_prior(&MapperSettings::default(), map).unwrap();
        assert_eq!(map_scores(&known, world.truth()), MapScores { coverage: 0.0, map_quality: 1.0 });
    }
    let unknown = Mapper::new(&MapperSettings::default(), *world.truth().frame()).unwrap();
    assert_eq!(map_scores(&unknown, world.truth()), MapScores::default());
}

#[test]
fn coverage_and_age_count_the_cells_that_can_be_seen() {
    let world = physics_world();
    let truth = world.truth();
    let visible: Vec<_> =
        (0..truth.frame().len()).filter(|&index| GroundTruth::can_be_seen(truth, index)).collect();
    let mut mapper = Mapper::new(&MapperSettings::default(), *truth.frame()).unwrap();
    let half = visible.len() / 2;
    for (time, seen) in [(10.0, &visible[..half]), (30.0, &visible[..0])] {
        let cells =
            seen.iter().map(|&index| (truth.frame().cell(index), truth.state(index) == TrueState::Blocked));
        let reading = CellReading { time, pose: *world.true_pose(), cells: cells.collect() };
        mapper.update(&reading).unwrap();
    }
    let share = half as f64 / visible.len() as f64;
    assert_eq!(map_scores(&mapper, truth), MapScores { coverage: share, map_quality: share });
    let Age { max_s, never_seen } = age(&mapper, truth);
    assert_eq!((max_s, never_seen), (30.0, visible.len() - half));
}

/// A block that moves every step over three cells, and another that moves every 50 over two.
const WORLD: &str = r##"
    name = "shelf"
    sensor_radius = 1
    map = """
    #######
    #.....#
    #..R..#
    #######
    """
    [[block]]
    name = "fast"
    dwell = 1
    course = "back-and-forth"
    path = [[1, 2], [3, 2]]
    [[block]]
    name = "slow"
    dwell = 50
    course = "back-and-forth"
    path = [[4, 2], [5, 2]]
"##;

fn grid_world() -> GridWorld {
    let unindented: String = WORLD.lines().map(|line| line.trim_start().to_owned() + "\n").collect();
    GridWorld::new(&worldfile::grid::parse("shelf.toml", &unindented).unwrap(), 0)
}

fn mapper(world: &GridWorld) -> Mapper {
    let settings = MapperSettings { estimator: Paper.into(), ..Default::default() };
    Mapper::new(&settings, *world.truth().frame()).unwrap()
}

/// Shows `mapper` the true state of the cells that `sees` picks.
fn show(world: &GridWorld, mapper: &mut Mapper, sees: impl Fn(Cell) -> bool) {
    let truth = world.truth();
    let cells = (0..truth.frame().len()).map(|index| (truth.frame().cell(index), truth.is_blocked(index)));
    let cells = cells.filter(|&(cell, _)| sees(cell)).collect();
    mapper.update(&CellReading { time: truth.elapsed(), pose: Isometry2::identity(), cells }).unwrap();
}

/// The accuracy on changing cells, and the scores of the predicted map, of one sample.
fn sampled(mapper: &Mapper, world: &GridWorld) -> (Option<f64>, StateScores) {
    let (mut accuracy, mut prediction) = (ChangingAccuracy::default(), Prediction::default());
    accuracy.sample(mapper, world.truth());
    prediction.sample(mapper, world.truth(), None, |index| !mapper.is_in_view(index));
    (accuracy.scores().all, prediction.scores())
}

#[test]
fn a_robot_that_sees_everything_is_correct() {
    let mut world = grid_world();
    let mut mapper = mapper(&world);
    assert!(rate_scores(&mapper, world.truth()).log_error.is_none(), "nothing changed yet");
    for _ in 0..40 {
        show(&world, &mut mapper, |_| true);
        world.act(&Step::Stay);
    }
    show(&world, &mut mapper, |_| true);
    let scores = rate_scores(&mapper, world.truth());
    assert_eq!((scores.rate_error_all, scores.log_error, scores.false_rate_hz), (Some(0.0), Some(0.0), 0.0));
    assert_eq!((scores.false_change_events, scores.false_map_changes), (0, 0));
    assert_eq!(map_scores(&mapper, world.truth()), MapScores { coverage: 1.0, map_quality: 1.0 });
    let (accuracy, prediction) = sampled(&mapper, &world);
    assert_eq!(accuracy, Some(1.0));
    assert!(prediction.brier.is_none(), "nothing is out of view");
}

#[test]
fn a_robot_that_sees_nothing_is_incorrect_by_definition() {
    let mut world = grid_world();
    let mapper = mapper(&world);
    (0..60).for_each(|_| world.act(&Step::Stay));
    let scores = rate_scores(&mapper, world.truth());
    assert_eq!(scores.rate_error_all, Some(1.0));
    assert_eq!((scores.log_error, MAX_LOG_ERROR), (Some(MAX_LOG_ERROR), libm::log(10.0)));
    assert_eq!(map_scores(&mapper, world.truth()), MapScores { coverage: 0.0, map_quality: 0.0 });
    let (accuracy, prediction) = sampled(&mapper, &world);
    assert_eq!(accuracy, Some(0.0));
    assert_eq!((prediction.brier, prediction.brier_last_seen), (Some(0.25), Some(0.25)));
}

#[test]
fn things_count_alike_however_many_cells_they_have() {
    let mut world = grid_world();
    let mut mapper = mapper(&world);
    for _ in 0..120 {
        show(&world, &mut mapper, |cell| cell.x < 4);
        world.act(&Step::Stay);
    }
    // The fast block's three cells are completely known, the slow block's two cells are unknown.
    let scores = rate_scores(&mapper, world.truth());
    assert!((scores.log_error.unwrap() - 10.0_f64.ln() / 2.0).abs() < 0.02, "{scores:?}");
    assert!((scores.rate_error_all.unwrap() - 2.0 / 5.0).abs() < 0.02, "{scores:?}");
}

#[test]
fn a_pass_over_a_part_of_a_cell_may_count() {
    // Three swinging doors, thinner than the diagonal of a cell.
    let mut world = PhysicsWorld::new(&WorldSpec::generate_house(1004), 0);
    let settings = MapperSettings { estimator: Paper.into(), ..Default::default() };
    let frame = *world.truth().frame();
    let mut mapper = Mapper::new(&settings, frame).unwrap();
    while world.truth().elapsed() < 240.0 {
        let truth = world.truth();
        let is_touched = |index| (frame.cell(index), truth.state(index) != TrueState::Free);
        let cells = (0..frame.len()).map(is_touched).collect();
        mapper.update(&CellReading { time: truth.elapsed(), pose: *world.true_pose(), cells }).unwrap();
        world.act(&Twist::STOP);
    }
    let RateScores { log_error, log_error_of_range, .. } = rate_scores(&mapper, world.truth());
    let (strict, of_range) = (log_error.unwrap(), log_error_of_range.unwrap());
    assert!(of_range < 0.2 && strict > 2.0 * of_range, "{strict} {of_range}");
}

#[test]
fn an_old_map_is_incorrect_where_things_have_moved() {
    let mut world = grid_world();
    let mut mapper = mapper(&world);
    show(&world, &mut mapper, |_| true);
    world.act(&Step::Stay);
    show(&world, &mut mapper, |cell| cell.y == 0);
    let visible = (0..28).filter(|&index| world.truth().can_be_seen(index)).count() as f64;
    let scores = map_scores(&mapper, world.truth());
    assert!((scores.map_quality - (visible - 2.0) / visible).abs() < 1e-12, "{scores:?}");
    let (accuracy, prediction) = sampled(&mapper, &world);
    // Of three free changing cells two are right, of two blocked ones one.
    assert_eq!(accuracy, Some((2.0 / 3.0 + 0.5) / 2.0));
    assert_eq!(prediction.brier_last_seen, Some(2.0 / 5.0));
}

/// Rates of the three cells of the fast block, frozen after 20 of 60 steps. The oracle counts the events itself and takes the
/// deviance from the probabilities of the Poisson distribution.
#[test]
fn the_deviance_is_that_of_an_independent_computation() {
    let mut world = grid_world();
    let mut mapper = mapper(&world);
    let cells = [1, 2, 3].map(|x| world.truth().frame().index(Cell::new(x, 2)).unwrap());
    let blocked = |world: &GridWorld| cells.map(|index| world.truth().is_blocked(index));
    let mut entered = [[0.0; 3]; 2];
    let mut run = |world: &mut GridWorld, mut mapper: Option<&mut Mapper>, part: usize, steps: u32| {
        for _ in 0..steps {
            let before = blocked(world);
            if let Some(mapper) = &mut mapper {
                show(world, mapper, |cell| cell.y == 2 && (1..4).contains(&cell.x));
            }
            world.act(&Step::Stay);
            for (cell, is_blocked) in blocked(world).into_iter().enumerate() {
                entered[part][cell] += f64::from(u8::from(is_blocked && !before[cell]));
            }
        }
    };
    run(&mut world, Some(&mut mapper), 0, 20);
    let chosen = [0.2, 0.5, 0.1];
    let rate_of = |rates: [f64; 3]| {
        move |index: usize| cells.iter().position(|&cell| cell == index).map_or(0.0, |cell| rates[cell])
    };
    let freeze = |rates: [f64; 3]| FrozenRates::estimated(&mapper, world.truth(), rate_of(rates));
    let frozen = freeze(chosen);
    let mut later = grid_world();
    (0..20).for_each(|_| later.act(&Step::Stay));
    run(&mut later, None, 1, 40);
    let future = entered[1].map(|count| count / 40.0);
    let mean = future.iter().sum::<f64>() / 3.0;

    let log_probability = |count: f64, expected: f64| {
        let log_factorial: f64 = (1..=count as u32).map(|number| f64::from(number).ln()).sum();
        count * expected.ln() - expected - log_factorial
    };
    let log_likelihood = |rates: [f64; 3]| -> f64 {
        entered[1].iter().zip(rates).map(|(&count, rate)| log_probability(count, 40.0 * rate)).sum()
    };
    let explained = |rates: [f64; 3], constant: f64| {
        let best = log_likelihood(future);
        1.0 - (best - log_likelihood(rates)) / (best - log_likelihood([constant; 3]))
    };
    let scores = frozen.scores(later.truth());
    assert_eq!((scores.from, scores.to), (Some(20.0), Some(60.0)));
    let near = |found: Option<f64>, expected: f64| {
        let found = found.unwrap();
        assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
    };
    near(scores.predictive_deviance, explained(chosen, mean));
    // Each cell was in view for 19 steps, up to the reading before the freeze.
    let cycles = cells.map(|index| f64::from(mapper.statistics(index).cycles()));
    let known = (cycles.iter().sum::<f64>() + 0.5) / (3.0 * 19.0);
    near(scores.predictive_deviance_known, explained(chosen, known));
    let full_mean = (entered[0].iter().sum::<f64>() + 0.5) / 60.0;
    let full = entered[0].map(|count| (count + 0.3) / (20.0 + 0.3 / full_mean));
    near(scores.predictive_deviance_ceiling, explained(full, mean));
    near(freeze(future).scores(later.truth()).predictive_deviance, 1.0);
    near(freeze([mean; 3]).scores(later.truth()).predictive_deviance, 0.0);
}

#[test]
fn a_map_that_sees_everything_forecasts_a_clock() {
    let mut world = grid_world();
    let mut mapper = mapper(&world);
    let mut forecasts = Forecasts::default();
    for step in 0..=1200 {
        show(&world, &mut mapper, |_| true);
        forecasts.observe(&mapper, world.truth(), None);
        let scores = forecasts.scores();
        assert_eq!(scores.rates.from.is_some(), step >= 45, "the first forecast is from 15 to 45");
        assert_eq!(scores.states_1min.brier.is_some(), step >= 120);
        assert_eq!(scores.states_10min.brier.is_some(), step >= 1200);
        world.act(&Step::Stay);
    }
    let ForecastScores { rates, states_1min, states_10min, states_1h } = forecasts.scores();
    assert_eq!(states_1h, StateScores::default(), "the run is shorter");
    assert_eq!((rates.from, rates.to), (Some(400.0), Some(1200.0)));
    let [found, ceiling] = [rates.predictive_deviance, rates.predictive_deviance_ceiling].map(Option::unwrap);
    assert!(found > 0.95 && found <= ceiling + 0.02, "{rates:?}");
    for scores in [states_1min, states_10min] {
        let StateScores { brier, brier_last_seen, calibration_error, .. } = scores;
        for (score, most) in [(brier, 0.6), (brier_last_seen, 1.0), (calibration_error, 1.0)] {
            assert!((0.0..=most).contains(&score.unwrap()), "{scores:?}");
        }
    }
}

#[test]
fn a_prediction_whose_time_comes_while_the_robot_rests_is_left_out() {
    // The last reading before the rest is at 60, and freezes the prediction for 120. The first reading after the rest freezes
    // the next one.
    for (wakes, ends) in [(123, 123), (124, 184), (130, 190), (1000, 1060)] {
        let mut world = grid_world();
        let mut mapper = mapper(&world);
        let mut forecasts = Forecasts::default();
        for step in 0..=1060 {
            if step <= 60 || step >= wakes {
                show(&world, &mut mapper, |_| true);
                forecasts.observe(&mapper, world.truth(), None);
                let is_scored = forecasts.scores().states_1min.brier.is_some();
                assert_eq!(is_scored, step >= ends, "rest from 60 to {wakes}, at {step}");
            }
            world.act(&Step::Stay);
        }
    }
}

/// The delays of block events and free events after 30 s of a robot that turns, and looks elsewhere while a box appears or disappears.
fn delays_of_a_box(times: &str) -> [Delays; 2] {
    let text = include_str!("../../../worlds/toy_on_the_floor.toml");
    let (before, toy) = text.split_once("min_m = [11.5, 2.0]").unwrap();
    let (_, rest) = toy.split_once("appears_s = 300.0").unwrap();
    let text = format!("{before}min_m = [3.0, 3.0]\nmax_m = [3.4, 3.4]\n{times}{rest}");
    let text = text.replace("fov_deg = 360.0", "fov_deg = 90.0");
    let mut world = PhysicsWorld::new(&worldfile::physics::parse_world("toy.toml", &text).unwrap(), 0);
    let mut mapper = Mapper::new(&MapperSettings::default(), *world.truth().frame()).unwrap();
    let turn = Twist { angular_radps: 0.5, ..Twist::STOP };
    let mut latency = Latency::default();
    while world.time_s() < 30.0 {
        let reading = world.sense();
        mapper.update(&reading).unwrap();
        latency.observe(world.truth(), &mapper, &reading, &(world.true_pose() * reading.mount));
        world.act(&turn);
    }
    latency.delays()
}

#[test]
fn a_body_that_stays_counts_like_one_that_leaves() {
    let [stays, none] = delays_of_a_box("appears_s = 5.0\n");
    let [leaves, frees] = delays_of_a_box("appears_s = 5.0\ndisappears_s = 18.0\n");
    assert!(none.shown == 0 && frees.shown > 0, "{none:?} {frees:?}");
    assert!(stays.shown >= 10 && stays.never_noticed == 0.0, "{stays:?}");
    assert_eq!((stays.shown, stays.never_noticed), (leaves.shown, leaves.never_noticed));
    assert_eq!((stays.median_s, stays.p95_s), (leaves.median_s, leaves.p95_s));
}

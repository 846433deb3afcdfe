use super::*;
use crate::Film;
use crate::fake_run::FakeRun;
use crate::legend::Mark;
use crate::palette::{self, Rgb};
use crate::view::Trail;
use files::UnfinishedFile;
use image::RgbImage;
use interfaces::CellState;
use nalgebra::Point2;

struct Drawn {
    folder: tempfile::TempDir,
    run: FakeRun,
}

fn goals() -> Goals {
    let mut goals = Goals::default();
    goals.push(Point2::new(3.0, 4.0));
    goals
}

/// Simulates a tenth of a second, with the trails of the robots.
fn step(run: &mut FakeRun, trails: &mut [Trail; 2]) {
    run.step();
    trails.iter_mut().zip(run.positions()).for_each(|(trail, (_, at))| trail.push(at));
}

/// A simulated run, drawn into a folder.
fn drawn(ticks: usize) -> Drawn {
    let folder = tempfile::tempdir().unwrap();
    let mut run = FakeRun::new();
    let mut trails = [(); 2].map(|()| Trail::default());
    (0..ticks).for_each(|_| step(&mut run, &mut trails));
    let trails = Trails { true_poses: &trails, believed: &Trail::default() };
    write_all(folder.path(), &run.scene, &run.mapper, &trails, &goals(), &Layer::ALL).unwrap();
    Drawn { folder, run }
}

impl Drawn {
    fn picture(&self, name: &str) -> RgbImage {
        image::open(self.folder.path().join(format!("{name}.png"))).unwrap().into_rgb8()
    }

    fn color(&self, picture: &RgbImage, x_m: f64, y_m: f64) -> Rgb {
        let panel = Panel::of_layer(self.run.mapper.frame());
        let [x, y] = panel.pixel(&Point2::new(x_m, y_m));
        picture.get_pixel(x, y).0
    }
}

#[test]
fn a_map_shows_every_cell_where_it_lies() {
    let drawn = drawn(600);
    let (picture, mapper) = (drawn.picture("occupancy"), &drawn.run.mapper);
    let (mut shown, mut total) = (0, 0);
    // The border of the picture has the axes' line.
    for index in (0..mapper.frame().len()).step_by(7) {
        let cell = mapper.frame().cell(index);
        if !(2..238).contains(&cell.x) || !(2..238).contains(&cell.y) {
            continue;
        }
        let center = mapper.frame().center(cell);
        let expected = match mapper.states().cells()[index] {
            CellState::Free => palette::FREE,
            CellState::Blocked => palette::BLOCKED,
            CellState::Unknown => palette::UNKNOWN,
        };
        total += 1;
        shown += usize::from(drawn.color(&picture, center.x, center.y) == expected);
    }
    assert!(total > 7500 && shown as f64 > 0.99 * f64::from(total), "{shown} of {total}");
}

#[test]
fn the_stripe_of_the_dummy_is_dark_and_nothing_else_is() {
    let drawn = drawn(3000);
    let picture = drawn.picture("interval");
    // Purple to red: a cycle takes less than half a minute.
    let is_short = |[red, green, blue]: Rgb| red < 230 && green < 90 && blue < 120;
    let stripe = (0..=8).filter(|x| is_short(drawn.color(&picture, 7.2 + 0.4 * f64::from(*x), 11.1)));
    assert!(stripe.count() >= 5);
    for (x_m, y_m) in [(3.0, 3.0), (9.0, 3.0), (3.0, 9.0), (9.0, 8.0)] {
        assert_eq!(drawn.color(&picture, x_m, y_m), palette::FREE);
    }
    assert_eq!(drawn.color(&picture, 6.0, 1.0), palette::BLOCKED_FAINT, "walls are drawn faintly");
}

#[test]
fn trails_walls_obstacles_starts_and_goals_are_drawn() {
    let drawn = drawn(300);
    let picture = drawn.picture("trajectory");
    let entries = trajectory::entries(&drawn.run.scene, &Trail::default(), &goals()).len();
    let panel = Panel::of_scene(drawn.run.mapper.frame(), drawn.run.scene.is_grid, entries);
    let near = |x_m: f64, y_m: f64, color: Rgb| {
        let [x, y] = panel.pixel(&Point2::new(x_m, y_m));
        let mut around = (x - 3..x + 3).flat_map(|x| (y - 3..y + 3).map(move |y| (x, y)));
        around.any(|(x, y)| picture.get_pixel(x, y).0 == color)
    };
    let (curious, other) = (palette::CURIOUS, palette::OTHER_ROBOT);
    assert!(near(3.0, 3.0, curious) && near(6.0, 3.0, curious) && !near(6.0, 9.0, curious));
    assert!(near(7.0, 11.2, other) && near(9.0, 11.2, other) && !near(9.0, 10.0, other));
    assert!(near(6.0, 1.0, palette::WALL));
    assert!(near(2.2, 10.2, palette::SWEPT));
    assert!(near(3.0, 4.0, palette::GOAL));
}

#[test]
fn names_are_beside_their_owners() {
    let (folder, scene) = (tempfile::tempdir().unwrap(), FakeRun::new().scene);
    let file = folder.path().join("plan.png");
    draw_plan(&file, &scene).unwrap();
    let picture = image::load_from_memory(&std::fs::read(&file).unwrap()).unwrap().into_rgb8();
    let panel = Panel::of_scene(&scene.frame, scene.is_grid, plan::entries(&scene).len());
    let dark = |[x, y]: [f64; 2]| {
        let [left, top] = panel.pixel(&Point2::new(x - 0.5, y));
        let [right, bottom] = panel.pixel(&Point2::new(x + 0.5, y - 0.6));
        let below = (left..right).flat_map(|x| (top..bottom).map(move |y| (x, y)));
        below.filter(|(x, y)| picture.get_pixel(*x, *y).0.iter().all(|part| *part < 120)).count()
    };
    // Below the two robots.
    assert!(dark([3.0, 2.75]) > 20 && dark([7.0, 10.95]) > 20);
}

#[test]
fn other_robots_share_an_entry_of_the_legend() {
    let mut scene = FakeRun::new().scene;
    let names = |scene: &Scene| -> Vec<String> {
        let entries = trajectory::entries(scene, &Trail::default(), &Goals::default()).into_iter();
        entries.filter(|(mark, _)| matches!(mark, Mark::Line(_))).map(|(_, name)| name).collect()
    };
    assert_eq!(names(&scene), ["curious", "dummy"]);
    scene.robots.push(scene.robots[1].clone());
    assert_eq!(names(&scene), ["curious", "2 other robots"]);
}

#[test]
fn a_film_is_a_small_gif_that_shows_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.gif");
    let mut run = FakeRun::new();
    let mut film = Film::new(UnfinishedFile::create(&file).unwrap(), run.scene.clone(), 30.0);
    let mut trails = [(); 2].map(|()| Trail::default());
    for _ in 0..300 {
        step(&mut run, &mut trails);
        run.with_view(|view| film.add(view, &trails)).unwrap();
    }
    film.write().unwrap();
    let bytes = std::fs::read(&file).unwrap();
    assert!(bytes.len() < 1_000_000, "{}", bytes.len());
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::Indexed);
    let mut decoder = options.read_info(&*bytes).unwrap();
    let mut frames = 0;
    let mut duration = 0;
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        frames += 1;
        duration += u32::from(frame.delay);
        assert!(frame.top + frame.height <= 600 && frame.width == 840, "{} {}", frame.top, frame.height);
    }
    assert!((100..=130).contains(&frames), "{frames}");
    assert!((1000..=1600).contains(&duration), "{duration}");
}

#[test]
fn figure_5_is_its_three_panels_side_by_side() {
    let drawn = drawn(100);
    let figure = drawn.picture("figure5");
    let mut left = 0;
    for layer in FIGURE_5 {
        let panel = drawn.picture(layer.name());
        let part = image::imageops::crop_imm(&figure, left, 0, panel.width(), panel.height()).to_image();
        assert!(part == panel, "{layer:?}");
        left += panel.width();
    }
    assert_eq!(figure.width(), left);
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let folder = file.path().join("pictures");
    let run = FakeRun::new();
    let trails = Trails { true_poses: &[], believed: &Trail::default() };
    let error = write_all(&folder, &run.scene, &run.mapper, &trails, &Goals::default(), &Layer::ALL)
        .unwrap_err()
        .to_string();
    assert!(error.starts_with(&format!("cannot write {}", folder.display())), "{error}");
}

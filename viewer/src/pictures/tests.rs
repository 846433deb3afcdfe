use super::*;
use crate::fake::FakeRun;
use crate::layer::Rgb;
use image::RgbImage;
use interfaces::CellState;

struct Drawn {
    folder: tempfile::TempDir,
    run: FakeRun,
}

/// A made-up run, drawn into a folder.
fn drawn(ticks: usize) -> Drawn {
    let folder = tempfile::tempdir().unwrap();
    let mut run = FakeRun::new();
    let mut trails = run.places().map(|(name, is_curious, _)| Trail::new(name, is_curious));
    for _ in 0..ticks {
        run.step();
        for (trail, (_, _, at)) in trails.iter_mut().zip(run.places()) {
            trail.push(at);
        }
    }
    let goals = [Point2::new(3.0, 4.0)];
    let pictures = Pictures { scene: &run.scene, mapper: &run.mapper, trails: &trails, goals: &goals };
    let start = std::time::Instant::now();
    write_all(folder.path(), &pictures).unwrap();
    println!("drawn in {:?}", start.elapsed());
    Drawn { folder, run }
}

impl Drawn {
    fn picture(&self, name: &str) -> RgbImage {
        image::open(self.folder.path().join(format!("{name}.png"))).unwrap().into_rgb8()
    }

    fn colour(&self, picture: &RgbImage, x_m: f64, y_m: f64) -> Rgb {
        let [x, y] = panel::pixel(self.run.mapper.frame(), &Point2::new(x_m, y_m));
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
            CellState::Free => [255, 255, 255],
            CellState::Blocked => [32, 36, 44],
            CellState::Unknown => [211, 219, 232],
        };
        total += 1;
        shown += usize::from(drawn.colour(&picture, center.x, center.y) == expected);
    }
    assert!(total > 7500 && shown as f64 > 0.99 * f64::from(total), "{shown} of {total}");
}

#[test]
fn the_stripe_of_the_dummy_is_red_and_nothing_else_is() {
    let drawn = drawn(3000);
    let picture = drawn.picture("interval");
    // Red to orange: a cycle takes less than half a minute.
    let is_red = |[red, green, blue]: Rgb| red > 200 && green < 190 && blue < 80;
    let stripe = (0..=8).filter(|x| is_red(drawn.colour(&picture, 7.2 + 0.4 * f64::from(*x), 11.1)));
    assert!(stripe.count() >= 5);
    for (x_m, y_m) in [(3.0, 3.0), (9.0, 3.0), (3.0, 9.0), (9.0, 8.0)] {
        assert_eq!(drawn.colour(&picture, x_m, y_m), [255; 3]);
    }
    assert_eq!(drawn.colour(&picture, 6.0, 1.0), [158, 160, 165], "walls are drawn faintly");
}

#[test]
fn trails_walls_starts_and_goals_are_drawn() {
    let drawn = drawn(300);
    let picture = drawn.picture("trajectory");
    let near = |x_m: f64, y_m: f64, colour: Rgb| {
        let [x, y] = panel::pixel(drawn.run.mapper.frame(), &Point2::new(x_m, y_m));
        let mut around = (x - 3..x + 3).flat_map(|x| (y - 3..y + 3).map(move |y| (x, y)));
        around.any(|(x, y)| picture.get_pixel(x, y).0 == colour)
    };
    let (blue, green, red) = ([31, 97, 209], [26, 158, 64], [214, 30, 60]);
    assert!(near(3.0, 3.0, blue) && near(6.0, 3.0, blue) && !near(6.0, 9.0, blue));
    assert!(near(7.0, 11.2, green) && near(9.0, 11.2, green) && !near(9.0, 10.0, green));
    assert!(near(6.0, 1.0, [70, 74, 82]));
    assert!(near(3.0, 4.0, red));
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
    let pictures = Pictures { scene: &run.scene, mapper: &run.mapper, trails: &[], goals: &[] };
    let error = write_all(&folder, &pictures).unwrap_err().to_string();
    assert!(error.starts_with(&format!("cannot write {}: ", folder.display())), "{error}");
}

#[test]
#[ignore = "draws pictures to look at"]
fn look() {
    let start = std::time::Instant::now();
    let folder = drawn(6000).folder.keep();
    println!("{} in {:?}", folder.display(), start.elapsed());
}

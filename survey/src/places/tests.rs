//! Places of drawn maps: numbers, names, passages, and what is different in another session.

use super::*;
use interfaces::{Cell, CellReading, GridFrame};
use mapper::MapperSettings;
use nalgebra::Isometry2;

/// A room of 6 × 2 m without walls, in cells of 0.1 m.
struct Room {
    mapper: Mapper,
    log: ChangeLog,
    book: PlaceBook,
    time_s: f64,
}

impl Room {
    fn new() -> Self {
        let frame = GridFrame::new(Point2::origin(), 0.1, 60, 20).unwrap();
        let mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
        Self { mapper, log: ChangeLog::default(), book: PlaceBook::default(), time_s: 0.0 }
    }

    /// Looks at all cells once a second, for some time; `is_blocked` gets the time since the begin of this look.
    fn look(&mut self, seconds: u32, is_blocked: impl Fn(u32, Cell) -> bool) {
        let frame = *self.mapper.frame();
        for second in 0..seconds {
            let cell = |index: usize| (frame.cell(index), is_blocked(second, frame.cell(index)));
            let cells = (0..frame.len()).map(cell).collect();
            let reading = CellReading { time: self.time_s, pose: Isometry2::identity(), cells };
            self.mapper.update(&reading).unwrap();
            self.log.note(&self.mapper);
            self.book.note(&self.mapper);
            self.time_s += 1.0;
        }
    }

    /// The log ends, and the next one begins a day later, in another session.
    fn next_day(&mut self) {
        let places = self.places();
        self.book.keep(&self.mapper, &places);
        self.book.begin_session(&self.mapper, 1);
        self.time_s += 86_400.0;
        self.mapper.pause(self.time_s);
    }

    fn places(&self) -> Vec<Place> {
        places(&self.mapper, &self.log, &self.book)
    }

    fn at(&self, x_m: f64) -> Place {
        let places = self.places();
        places.iter().find(|place| (place.low_m[0]..place.high_m[0]).contains(&x_m)).unwrap().clone()
    }

    fn since(&self) -> Since {
        since(&self.book, &self.mapper, &self.log, &self.places()).unwrap()
    }
}

/// A body of 0.3 × 0.3 m with its left side at this cell.
fn body(left: i32, cell: Cell) -> bool {
    (left..left + 3).contains(&cell.x) && (8..11).contains(&cell.y)
}

/// Something passes at 1 m every `every` seconds, for 2 s.
fn passes(every: u32) -> impl Fn(u32, Cell) -> bool {
    move |second, cell| second % every < 2 && second >= 2 && body(10, cell)
}

#[test]
fn a_body_that_passes_counts_once_and_is_traffic() {
    let mut room = Room::new();
    room.look(602, passes(60));
    let place = room.at(1.1);
    let rates = place.rates.clone().unwrap();
    assert_eq!((rates.passages, place.kind, rates.has_cycle()), (10, PlaceKind::Traffic, true));
    let [low, high] = rates.passages_per_hour_90.unwrap();
    assert!((low..high).contains(&60.0) && low > 20.0 && high < 130.0, "{low} to {high}");
    assert!((rates.passages_per_hour.unwrap() - 60.0).abs() < 1.0, "{rates:?}");
}

#[test]
fn a_place_says_where_how_often_and_when_last() {
    let mut room = Room::new();
    room.look(1000, |second, cell| (2..5).contains(&cell.x) && cell.y == 0 && second % 10 < 3);
    let places = room.places();
    let [place] = &places[..] else { panic!("{places:?}") };
    assert!((place.x_m - 0.35).abs() < 1e-9 && (place.area_m2 - 0.03).abs() < 1e-9, "{place:?}");
    assert!((place.low_m[0] - 0.2).abs() < 1e-9 && (place.high_m[0] - 0.5).abs() < 1e-9, "{place:?}");
    // One cycle in 10 s, and blocked for 3 of them.
    let rates = place.rates.as_ref().unwrap();
    assert!((rates.cycles_per_hour / 360.0 - 1.0).abs() < 0.05, "{place:?}");
    assert!((rates.share_blocked - 0.3).abs() < 0.02, "{place:?}");
    let [low, high] = rates.cycles_per_hour_90.map(Option::unwrap);
    assert!(low < 360.0 && high > 360.0 && high < 2.0 * low, "{place:?}");
    assert_eq!((rates.last_change_s, place.changes, room.log.events()), (993.0, 199, 3 * 199));
}

#[test]
fn what_changed_once_is_unknown_and_has_no_cycle() {
    let mut room = Room::new();
    room.look(300, |second, cell| second > 100 && body(10, cell));
    let place = room.at(1.1);
    let rates = place.rates.unwrap();
    assert_eq!((place.kind, rates.passages, rates.has_cycle()), (PlaceKind::Unknown, 1, false));
}

#[test]
fn places_keep_their_numbers_when_others_become_livelier() {
    let mut room = Room::new();
    room.look(602, |second, cell| passes(30)(second, cell) || second > 100 && second < 200 && body(30, cell));
    assert_eq!((room.at(1.1).number, room.at(3.1).number), (1, 2));
    room.next_day();
    // The second place is livelier now, a third one is new, and the map has more cells there.
    let next =
        |second: u32, cell: Cell| second % 10 < 3 && (body(30, cell) || body(32, cell) || body(50, cell));
    room.look(1200, next);
    assert_eq!((room.at(1.1).number, room.at(3.1).number, room.at(5.1).number), (1, 2, 3));
    assert_eq!(room.places()[2].number, 1, "the quietest one is the last");
    let restored: PlaceBook = interfaces::from_bytes(&interfaces::to_bytes(&room.book)).unwrap();
    assert!(restored == room.book);
}

#[test]
fn sessions_are_compared_by_the_time_in_view() {
    let mut room = Room::new();
    let two = |first: u32, second: u32| {
        move |time: u32, cell: Cell| {
            time % first < 2 && time >= 2 && body(10, cell)
                || time % second < 2 && time >= 2 && body(30, cell)
        }
    };
    room.look(1802, two(60, 20));
    assert!(since(&room.book, &room.mapper, &room.log, &room.places()).is_none());
    room.next_day();
    // In twice the time: as often as before, not at all, for the first time; a box has come, and stays.
    let next = |time: u32, cell: Cell| {
        two(60, 100_000)(time, cell)
            || time % 60 < 2 && time >= 2 && body(50, cell)
            || (20..23).contains(&cell.x) && cell.y < 4
    };
    room.look(3602, next);
    let since = room.since();
    let trend = |number: u32| since.places.iter().find(|place| place.number == number).unwrap().trend;
    assert_eq!(trend(room.at(1.1).number), Trend::Same);
    assert_eq!(trend(room.at(3.1).number), Trend::Gone);
    assert_eq!(trend(room.at(5.1).number), Trend::New);
    let [lasting] = &since.lasting[..] else { panic!("{since:?}") };
    assert!(
        lasting.is_new && (lasting.x_m - 2.15).abs() < 0.01 && (lasting.area_m2 - 0.12).abs() < 1e-9,
        "{lasting:?}"
    );
    // And once more: then nothing is new but the pace of one place.
    room.next_day();
    room.look(1802, |time, cell| next(time, cell) || passes(10)(time, cell));
    let since = room.since();
    let trends: Vec<Trend> = since.places.iter().map(|place| place.trend).collect();
    assert_eq!(trends.iter().filter(|trend| **trend == Trend::Livelier).count(), 1, "{since:?}");
    assert!(!trends.contains(&Trend::New) && since.lasting.is_empty(), "{since:?}");
}

#[test]
fn names_go_to_the_nearest_place_and_stay() {
    let mut room = Room::new();
    room.look(602, |second, cell| {
        passes(30)(second, cell) || passes(40)(second, cell) || second % 50 < 3 && body(30, cell)
    });
    let name = |name: &str, x_m: f64| PlaceName { name: name.to_owned(), x_m, y_m: 1.0, radius_m: 0.5 };
    room.book.names = vec![name("Kitchen", 1.4), name("Desk", 3.2), name("Window", 5.0)];
    assert_eq!(room.at(1.1).name.as_deref(), Some("Kitchen"));
    assert_eq!(room.at(3.1).name.as_deref(), Some("Desk"));
    let still = still_names(&room.mapper, &room.book.names, &room.places());
    let [window] = &still[..] else { panic!("{still:?}") };
    assert!(window.name.name == "Window" && window.observed_s.is_some_and(|time_s| time_s > 590.0));
    room.next_day();
    assert_eq!(room.at(3.1).name.as_deref(), Some("Desk"));
}

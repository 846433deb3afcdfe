use super::*;
use interfaces::{CellReading, Event};
use mapper::MapperSettings;
use nalgebra::Isometry2;

/// What is published after a reading, at a time in seconds, with this interval.
fn publisher(map_update_interval_s: f64) -> impl FnMut(&Mapper, u64) -> Vec<(Topic, Message)> {
    let (mut maps, start) = (PublishedMaps::default(), Instant::now());
    let parameters =
        Parameters { map_update_interval_s, mask_update_interval_s: 0.0, ..Parameters::default() };
    move |mapper, after_s| {
        let now = start + Duration::from_secs(after_s);
        maps.after(&parameters, mapper, &Header::default(), now, Topic::default_name)
    }
}

/// A mapper of 300 × 200 cells that has seen some cells.
fn mapper() -> Mapper {
    let frame = GridFrame::new(Point2::new(-15.0, -10.0), 0.1, 300, 200).unwrap();
    Mapper::new(&MapperSettings::default(), frame).unwrap()
}

fn see(mapper: &mut Mapper, time: f64, cells: &[(i32, i32, bool)]) {
    let cells = cells.iter().map(|(x, y, is_blocked)| (Cell::new(*x, *y), *is_blocked)).collect();
    mapper.update(&CellReading { time, pose: Isometry2::identity(), cells }).unwrap();
}

fn grid(message: &(Topic, Message)) -> (Topic, &OccupancyGrid) {
    let (topic, Message::Grid(grid)) = message else { panic!("{message:?}") };
    (*topic, grid)
}

#[test]
fn only_the_known_part_is_published() {
    let (mut mapper, mut after) = (mapper(), publisher(5.0));
    assert_eq!(after(&mapper, 0), []);
    see(&mut mapper, 1.0, &[(70, 130, false), (71, 130, true)]);
    let messages = after(&mapper, 0);
    let topics: Vec<Topic> = messages.iter().map(|message| grid(message).0).collect();
    assert_eq!(topics, [Topic::Map, Topic::ChangeMap, Topic::PredictedMap, Topic::RateMap, Topic::ExpiryMap]);
    let (_, map) = grid(&messages[0]);
    // From 64 to 128 across, and from 128 to 192 up.
    assert_eq!((map.width, map.height), (64, 64));
    assert!((map.origin.position.x - (-15.0 + 6.4)).abs() < 1e-9);
    assert!((map.origin.position.y - (-10.0 + 12.8)).abs() < 1e-9);
    let row = 2 * 64;
    assert_eq!(map.data[row + 5..row + 9], [-1, 0, 100, -1]);
    assert_eq!(map.data.iter().filter(|value| **value != -1).count(), 2);
    // At the upper border, the map ends before the next block.
    see(&mut mapper, 2.0, &[(299, 199, true)]);
    let messages = after(&mapper, 5);
    let (_, map) = grid(&messages[0]);
    assert_eq!((map.width, map.height), (300 - 64, 200 - 128));
}

#[test]
fn changes_are_published_at_once_and_maps_rarely() {
    let (mut mapper, mut after) = (mapper(), publisher(5.0));
    see(&mut mapper, 0.0, &[(70, 130, false), (71, 130, true)]);
    after(&mapper, 0);
    // Nothing new.
    see(&mut mapper, 0.1, &[(70, 130, false)]);
    assert_eq!(after(&mapper, 0), []);
    see(&mut mapper, 0.2, &[(71, 130, false), (73, 131, true), (1, 1, true)]);
    let event = mapper.transitions().iter().find_map(|change| change.event());
    assert_eq!(event, Some(Event::Free));
    let messages = after(&mapper, 1);
    let [(Topic::MapUpdates, Message::GridUpdate(update))] = messages.as_slice() else {
        panic!("{messages:?}")
    };
    assert_eq!((update.x, update.y, update.width, update.height), (7, 2, 3, 2));
    assert_eq!(update.data, [0, -1, -1, -1, -1, 100]);
    // What is outside of the published part comes with the next whole map, and the changes ten seconds after the first.
    see(&mut mapper, 0.3, &[(70, 130, false)]);
    let messages = after(&mapper, 6);
    assert_eq!(messages.iter().map(|message| grid(message).0).collect::<Vec<_>>(), [Topic::Map]);
    assert_eq!(grid(&messages[0]).1.width, 128);
    see(&mut mapper, 0.4, &[(70, 130, true)]);
    let messages = after(&mapper, 12);
    assert_eq!(messages.len(), 5);
}

#[test]
fn large_maps_are_published_less_often() {
    let frame = GridFrame::new(Point2::origin(), 0.1, 1200, 600).unwrap();
    let mut mapper = Mapper::new(&MapperSettings::default(), frame).unwrap();
    let mut after = publisher(1.0);
    see(&mut mapper, 0.0, &[(0, 0, true), (1199, 599, true)]);
    assert_eq!(after(&mapper, 0).len(), 5);
    see(&mut mapper, 1.0, &[(5, 5, true)]);
    // 720,000 cells: twice the interval of a large map.
    let messages = after(&mapper, 9);
    assert!(matches!(messages[..], [(Topic::MapUpdates, _)]));
    assert_eq!(after(&mapper, 10).len(), 5);
}

#[test]
fn masks_are_published_rarely_and_their_meaning_once() {
    let (mut mapper, start) = (mapper(), Instant::now());
    let (mut maps, parameters) = (PublishedMaps::default(), Parameters::default());
    let mut due = |mapper: &Mapper, after_s: u64| {
        let now = start + Duration::from_secs(after_s);
        maps.masks(&parameters, mapper, &Header::default(), now, Topic::default_name)
    };
    assert_eq!(due(&mapper, 0), []);
    // A box of 0.5 m comes to stay where it was free.
    let cells = |is_blocked| (0..25).map(|at| (70 + at % 5, 130 + at / 5, is_blocked)).collect::<Vec<_>>();
    see(&mut mapper, 0.0, &cells(false));
    (1..20).for_each(|time| see(&mut mapper, f64::from(time), &cells(true)));
    let messages = due(&mapper, 1);
    let topics: Vec<Topic> = messages.iter().map(|message| message.0).collect();
    let expected = [Topic::SpeedMask, Topic::KeepoutMask, Topic::SpeedFilterInfo, Topic::KeepoutFilterInfo];
    assert_eq!(topics, expected);
    let (_, keepout) = grid(&messages[1]);
    assert_eq!((keepout.width, keepout.height), (64, 64));
    assert_eq!(keepout.data.iter().filter(|value| **value == 100).count(), 25);
    let (_, Message::FilterInfo(info)) = &messages[3] else { panic!("{messages:?}") };
    assert_eq!((info.kind, info.filter_mask_topic.as_str(), info.multiplier), (0, "keepout_mask", 1.0));
    assert_eq!(due(&mapper, 30), []);
    assert_eq!(due(&mapper, 31).len(), 2);
}

/// A corridor along x from 0 to 2 m whose middle was blocked now and then.
pub(crate) fn corridor() -> Mapper {
    let mut mapper = mapper();
    let cells = |is_blocked: bool| {
        let cell = |x: i32, y: i32| (150 + x, 100 + y, is_blocked && x == 10);
        (-3..=3).flat_map(|y| (-3..24).map(move |x| cell(x, y))).collect::<Vec<_>>()
    };
    for step in 0..40 {
        see(&mut mapper, f64::from(step), &cells(step / 5 % 2 == 1));
    }
    mapper
}

#[test]
fn a_look_expires_where_something_changes() {
    let (mapper, mut after) = (corridor(), publisher(5.0));
    let messages = after(&mapper, 0);
    let (topic, expiry) = grid(messages.last().unwrap());
    assert_eq!(topic, Topic::ExpiryMap);
    let known: Vec<i8> = expiry.data.iter().copied().filter(|value| *value != -1).collect();
    // Seven cells changed every five seconds: a look is worth less than half a minute. Nothing is known of the others.
    assert_eq!(known, [0; 7]);
    let worth = survey::Outlook::live(&mapper).worth();
    let seconds: Vec<f64> = worth.cells().iter().copied().filter(|worth_s| !worth_s.is_nan()).collect();
    assert!(seconds.iter().all(|worth_s| (0.5..10.0).contains(worth_s)), "{seconds:?}");
}

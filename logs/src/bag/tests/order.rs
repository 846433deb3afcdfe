//! Messages that are sorted by topic in their files.

use super::builder::*;
use crate::summary::TopicChoice;
use mcap::WriteOptions;

const NOTE: &str = "the messages are sorted by topic: they are read in the order of their times of recording";

/// A robot that drives an arc for 5 s.
fn driving() -> Builder {
    let mut bag = Builder::default();
    bag.mount();
    for time_s in times(50, 0.1) {
        bag.odometry("/odom", time_s, time_s, 0.1 * time_s);
        bag.laser(time_s + 0.05);
    }
    bag
}

/// The messages sorted by topic, in this order.
fn by_topic(bag: &Builder, topics: [&str; 3]) -> Builder {
    let mut sorted = bag.clone();
    sorted.messages.sort_by_key(|(topic, ..)| topics.iter().position(|name| name == topic));
    sorted
}

#[test]
fn messages_that_are_sorted_by_topic_are_read_in_the_order_of_their_times() {
    let bag = driving();
    let expected = readings(&bag.log());
    for topics in [["/tf_static", "/scan", "/odom"], ["/odom", "/scan", "/tf_static"]] {
        let sorted = by_topic(&bag, topics);
        let chunked = sorted.mcap(plain().chunk_size(Some(500)));
        for file in [sorted.mcap(plain()), chunked, sorted.mcap(WriteOptions::new()), sorted.sqlite()] {
            let opened = read(&file);
            assert_eq!(opened.summary().notes, [NOTE]);
            assert_eq!(readings(&opened), expected);
            assert_eq!(readings(&opened), expected, "read again");
        }
    }
}

#[test]
fn a_bag_may_have_a_file_per_topic() {
    let (bag, folder) = (driving(), tempfile::tempdir().unwrap());
    for (number, topic) in ["/scan", "/odom", "/tf_static"].iter().enumerate() {
        let mut part = bag.clone();
        part.messages.retain(|(of, ..)| of == topic);
        std::fs::write(folder.path().join(format!("bag_{number}.mcap")), part.mcap(plain())).unwrap();
    }
    let opened = crate::Log::open(folder.path(), &TopicChoice::default()).unwrap();
    assert_eq!(opened.summary().notes[1..], [NOTE]);
    assert_eq!(readings(&opened), readings(&bag.log()));
}

/// The messages after the clock was set back are later ones.
#[test]
fn the_order_of_the_file_counts_where_the_clock_of_the_recorder_is_set_back() {
    let mut bag = driving();
    let expected = readings(&bag.log());
    let half = bag.messages.len() / 2;
    bag.messages[half..].iter_mut().for_each(|(_, _, log_ns, _)| *log_ns -= 3_600_000_000_000);
    let opened = bag.log();
    assert!(!opened.summary().notes.iter().any(|note| note == NOTE), "{:?}", opened.summary().notes);
    assert_eq!(readings(&opened), expected);
    // Recorders repeat static transforms at the begin of each file, with their old times.
    let mut bag = driving();
    let repeated = bag.messages[0].clone();
    bag.messages.insert(half, repeated);
    let opened = bag.log();
    assert!(opened.summary().notes.is_empty());
    assert_eq!(readings(&opened), expected);
}

#[test]
fn only_some_topics_are_merged() {
    let mut bag = Builder::default();
    for laser in 0..17 {
        for time_s in times(12, 1.0) {
            bag.scan(&format!("/scan{laser}"), time_s, &scan(time_s, &format!("laser{laser}")));
        }
    }
    let edges: Vec<_> = (0..17).map(|laser| still("base_link", &format!("laser{laser}"))).collect();
    bag.tf("/tf_static", 0.0, &edges);
    let error = bag.refused();
    assert!(error.starts_with("test: the messages are sorted by topic, and 18 topics are needed"), "{error}");
    let choice = TopicChoice { scan_topics: vec!["scan3".to_owned()], ..TopicChoice::default() };
    assert_eq!(bag.open(&choice).unwrap().summary().scans, 12);
}

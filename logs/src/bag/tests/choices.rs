use super::builder::*;
use crate::summary::TopicChoice;

#[test]
fn two_topics_of_odometry_are_a_choice() {
    let mut bag = Builder::default();
    bag.mount().laser(0.0);
    for time_s in times(3, 1.0) {
        bag.odometry("/odom", time_s, time_s, 0.0).odometry("/filtered", time_s, 2.0 * time_s, 0.0);
    }
    bag.laser(1.0);
    insta::assert_snapshot!(bag.refused(), @"test: several topics of odometry: /filtered, /odom; choose one with --odom-topic (other choices: --scan-topic, --base-frame)");
    let by = |topic: &str| TopicChoice { odom_topic: Some(topic.to_owned()), ..TopicChoice::default() };
    assert_eq!(readings(&bag.open(&by("filtered")).unwrap())[1].pose.translation.x, 2.0);
    insta::assert_snapshot!(bag.open(&by("/wheel")).unwrap_err(), @"test: no odometry on the topic `/wheel` of --odom-topic; there is /filtered, /odom");
}

#[test]
fn topics_of_one_frame_are_one_laser() {
    let mut bag = Builder::default();
    for time_s in times(2, 1.0) {
        bag.scan("/scan_filtered", time_s, &scan(time_s, "laser"));
        bag.laser(time_s);
    }
    let opened = bag.log();
    assert_eq!(opened.summary().scan_topics, ["/scan_filtered"]);
    insta::assert_snapshot!(notes(&opened), @"/scan_filtered and /scan are of one laser (`laser`): /scan_filtered is used, --scan-topic names another");
    let of = |topic: &str| TopicChoice { scan_topics: vec![topic.to_owned()], ..TopicChoice::default() };
    assert_eq!(bag.open(&of("scan")).unwrap().summary().scan_topics, ["/scan"]);
    // A filter that was switched on late has too few scans.
    for time_s in 2..6 {
        bag.laser(f64::from(time_s));
    }
    assert_eq!(bag.log().summary().scan_topics, ["/scan"]);
    insta::assert_snapshot!(bag.open(&of("/front")).unwrap_err(), @"test: no scans on the topic `/front` of --scan-topic; there are /scan, /scan_filtered");
}

#[test]
fn a_laser_that_is_not_connected_is_refused_or_left_out() {
    let mut bag = Builder::default();
    bag.odometry("/odom", 0.0, 0.0, 0.0).laser(0.0);
    insta::assert_snapshot!(bag.refused(), @"test: the laser `laser` of /scan is not connected to the robot `base_link`: the bag has no transforms (tf) (--base-frame names the frame of the robot; the laser itself can be it)");
    let choice = TopicChoice { base_frame: Some("laser".to_owned()), ..TopicChoice::default() };
    insta::assert_snapshot!(notes(&bag.open(&choice).unwrap()), @"no transform connects `base_link`, whose poses are known, with `laser`: they count as one frame");
    // Over the frames of the world, everything is connected.
    bag.tf("/tf", 0.0, &[still("odom", "base_link"), still("odom", "laser")]);
    let error = bag.refused();
    assert!(error.contains("by transforms; the frames are base_link, laser, odom (--base-frame"), "{error}");
    bag.tf("/tf_static", 0.0, &[still("base_link", "rear")]).scan("/rear", 0.1, &scan(0.1, "rear"));
    let opened = bag.log();
    assert_eq!(opened.summary().scan_topics, ["/rear"]);
    assert!(opened.summary().notes[0].ends_with(": left out"), "{:?}", opened.summary().notes);
}

#[test]
fn the_frame_of_the_odometry_may_be_unnamed() {
    let mut bag = Builder::default();
    bag.mount().odometry("/odom", 0.0, 0.0, 0.0).laser(0.0);
    let mut odometry: ros::Odometry = ros::cdr::decoded(&bag.messages[1].3).unwrap();
    odometry.child_frame_id.clear();
    bag.messages[1].3 = ros::cdr::encoded(&odometry).unwrap();
    let opened = bag.log();
    assert_eq!(opened.summary().notes.len(), 0);
    assert_eq!(readings(&opened)[0].mount.translation.x, 0.2);
}

#[test]
fn frames_in_a_cycle_and_tilted_lasers_are_refused() {
    let mut bag = Builder::default();
    bag.odometry("/odom", 0.0, 0.0, 0.0).laser(0.0);
    let tilted = ros::Rotation { x: 0.0, y: 0.5, z: 0.0, w: 0.75_f64.sqrt() };
    let tilted = ros::Pose { orientation: tilted, ..pose(0.0, 0.0, 0.0) };
    let mut looking_down = bag.clone();
    looking_down.tf("/tf_static", 0.0, &[transform(0.0, "base_link", "laser", tilted)]);
    let error = looking_down.refused();
    assert_has(&error, &["the laser `laser` of /scan is tilted by 60° and does not scan a plane"]);
    bag.tf("/tf_static", 0.0, &[still("a", "laser"), still("laser", "a")]);
    insta::assert_snapshot!(bag.refused(), @"test: the frames form a cycle: laser is above itself");
}

#[test]
fn what_is_there_instead_of_scans_is_said() {
    let mut bag = Builder::default();
    bag.mount();
    insta::assert_snapshot!(bag.refused(), @"test: no message of sensor_msgs/msg/LaserScan, encoded as cdr, which is what is read; there are tf2_msgs/msg/TFMessage");
    let mut points = bag.clone();
    points.messages.push(("/velodyne_points".into(), "sensor_msgs/msg/PointCloud2".into(), 0, Vec::new()));
    insta::assert_snapshot!(points.refused(), @"test: no scan of a plane (sensor_msgs/msg/LaserScan), but points in 3D (sensor_msgs/msg/PointCloud2 on /velodyne_points), which are not read: play the bag through `ros2 run pointcloud_to_laserscan pointcloud_to_laserscan_node --ros-args -r cloud_in:=/velodyne_points -p target_frame:=base_link -p min_height:=0.1 -p max_height:=0.5`, and record /scan, /tf, /tf_static and the odometry (`ros2 bag record`)");
    let mut echoes = bag.clone();
    echoes.messages.push(("/echoes".into(), "sensor_msgs/msg/MultiEchoLaserScan".into(), 0, Vec::new()));
    let error = echoes.refused();
    assert!(error.contains("(sensor_msgs/msg/MultiEchoLaserScan on /echoes)"), "{error}");
    bag.laser(0.0);
    bag.encoding = Some("ros1".to_owned());
    insta::assert_snapshot!(bag.refused(), @"test: the scans are not encoded as cdr, which is what is read; there are ros1, tf2_msgs/msg/TFMessage");
    insta::assert_snapshot!(Builder::default().refused(), @"test: no message: the bag is empty");
}

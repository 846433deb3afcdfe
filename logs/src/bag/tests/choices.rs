use super::builder::*;
use crate::choice::TopicChoice;

#[test]
fn two_topics_of_odometry_are_a_choice() {
    let mut bag = Builder::default();
    bag.mount().scan("/scan", 0.0, &scan(0.0, "laser"));
    for step in 0..3 {
        let time_s = f64::from(step);
        bag.odometry("/odom", time_s, time_s, 0.0).odometry("/filtered", time_s, 2.0 * time_s, 0.0);
    }
    bag.scan("/scan", 1.0, &scan(1.0, "laser"));
    assert_eq!(
        bag.refused(),
        "test: several topics of odometry: /filtered, /odom; choose one with --odom-topic (other choices: --scan-topic, \
         --base-frame)"
    );
    let choice = TopicChoice { odom_topic: Some("filtered".to_owned()), ..TopicChoice::default() };
    assert_eq!(readings(&bag.open(&choice).unwrap())[1].pose.translation.x, 2.0);
    let choice = TopicChoice { odom_topic: Some("/wheel".to_owned()), ..TopicChoice::default() };
    let error = bag.open(&choice).unwrap_err().to_string();
    assert_eq!(error, "test: no odometry on the topic `/wheel` of --odom-topic; there is /filtered, /odom");
}

#[test]
fn topics_of_one_frame_are_one_laser() {
    let mut bag = Builder::default();
    for step in 0..2 {
        let time_s = f64::from(step);
        bag.scan("/scan_filtered", time_s, &scan(time_s, "laser"));
        bag.scan("/scan", time_s, &scan(time_s, "laser"));
    }
    let opened = bag.open(&TopicChoice::default()).unwrap();
    assert_eq!(opened.summary().scan_topics, ["/scan"]);
    let note =
        "/scan and /scan_filtered are of one laser (`laser`): /scan is used, --scan-topic names another";
    assert_eq!(opened.summary().notes, [note]);
    let choice = TopicChoice { scan_topics: vec!["scan_filtered".to_owned()], ..TopicChoice::default() };
    assert_eq!(bag.open(&choice).unwrap().summary().scan_topics, ["/scan_filtered"]);
    let choice = TopicChoice { scan_topics: vec!["/front".to_owned()], ..TopicChoice::default() };
    let error = bag.open(&choice).unwrap_err().to_string();
    let expected = "test: no scans on the topic `/front` of --scan-topic; there are /scan, /scan_filtered";
    assert_eq!(error, expected);
}

#[test]
fn a_laser_that_is_not_connected_is_refused_or_left_out() {
    let mut bag = Builder::default();
    bag.odometry("/odom", 0.0, 0.0, 0.0).scan("/scan", 0.0, &scan(0.0, "laser"));
    let none = "test: the laser `laser` of /scan is not connected to the robot `base_link`: the bag has no transforms (tf) \
                (--base-frame names the frame of the robot; the laser itself can be it)";
    assert_eq!(bag.refused(), none);
    let choice = TopicChoice { base_frame: Some("laser".to_owned()), ..TopicChoice::default() };
    let note =
        "no transform connects `base_link`, whose poses are known, with `laser`: they count as one frame";
    assert_eq!(bag.open(&choice).unwrap().summary().notes, [note]);
    // Over the frames of the world, everything is connected.
    let still = |parent: &str, child: &str| transform(0.0, parent, child, pose(0.0, 0.0, 0.0));
    bag.tf("/tf", 0.0, &[still("odom", "base_link"), still("odom", "laser")]);
    let error = bag.refused();
    let expected = "by transforms; the frames are base_link, laser, odom (--base-frame";
    assert!(error.contains(expected), "{error}");
    bag.tf("/tf_static", 0.0, &[still("base_link", "rear")]).scan("/rear", 0.1, &scan(0.1, "rear"));
    let opened = bag.open(&TopicChoice::default()).unwrap();
    assert_eq!(opened.summary().scan_topics, ["/rear"]);
    assert!(opened.summary().notes[0].ends_with(": left out"), "{:?}", opened.summary().notes);
}

#[test]
fn the_frame_of_the_odometry_may_be_unnamed() {
    let mut bag = Builder::default();
    bag.mount().odometry("/odom", 0.0, 0.0, 0.0).scan("/scan", 0.0, &scan(0.0, "laser"));
    let mut odometry: ros::Odometry = ros::cdr::decoded(&bag.messages[1].3).unwrap();
    odometry.child_frame_id.clear();
    bag.messages[1].3 = ros::cdr::encoded(&odometry).unwrap();
    let opened = bag.open(&TopicChoice::default()).unwrap();
    assert_eq!(opened.summary().notes.len(), 0);
    assert_eq!(readings(&opened)[0].mount.translation.x, 0.2);
}

#[test]
fn frames_in_a_cycle_and_tilted_lasers_are_refused() {
    let mut bag = Builder::default();
    bag.odometry("/odom", 0.0, 0.0, 0.0).scan("/scan", 0.0, &scan(0.0, "laser"));
    let tilted = ros::Rotation { x: 0.0, y: 0.5, z: 0.0, w: 0.75_f64.sqrt() };
    let tilted = ros::Pose { orientation: tilted, ..pose(0.0, 0.0, 0.0) };
    let mut looking_down = bag.clone();
    looking_down.tf("/tf_static", 0.0, &[transform(0.0, "base_link", "laser", tilted)]);
    let error = looking_down.refused();
    assert!(
        error.contains("the laser `laser` of /scan is tilted by 60° and does not scan a plane"),
        "{error}"
    );
    let still = |parent: &str, child: &str| transform(0.0, parent, child, pose(0.0, 0.0, 0.0));
    bag.tf("/tf_static", 0.0, &[still("a", "laser"), still("laser", "a")]);
    assert_eq!(bag.refused(), "test: the frames form a cycle: laser is above itself");
}

#[test]
fn what_is_there_instead_of_scans_is_said() {
    let mut bag = Builder::default();
    bag.mount();
    assert_eq!(
        bag.refused(),
        "test: no message of sensor_msgs/msg/LaserScan; there are tf2_msgs/msg/TFMessage"
    );
    let mut points = bag.clone();
    points.messages.push(("/velodyne_points".into(), "sensor_msgs/msg/PointCloud2".into(), 0, Vec::new()));
    let expected = "test: no scan of a plane (sensor_msgs/msg/LaserScan), but points in 3D (sensor_msgs/msg/PointCloud2 on \
                    /velodyne_points), which are not read: play the bag through `ros2 run pointcloud_to_laserscan \
                    pointcloud_to_laserscan_node --ros-args -r cloud_in:=/velodyne_points -p target_frame:=base_link -p \
                    min_height:=0.1 -p max_height:=0.5`, and record /scan, /tf, /tf_static and the odometry (`ros2 bag record`)";
    assert_eq!(points.refused(), expected);
    let mut echoes = bag.clone();
    echoes.messages.push(("/echoes".into(), "sensor_msgs/msg/MultiEchoLaserScan".into(), 0, Vec::new()));
    assert!(
        echoes.refused().contains("(sensor_msgs/msg/MultiEchoLaserScan on /echoes)"),
        "{}",
        echoes.refused()
    );
    bag.scan("/scan", 0.0, &scan(0.0, "laser"));
    bag.encoding = Some("ros1".to_owned());
    let expected = "test: the scans are not encoded as cdr, which is what is read; there are ros1, \
                    tf2_msgs/msg/TFMessage";
    assert_eq!(bag.refused(), expected);
    assert_eq!(Builder::default().refused(), "test: no message: the bag is empty");
}

//! The definitions of the messages that we write, as text in ROS's own language (`ros2msg`).

/// The types by name, and the fields of each (<https://github.com/ros2/common_interfaces>, `geometry2`,
/// `navigation_msgs`).
const TYPES: [(&str, &str); 20] = [
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"),
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"),
    ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"),
    ("geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"),
    ("geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"),
    ("geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"),
    ("geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"),
    (
        "geometry_msgs/TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
    ),
    ("tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"),
    (
        "sensor_msgs/LaserScan",
        "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n\
         float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n\
         float32[] intensities\n",
    ),
    (
        "nav_msgs/Odometry",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
         geometry_msgs/TwistWithCovariance twist\n",
    ),
    (
        "nav_msgs/MapMetaData",
        "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n\
         geometry_msgs/Pose origin\n",
    ),
    ("nav_msgs/OccupancyGrid", "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n"),
    ("nav_msgs/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"),
    (
        "sensor_msgs/PointField",
        "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n\
         uint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n",
    ),
    (
        "sensor_msgs/PointCloud2",
        "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n\
         bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
    ),
];

/// The definition of a type, followed by those of all types in it.
pub(super) fn definition(name: &str) -> String {
    let rule = "=".repeat(80);
    let mut text = String::new();
    let mut needed = vec![name];
    let mut next = 0;
    while let Some(name) = needed.get(next).copied() {
        next += 1;
        let Some((_, fields)) = TYPES.iter().find(|(known, _)| *known == name) else { continue };
        if next > 1 {
            text += &format!("{rule}\nMSG: {name}\n");
        }
        text += fields;
        for field in fields.lines() {
            let part = field.split([' ', '[']).next().unwrap_or_default();
            if part.contains('/') && !needed.contains(&part) {
                needed.push(part);
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_definition_contains_all_its_types_once() {
        let path = definition("nav_msgs/Path");
        let parts: Vec<&str> = path.lines().filter_map(|line| line.strip_prefix("MSG: ")).collect();
        let expected = [
            "std_msgs/Header",
            "geometry_msgs/PoseStamped",
            "builtin_interfaces/Time",
            "geometry_msgs/Pose",
            "geometry_msgs/Point",
            "geometry_msgs/Quaternion",
        ];
        assert_eq!(parts, expected);
        assert!(path.starts_with("std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n====="));
        for (_, fields) in TYPES {
            let parts = fields.lines().filter_map(|field| field.split([' ', '[']).next());
            for part in parts.filter(|part| part.contains('/')) {
                assert!(TYPES.iter().any(|(known, _)| *known == part), "{part} is missing");
            }
        }
    }
}

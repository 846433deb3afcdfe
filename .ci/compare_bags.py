"""The test of .ci/rosbags: bags that rosbags writes are read by us, and every reading is compared; a bag that we write is
read by rosbags, every message of it.

    python compare_bags.py FOLDER PRINT_LOG MCAP_SAMPLE
"""

import math
import random
import subprocess
import sys
from pathlib import Path

import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_JAZZY)
TYPES = STORE.types
BEGIN_NS = 1_700_000_000_123_456_789
RANGE_MIN_M, RANGE_MAX_M = np.float32(0.05), np.float32(12.0)


def make(name, *fields):
    return TYPES[name](*fields)


def header(time_ns, frame):
    stamp = make("builtin_interfaces/msg/Time", time_ns // 10**9, time_ns % 10**9)
    return make("std_msgs/msg/Header", stamp, frame)


def vector(x, y, z=0.0, kind="Vector3"):
    return make(f"geometry_msgs/msg/{kind}", x, y, z)


def about_z(heading_rad):
    return make("geometry_msgs/msg/Quaternion", 0.0, 0.0, math.sin(heading_rad / 2), math.cos(heading_rad / 2))


def transform(time_ns, parent, child, x, y, heading_rad):
    moved = make("geometry_msgs/msg/Transform", vector(x, y), about_z(heading_rad))
    stamped = make("geometry_msgs/msg/TransformStamped", header(time_ns, parent), child, moved)
    return make("tf2_msgs/msg/TFMessage", [stamped])


def odometry(time_ns, x, y, heading_rad):
    pose = make("geometry_msgs/msg/Pose", vector(x, y, kind="Point"), about_z(heading_rad))
    twist = make("geometry_msgs/msg/Twist", vector(0.5, 0.0), vector(0.0, 0.0, 0.1))
    covariance = np.zeros(36)
    return make(
        "nav_msgs/msg/Odometry",
        header(time_ns, "odom"),
        "base_footprint",
        make("geometry_msgs/msg/PoseWithCovariance", pose, covariance),
        make("geometry_msgs/msg/TwistWithCovariance", twist, covariance),
    )


def scan(chance, time_ns, frame, beams, sweep):
    ranges = np.array([chance.uniform(-0.5, 14.0) for _ in range(beams)], dtype=np.float32)
    ranges[chance.randrange(beams)] = np.float32(chance.choice([math.inf, math.nan, 0.0]))
    increment = np.float32(2 * math.pi / 720)
    start = np.float32(-1.0)
    return make(
        "sensor_msgs/msg/LaserScan",
        header(time_ns, frame),
        start,
        start + increment * np.float32(beams - 1),
        increment,
        np.float32(sweep / (beams - 1)),
        np.float32(0.1),
        RANGE_MIN_M,
        RANGE_MAX_M,
        ranges,
        np.zeros(beams, dtype=np.float32),
    )


def drive(time_ns):
    """The pose by odometry."""
    time_s = time_ns * 1e-9
    return 3.0 + 0.5 * time_s, 1.0 + 0.2 * math.sin(time_s), 0.3 * math.sin(0.5 * time_s)


def messages(chance, has_odometry):
    """Messages in the order of their recording: topic, time, message. Two lasers, other topics between."""
    yield "/tf_static", 0, transform(BEGIN_NS, "base_footprint", "base_link", 0.0, 0.0, 0.0)
    yield "/tf_static", 1, transform(BEGIN_NS, "base_link", "front_laser", 0.3, 0.1, 0.2)
    yield "/tf_static", 2, transform(BEGIN_NS, "base_link", "rear_laser", -0.3, 0.0, math.pi)
    timed = []
    for step in range(150):
        time_ns = step * 20_000_000
        x, y, heading_rad = drive(time_ns)
        if has_odometry:
            timed.append((time_ns, "/odom", odometry(BEGIN_NS + time_ns, x, y, heading_rad)))
        timed.append((time_ns + 1, "/tf", transform(BEGIN_NS + time_ns, "odom", "base_footprint", x, y, heading_rad)))
        timed.append((time_ns + 2, "/tf", transform(BEGIN_NS + time_ns, "map", "odom", 0.1 * step, 0.0, 0.0)))
        timed.append((time_ns + 3, "/chatter", make("std_msgs/msg/String", "a message of another type " * 20)))
    for step in range(1, 28):
        for topic, frame, delay_ns in [("/front/scan", "front_laser", 30_000_000), ("/rear/scan", "rear_laser", 75_000_000)]:
            time_ns = step * 100_000_000 + delay_ns
            beams, sweep = chance.choice([(181, 0.0), (240, 0.04)])
            timed.append((time_ns + 50_000_000, topic, scan(chance, BEGIN_NS + time_ns, frame, beams, sweep)))
    for time_ns, topic, message in sorted(timed, key=lambda entry: entry[0]):
        yield topic, 10 + time_ns, message


def put(writer, entries, little_endian):
    connections = {}
    for topic, time_ns, message in entries:
        kind = message.__msgtype__
        if topic not in connections:
            connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
        data = STORE.serialize_cdr(message, kind, little_endian=little_endian)
        writer.write(connections[topic], BEGIN_NS + time_ns, data)


def write_bag(folder, entries, storage, mode, little_endian):
    writer = Writer(folder, version=9, storage_plugin=storage)
    if mode != CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        put(writer, entries, little_endian)


def interpolated(time_s):
    """The pose between the two poses of the odometry around a time, relative to the first."""
    period_s = 0.02
    before = int(math.floor(time_s / period_s + 1e-9))
    share = time_s / period_s - before
    a, b = drive(before * 20_000_000), drive((before + 1) * 20_000_000)
    x, y, heading_rad = (p + (q - p) * share for p, q in zip(a, b))
    x0, y0, heading0 = drive(0)
    dx, dy = x - x0, y - y0
    return (
        math.cos(heading0) * dx + math.sin(heading0) * dy,
        -math.sin(heading0) * dx + math.cos(heading0) * dy,
        heading_rad - heading0,
    )


def expected_readings(entries):
    """What a reader should make of the scans, sorted by the time of the last beam."""
    found = []
    for topic, _, message in entries:
        if not topic.endswith("/scan"):
            continue
        stamp = message.header.stamp
        begin_ns = stamp.sec * 10**9 + stamp.nanosec - BEGIN_NS
        sweep_s = float(message.time_increment) * (len(message.ranges) - 1)
        ranges = message.ranges.copy()
        with np.errstate(invalid="ignore"):
            ranges[np.isfinite(ranges) & ((message.ranges < RANGE_MIN_M) | (message.ranges <= 0))] = np.nan
            ranges[message.ranges > RANGE_MAX_M] = np.inf
        mount = (0.3, 0.1, 0.2) if topic.startswith("/front") else (-0.3, 0.0, math.pi)
        found.append((begin_ns * 1e-9 + sweep_s, sweep_s, message, ranges, mount))
    return sorted(found, key=lambda reading: reading[0])


def near(found, expected, tolerance, what):
    difference = abs(found - expected)
    if what == "heading":
        difference = abs(math.remainder(found - expected, math.tau))
    assert difference <= tolerance, f"{what}: {found} instead of {expected}"


def compare(line, expected, begin_s, moves):
    words = line.split()
    numbers = [float(word) for word in words[:13]]
    time_s, sweep_s, message, ranges, mount = expected
    near(numbers[0], time_s - begin_s, 1e-9, "time")
    pose = interpolated(time_s) if moves else (0.0, 0.0, 0.0)
    for value, other, what in zip(numbers[1:7], pose + mount, ["x", "y", "heading"] * 2):
        near(value, other, 1e-6, what)
    near(numbers[9], float(message.angle_min), 1e-9, "first angle")
    near(numbers[10], float(message.angle_increment), 1e-9, "angle between beams")
    near(numbers[11], sweep_s, 1e-9, "duration")
    found = np.array(words[13:], dtype=np.float32)
    assert np.array_equal(found, ranges, equal_nan=True), "the ranges differ"


def check(folder, entries, print_log, moves):
    printed = subprocess.run([print_log, folder, "readings"], capture_output=True, text=True)
    assert printed.returncode == 0, printed.stderr
    lines, expected = printed.stdout.splitlines(), expected_readings(entries)
    assert len(lines) == len(expected), f"{len(lines)} readings instead of {len(expected)}"
    for line, reading in zip(lines, expected):
        compare(line, reading, expected[0][0], moves)
    return len(lines)


def check_ours(file, print_log):
    """Reads every message of a bag that we wrote, and compares scans and odometry with what we read from it."""
    found, counts = [], {}
    with AnyReader([file]) as reader:
        for connection, time_ns, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            counts[connection.topic] = counts.get(connection.topic, 0) + 1
            if connection.topic in ("/scan", "/odom"):
                found.append((connection.topic, time_ns, message))
            if connection.topic == "/map":
                assert len(message.data) == message.info.width * message.info.height, "the map has another size"
            if connection.topic == "/changes":
                assert len(message.data) == message.width * message.point_step, "the point cloud has another size"
    topics = ["/changes", "/goal_pose", "/map", "/odom", "/plan", "/scan", "/tf", "/tf_static"]
    assert sorted(counts) == topics, f"the topics are {sorted(counts)}"
    printed = subprocess.run([print_log, file, "readings"], capture_output=True, text=True)
    assert printed.returncode == 0, printed.stderr
    scans = [message for topic, _, message in found if topic == "/scan"]
    poses = [message.pose.pose for topic, _, message in found if topic == "/odom"]
    lines = printed.stdout.splitlines()
    assert len(lines) == len(scans) == len(poses), "the number of scans differs"
    for line, scan_message, pose in zip(lines, scans, poses):
        words = line.split()
        near(float(words[1]), pose.position.x - poses[0].position.x, 1e-9, "x")
        near(float(words[2]), pose.position.y - poses[0].position.y, 1e-9, "y")
        near(float(words[3]), 2 * math.atan2(pose.orientation.z, pose.orientation.w), 1e-9, "heading")
        assert np.array_equal(np.array(words[13:], dtype=np.float32), scan_message.ranges), "the ranges differ"
    return sum(counts.values())


def main():
    work, print_log, mcap_sample = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    modes = [CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE]
    storages = [StoragePlugin.MCAP, StoragePlugin.SQLITE3]
    bags, compared = 0, 0
    for storage in storages:
        for mode in modes + [CompressionMode.STORAGE] * (storage == StoragePlugin.MCAP):
            for little_endian in [True, False]:
                for has_odometry in [True, False]:
                    chance = random.Random(bags)
                    entries = list(messages(chance, has_odometry))
                    folder = work / f"{storage.name}-{mode.name}-{little_endian}-{has_odometry}".lower()
                    write_bag(folder, entries, storage, mode, little_endian)
                    try:
                        compared += check(folder, entries, print_log, True)
                    except AssertionError as error:
                        sys.exit(f"FAILED: {folder.name}: {error}")
                    bags += 1
    print(f"{bags} bags that rosbags wrote: {compared} readings, all the same")
    sample = work / "sample.mcap"
    subprocess.run([mcap_sample, sample], check=True)
    try:
        print(f"a bag that we wrote: rosbags reads all {check_ours(sample, print_log)} messages")
    except AssertionError as error:
        sys.exit(f"FAILED: {sample.name}: {error}")


if __name__ == "__main__":
    main()

"""CycloneDDS as another vendor, with messages written down by hand: what the packages of rclpy lack (tf, parts of maps,
paths), and a stand-in for Nav2's action server.

Arguments: a folder for files, the program curious_node, the program sim_node; `hear`: prints when transforms come.
"""

import os
import signal
import subprocess
import sys
import time

DOMAIN = int(os.environ.get("DRIVE_ROS2_DOMAIN", 100 + os.getpid() % 90))
os.environ["ROS_DOMAIN_ID"] = str(DOMAIN)
os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["CYCLONEDDS_URI"] = ("<CycloneDDS><Domain><General><Interfaces><NetworkInterface name='lo'/></Interfaces>"
  "<AllowMulticast>false</AllowMulticast></General><Discovery><Peers><Peer address='127.0.0.1'/></Peers>"
  "<ParticipantIndex>auto</ParticipantIndex></Discovery></Domain></CycloneDDS>")

from dataclasses import dataclass
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float32, float64, int8, int32, int64, sequence, uint8, uint16, uint32, uint64
from cyclonedds.domain import DomainParticipant
from cyclonedds.topic import Topic
from cyclonedds.sub import DataReader
from cyclonedds.pub import DataWriter
from cyclonedds.core import Qos, Policy
from cyclonedds.util import duration



@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Pose(IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
    position: Vector3
    orientation: Quaternion


@dataclass
class PoseStamped(IdlStruct, typename="geometry_msgs::msg::dds_::PoseStamped_"):
    header: Header
    pose: Pose


@dataclass
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    translation: Vector3
    rotation: Quaternion


@dataclass
class TransformStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
class TFMessage(IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    transforms: sequence[TransformStamped]


@dataclass
class OccupancyGridUpdate(IdlStruct, typename="map_msgs::msg::dds_::OccupancyGridUpdate_"):
    header: Header
    x: int32
    y: int32
    width: uint32
    height: uint32
    data: sequence[int8]


@dataclass
class Path(IdlStruct, typename="nav_msgs::msg::dds_::Path_"):
    header: Header
    poses: sequence[PoseStamped]


@dataclass
class SendGoalRequest(IdlStruct, typename="nav2_msgs::action::dds_::NavigateToPose_SendGoal_Request_"):
    guid: uint64
    seq: int64
    goal_id: array[uint8, 16]
    pose: PoseStamped
    behavior_tree: str


@dataclass
class SendGoalResponse(IdlStruct, typename="nav2_msgs::action::dds_::NavigateToPose_SendGoal_Response_"):
    guid: uint64
    seq: int64
    accepted: bool
    stamp: Time


@dataclass
class GetResultRequest(IdlStruct, typename="nav2_msgs::action::dds_::NavigateToPose_GetResult_Request_"):
    guid: uint64
    seq: int64
    goal_id: array[uint8, 16]


@dataclass
class GetResultResponse(IdlStruct, typename="nav2_msgs::action::dds_::NavigateToPose_GetResult_Response_"):
    guid: uint64
    seq: int64
    status: int8
    error_code: uint16
    error_msg: str


@dataclass
class MapMetaData(IdlStruct, typename="nav_msgs::msg::dds_::MapMetaData_"):
    map_load_time: Time
    resolution: float32
    width: uint32
    height: uint32
    origin: Pose


@dataclass
class OccupancyGrid(IdlStruct, typename="nav_msgs::msg::dds_::OccupancyGrid_"):
    header: Header
    info: MapMetaData
    data: sequence[int8]


@dataclass
class CostmapFilterInfo(IdlStruct, typename="nav2_msgs::msg::dds_::CostmapFilterInfo_"):
    header: Header
    type: uint8
    filter_mask_topic: str
    base: float32
    multiplier: float32


@dataclass
class PoseWithCovariance(IdlStruct, typename="geometry_msgs::msg::dds_::PoseWithCovariance_"):
    pose: Pose
    covariance: array[float64, 36]


@dataclass
class PoseWithCovarianceStamped(IdlStruct, typename="geometry_msgs::msg::dds_::PoseWithCovarianceStamped_"):
    header: Header
    pose: PoseWithCovariance


@dataclass
class KeyValue(IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    key: str
    value: str


@dataclass
class DiagnosticStatus(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    level: uint8
    name: str
    message: str
    hardware_id: str
    values: sequence[KeyValue]


@dataclass
class DiagnosticArray(IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    header: Header
    status: sequence[DiagnosticStatus]


@dataclass
class EdgeCost(IdlStruct, typename="nav2_msgs::msg::dds_::EdgeCost_"):
    edgeid: uint16
    cost: float32


@dataclass
class EdgesRequest(IdlStruct, typename="nav2_msgs::srv::dds_::DynamicEdges_Request_"):
    guid: uint64
    seq: int64
    closed_edges: sequence[uint16]
    opened_edges: sequence[uint16]
    adjust_edges: sequence[EdgeCost]


@dataclass
class EdgesResponse(IdlStruct, typename="nav2_msgs::srv::dds_::DynamicEdges_Response_"):
    guid: uint64
    seq: int64
    success: bool


@dataclass
class SaveMapRequest(IdlStruct, typename="slam_toolbox::srv::dds_::SaveMap_Request_"):
    guid: uint64
    seq: int64
    name: str


@dataclass
class CodeResponse(IdlStruct, typename="slam_toolbox::srv::dds_::SaveMap_Response_"):
    guid: uint64
    seq: int64
    result: uint8


LATCHED = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.TransientLocal, Policy.History.KeepLast(1))
RELIABLE = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(100))
WORK, CURIOUS, SIM = sys.argv[1:4]
LOG = os.path.join(WORK, "cyclonedds.log")
participant = DomainParticipant(DOMAIN)


def reader(name, kind, qos=RELIABLE):
    return DataReader(participant, Topic(participant, name, kind), qos=qos)


def writer(name, kind):
    return DataWriter(participant, Topic(participant, name, kind), qos=RELIABLE)


def check(name, is_right, found=""):
    print(f"{'ok  ' if is_right else 'FAIL'} CycloneDDS: {name}{f': {found}' if found != '' else ''}", flush=True)
    if not is_right:
        print(open(LOG).read(), flush=True)
        sys.exit(1)


def explore(*settings):
    """Starts the node, whose services are those of CycloneDDS."""
    environment = {**os.environ, "RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp"}
    command = [CURIOUS, "--mode", "explore", "--ros-args", "-p", "robot_radius:=0.2", *settings]
    return subprocess.Popen(command, env=environment, stderr=open(LOG, "w"))


def spin(seconds, turn, until):
    end = time.monotonic() + seconds
    while time.monotonic() < end and not until():
        turn()
        time.sleep(0.02)
    return until()


def end(node):
    node.send_signal(signal.SIGINT)
    check("the node ends", node.wait(20) == 0)


def test_messages():
    readers = {
        "tf": reader("rt/tf", TFMessage),
        "updates": reader("rt/map_updates", OccupancyGridUpdate),
        "path": reader("rt/explore/path", Path),
    }
    node = explore()
    heard = {name: [] for name in readers}

    def turn():
        for name, messages in heard.items():
            messages += readers[name].take(100)

    def transforms():
        return {(t.header.frame_id, t.child_frame_id): t for m in heard["tf"] for t in m.transforms}

    def is_complete():
        return {("map", "odom"), ("odom", "base_link")} <= set(transforms()) and heard["updates"] and heard["path"]

    check("tf, map_updates and paths come", spin(40, turn, is_complete), {n: len(m) for n, m in heard.items()})
    turned = transforms()["map", "odom"].transform.rotation
    check("the rotation is one", abs(turned.z**2 + turned.w**2 - 1) < 1e-9 and turned.x == turned.y == 0)
    is_whole = all(len(u.data) == u.width * u.height and set(u.data) <= {-1, 0, 100} for u in heard["updates"])
    check("every update is a rectangle of three values", is_whole)
    check("every path is in the map", all(m.header.frame_id == "map" for path in heard["path"] for m in [path, *path.poses]))
    end(node)


def test_stack():
    """What Nav2's costmap filters and those who watch a robot read, by their definitions."""
    readers = {
        "speed": reader("rt/fleet/speed_mask", OccupancyGrid, LATCHED),
        "keepout": reader("rt/fleet/keepout_mask", OccupancyGrid, LATCHED),
        "speed info": reader("rt/fleet/speed_filter_info", CostmapFilterInfo, LATCHED),
        "keepout info": reader("rt/fleet/keepout_filter_info", CostmapFilterInfo, LATCHED),
        "pose": reader("rt/fleet/pose", PoseWithCovarianceStamped),
        "diagnostics": reader("rt/diagnostics", DiagnosticArray),
    }
    node = explore("-r", "__ns:=/fleet", "-r", "odom:=/odom", "-r", "cmd_vel:=/cmd_vel", "-p", "mask_update_interval:=1.0")
    heard = {name: [] for name in readers}

    def turn():
        for name, messages in heard.items():
            messages += readers[name].take(100)

    def is_complete():
        said = {status.message for array in heard["diagnostics"] for status in array.status}
        return all(heard.values()) and len(heard["keepout"]) > 1 and "tracking: the pose is certain" in said

    check("masks, poses and diagnostics come", spin(40, turn, is_complete), {n: len(m) for n, m in heard.items()})
    speed, keepout = heard["speed info"][-1], heard["keepout info"][-1]
    check("a filter finds the speed mask", (speed.type, speed.filter_mask_topic) == (1, "/fleet/speed_mask"))
    check("its value is a limit", (speed.base, speed.multiplier) == (100.0, -1.0))
    check("a filter finds the keepout mask", (keepout.type, keepout.filter_mask_topic) == (0, "/fleet/keepout_mask"))
    masks = heard["speed"] + heard["keepout"]
    is_whole = all(len(m.data) == m.info.width * m.info.height and 0 <= min(m.data) <= max(m.data) <= 100 for m in masks)
    check("the masks are maps", is_whole and {m.header.frame_id for m in masks} == {"map"})
    certain = heard["pose"][-1].pose.covariance
    check("the pose has a covariance", all(0 < certain[at] < 0.1 for at in (0, 7, 35)), [certain[at] for at in (0, 7, 35)])
    names = {status.name for array in heard["diagnostics"] for status in array.status}
    check("the parts of the node", names == {"curious_node: localization", "curious_node: scans"}, sorted(names))
    end(node)


GRAPH = """{"type": "FeatureCollection", "features": [
  {"properties": {"id": 0, "frame": "map"}, "geometry": {"type": "Point", "coordinates": [0, 0]}},
  {"properties": {"id": 1, "frame": "map"}, "geometry": {"type": "Point", "coordinates": [0.5, 0]}},
  {"properties": {"id": 2, "startid": 0, "endid": 1}, "geometry": {"type": "MultiLineString"}},
  {"properties": {"id": 3, "startid": 1, "endid": 0}, "geometry": {"type": "MultiLineString"}}]}"""


def test_services():
    """A stand-in for nav2_route, and a client of slam_toolbox's services; a call and its answer, timed."""
    graph = os.path.join(WORK, "graph.geojson")
    with open(graph, "w") as file:
        file.write(GRAPH)
    service = "route_server/DynamicEdgesScorer/adjust_edges"
    requests = reader(f"rq/{service}Request", EdgesRequest)
    answers = writer(f"rr/{service}Reply", EdgesResponse)
    saved = reader("rr/curious_node/save_mapReply", CodeResponse)
    save = writer("rq/curious_node/save_mapRequest", SaveMapRequest)
    expiry = reader("rt/expiry_map", OccupancyGrid, LATCHED)
    settings = [f"route_graph:={graph}", "route_update_interval:=1.0", f"map_folder:={WORK}"]
    node = explore(*(part for setting in settings for part in ("-p", setting)))
    asked, maps, codes = [], [], []

    def turn():
        for request in requests.take(10):
            if getattr(request, "opened_edges", None) is not None:
                asked.append(request)
                # The first requests are not answered.
                if len(asked) > 5:
                    answers.write(EdgesResponse(request.guid, request.seq, True))
        maps.extend(expiry.take(10))
        codes.extend(code for code in saved.take(10) if getattr(code, "guid", 0) == 7)

    check("edges are adjusted again and again", spin(40, turn, lambda: len(asked) > 9), len(asked))
    known = {edge for request in asked for edge in list(request.closed_edges) + list(request.opened_edges)}
    check("they are those of the graph", known <= {2, 3} and known, sorted(known))
    costs = [edge.cost for request in asked for edge in request.adjust_edges]
    check("each has a cost", costs and all(0 <= cost <= 50 for cost in costs), max(costs))
    check("a server without an answer is said once", open(LOG).read().count("does not answer") == 1)
    check("the map of expiry is a map", maps and all(-1 <= min(m.data) <= max(m.data) <= 100 for m in maps), len(maps))
    begin = time.monotonic()
    save.write(SaveMapRequest(7, 1, os.path.join(WORK, "saved")))
    check("a map is saved", spin(10, turn, lambda: codes) and codes[0].result == 0, f"{time.monotonic() - begin:.3f} s")
    check("for the map server", "image: saved.pgm" in open(os.path.join(WORK, "saved.yaml")).read())
    end(node)


def test_action():
    goals = reader("rq/navigate_to_pose/_action/send_goalRequest", SendGoalRequest)
    answers = writer("rr/navigate_to_pose/_action/send_goalReply", SendGoalResponse)
    wanted = reader("rq/navigate_to_pose/_action/get_resultRequest", GetResultRequest)
    results = writer("rr/navigate_to_pose/_action/get_resultReply", GetResultResponse)
    node = explore("-p", "navigator:=nav2")
    asked, given = [], []

    def turn():
        for goal in goals.take(10):
            asked.append(goal)
            # The second goal is refused.
            answers.write(SendGoalResponse(goal.guid, goal.seq, len(asked) != 2, Time(0, 0)))
        for request in wanted.take(10):
            given.append(request)
            # The second goal that was accepted is aborted.
            status = 6 if len(given) == 2 else 4
            results.write(GetResultResponse(request.guid, request.seq, status, 0, ""))

    check("goals come one after the other", spin(40, turn, lambda: len(given) > 4), (len(asked), len(given)))
    check("each accepted goal has one result", len(asked) - len(given) in (1, 2))
    check("goals are in the map", {goal.pose.header.frame_id for goal in asked} == {"map"})
    said = open(LOG).read()
    check("a refused goal is said", said.count("Nav2 has refused the goal") == 1)
    check("an aborted goal is said", said.count("Nav2 has given the goal up") == 1)
    end(node)


def hear():
    """Prints when a transform from the map to the odometry comes, s."""
    transforms = reader("rt/tf", TFMessage)
    while True:
        for message in transforms.take(100):
            found = getattr(message, "transforms", [])  # the end of a publisher has none
            if any((t.header.frame_id, t.child_frame_id) == ("map", "odom") for t in found):
                print(time.monotonic(), flush=True)
        time.sleep(0.001)


def main():
    simulation = subprocess.Popen([SIM, "house"], stderr=subprocess.DEVNULL)
    try:
        test_messages()
        test_stack()
        test_services()
        test_action()
    finally:
        simulation.kill()


if __name__ == "__main__":
    hear() if sys.argv[4:] == ["hear"] else main()

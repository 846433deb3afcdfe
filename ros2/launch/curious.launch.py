"""Starts curious_node, with sim_node as the robot if `world` is given, and rviz2 if `rviz` is true.

    ros2 launch ros2/launch/curious.launch.py state:=office.state
    ros2 launch ros2/launch/curious.launch.py world:=house mode:=explore rviz:=true

The programs are no packages of ROS: `bin` is the folder that has them (`cargo build -p curious-ros2`: target/debug).
"""

import os

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, PythonExpression

HERE = os.path.dirname(os.path.abspath(__file__))
ROS2 = os.path.dirname(HERE)


def generate_launch_description():
    bin_folder = LaunchConfiguration("bin")
    arguments = [
        DeclareLaunchArgument("bin", default_value=os.path.join(os.path.dirname(ROS2), "target", "debug")),
        DeclareLaunchArgument("params", default_value=os.path.join(ROS2, "config", "params.yaml")),
        DeclareLaunchArgument("state", default_value="curious.state", description="what was learned is kept here"),
        DeclareLaunchArgument("mode", default_value="map", choices=["map", "explore"]),
        DeclareLaunchArgument("world", default_value="", description="a simulated world; empty: a real robot"),
        DeclareLaunchArgument("rviz", default_value="false"),
    ]
    simulation = ExecuteProcess(
        cmd=[PathJoinSubstitution([bin_folder, "sim_node"]), LaunchConfiguration("world")],
        condition=IfCondition(PythonExpression(["'", LaunchConfiguration("world"), "' != ''"])),
        output="screen",
    )
    node = ExecuteProcess(
        cmd=[
            PathJoinSubstitution([bin_folder, "curious_node"]),
            "--mode",
            LaunchConfiguration("mode"),
            "--state",
            LaunchConfiguration("state"),
            "--ros-args",
            "--params-file",
            LaunchConfiguration("params"),
        ],
        # The state is saved at the end.
        sigterm_timeout="20",
        output="screen",
    )
    rviz = ExecuteProcess(
        cmd=["rviz2", "-d", os.path.join(ROS2, "config", "curious.rviz")],
        condition=IfCondition(LaunchConfiguration("rviz")),
        output="screen",
    )
    return LaunchDescription([*arguments, simulation, node, rviz])

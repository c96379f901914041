"""Starts stiltd and the monitor, or with simulated:=true the simulated robot, stiltd and the monitor.

    ros2 launch stilt_msgs stilt.launch.py simulated:=true
    ros2 launch stilt_msgs stilt.launch.py config:=/etc/stilt/stiltd.toml interface:=eth0

At Ctrl-C the robot steps, stands and sits down before stiltd ends, so that launch waits for it longer than usual.
"""
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import EnvironmentVariable, LaunchConfiguration

END_S = '30'  # until stiltd has sat the robot down


def generate_launch_description() -> LaunchDescription:
    """What ros2 launch runs."""
    domain, interface = LaunchConfiguration('domain'), LaunchConfiguration('interface')
    simulated = LaunchConfiguration('simulated')
    telemetry = ['--set', ['telemetry.domain=', domain], '--set', ['telemetry.interface=', interface]]
    network = ['--domain', domain, '--interface', interface]
    buses = ['--bus', 'loopback:ros2_left', '--bus', 'loopback:ros2_right']

    def program(words: list, **condition: object) -> ExecuteProcess:
        return ExecuteProcess(cmd=words, output='screen', sigterm_timeout=END_S, sigkill_timeout=END_S, **condition)

    return LaunchDescription([
        DeclareLaunchArgument('domain', default_value=EnvironmentVariable('ROS_DOMAIN_ID', default_value='0'),
                              description='DDS domain'),
        DeclareLaunchArgument('interface', default_value='lo', description='network interface; lo: this computer alone'),
        DeclareLaunchArgument('config', default_value='/etc/stilt/stiltd.toml', description='configuration of stiltd'),
        DeclareLaunchArgument('simulated', default_value='false', description='true: a simulated robot'),
        program(['stilt', 'robot', *buses, '--publish', *network], condition=IfCondition(simulated)),
        program(['stiltd', *buses, *telemetry], condition=IfCondition(simulated)),
        program(['stiltd', '--config', LaunchConfiguration('config'), *telemetry],
                condition=UnlessCondition(simulated)),
        program(['stilt', 'monitor', '--no-browser', *network]),
    ])

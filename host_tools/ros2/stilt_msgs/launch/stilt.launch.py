"""Starts stiltd and the monitor, or with simulated:=true the simulated robot, stiltd and the monitor.

    ros2 launch stilt_msgs stilt.launch.py simulated:=true
    ros2 launch stilt_msgs stilt.launch.py config:=/etc/stilt/stiltd.toml interface:=eth0

At Ctrl-C the robot steps, stands and sits down before stiltd ends, so that launch waits for it longer than usual. The
simulated robot goes on until stiltd has ended.
"""
from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction, RegisterEventHandler
from launch.event_handlers import OnProcessIO
from launch.substitutions import EnvironmentVariable, LaunchConfiguration

END_S = '30'  # until stiltd has sat the robot down
BUSES = ['--bus', 'loopback:ros2_left', '--bus', 'loopback:ros2_right']
READY = b'ready for a controller'  # of the simulated robot, on its standard error
# Keys of telemetry in the configuration, and options of stilt.
NETWORK = {'domain': 'DDS domain', 'interface': 'network interface; lo: this computer alone',
           'peers': 'addresses of other computers, with commas between',
           'security_folder': 'folder of DDS Security documents of the robot'}
MONITOR_SECURITY = 'monitor_security_folder'


def program(*words: str) -> ExecuteProcess:
    return ExecuteProcess(cmd=list(words), output='screen', sigterm_timeout=END_S, sigkill_timeout=END_S)


def options(network: dict[str, str]) -> list[str]:
    """Of stilt; empty values are left out."""
    return [word for name, value in network.items() if value for word in (f'--{name.replace("_", "-")}', value)]


def programs(context: LaunchContext) -> list:
    """What runs with these arguments. One that is not given leaves the configuration of stiltd as it is."""
    values = {name: LaunchConfiguration(name).perform(context)
              for name in ('simulated', 'config', MONITOR_SECURITY, *NETWORK)}
    given = {name: values[name] for name in NETWORK if values[name]}
    settings = [word for name, value in given.items() for word in ('--set', f'telemetry.{name}={value}')]
    monitor = program('stilt', 'monitor', '--no-browser', *options(given | {'security_folder': values[MONITOR_SECURITY]}))
    if values['simulated'].lower() not in ('true', '1'):
        return [program('stiltd', '--config', values['config'], *settings), monitor]
    robot = program('stilt', 'robot', *BUSES, '--publish', *options(given))
    stiltd = program('stiltd', *BUSES, *settings)
    is_ready = OnProcessIO(target_action=robot, on_stderr=lambda event: [stiltd] if READY in event.text else None)
    return [RegisterEventHandler(is_ready), robot, monitor]


def generate_launch_description() -> LaunchDescription:
    """What ros2 launch runs."""
    defaults = {'domain': EnvironmentVariable('ROS_DOMAIN_ID', default_value='')}
    return LaunchDescription([
        *(DeclareLaunchArgument(name, default_value=defaults.get(name, ''), description=description)
          for name, description in NETWORK.items()),
        DeclareLaunchArgument(MONITOR_SECURITY, default_value='', description='the same of the host, for the monitor'),
        DeclareLaunchArgument('config', default_value='/etc/stilt/stiltd.toml', description='configuration of stiltd'),
        DeclareLaunchArgument('simulated', default_value='false', description='true: a simulated robot'),
        OpaqueFunction(function=programs),
    ])

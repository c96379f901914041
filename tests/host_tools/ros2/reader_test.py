#!/usr/bin/python3
"""The ROS 2 package against a running stiltd: a reader in C with the package's types, names, hashes, launch file.

  reader_test.py STILT STILTD ROS2_READER
"""
from __future__ import annotations

import collections
import json
import os
import re
import signal
import subprocess
import sys
import types
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / 'python'))
from programs import PATIENCE_S, Programs

import numpy as np
import stilt
from stilt.mcap import Reader
from stilt.messages import parse_definition

TREE = Path(__file__).resolve().parents[3]
PACKAGE = TREE / 'host_tools/ros2/stilt_msgs'
LOOPBACK = PACKAGE / 'launch/loopback.xml'

# Fields by which samples of both sides are matched.
KEYS = {'ticks': 'first_tick', 'planner': 'cycle', 'plan': 'plan_sequence', 'supervisor': 'tick', 'event': 'number',
        'timing': 'ticks', 'configuration': 'run_id', 'tuning': 'number'}
RELIABLE = {'ticks', 'planner', 'event', 'configuration', 'tuning'}


def same(read, recorded) -> bool:
    """Whether a value of the reader is that of the record."""
    if isinstance(read, list):
        if len(recorded) and isinstance(recorded[0], dict):  # of messages inside one the reader prints their names
            recorded = [one.get('key', one.get('name')) for one in recorded]
        return len(read) == len(recorded) and all(map(same, read, recorded))
    if isinstance(read, float) and np.isnan(read):
        return bool(np.isnan(recorded))
    return read == recorded


class Ros2(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        """A walk, seen by the reader and by stilt record at once."""
        cls.programs = Programs(*PROGRAMS[:2])
        os.environ['CYCLONEDDS_URI'] = f'file://{LOOPBACK}'
        reader = cls.programs.start('reader', 'sh', '-c', f'exec {PROGRAMS[2]} {cls.programs.domain} 2>ready')
        cls.programs.wait_for('ready', 'ready')
        del os.environ['CYCLONEDDS_URI']
        cls.file = cls.programs.folder / 'walk.mcap'
        cls.programs.record(cls.file)
        reader.send_signal(signal.SIGTERM)
        assert reader.wait(PATIENCE_S) == 0, cls.programs.said('ready')
        cls.samples = collections.defaultdict(list)
        for line in cls.programs.said('reader').splitlines():
            sample = json.loads(line)
            cls.samples[sample.pop('topic').removeprefix('rt/stilt/')].append(sample)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.programs.end()

    def recorded(self, topic: str) -> dict:
        """The messages of a topic in the record, by their key."""
        types_of, decoder = None, None
        messages = {}
        for message in Reader(self.file).messages():
            if message.channel.topic != f'/stilt/{topic}':
                continue
            if decoder is None:
                types_of = parse_definition(message.channel.schema.text, message.channel.schema.name)
                decoder = stilt.messages.Decoder(types_of, message.channel.schema.name)
            values = {name.lower(): value for name, value in decoder.decode(message.data).items()}
            messages[values[KEYS[topic]]] = values
        return messages

    def test_what_it_prints_is_what_the_record_holds(self):
        for topic, key in KEYS.items():
            recorded = self.recorded(topic)
            read = {sample[key]: sample for sample in self.samples[topic]}
            both = read.keys() & recorded.keys()
            self.assertGreaterEqual(len(both), (1.0 if topic in RELIABLE else 0.5) * len(recorded), topic)
            for number in both:
                for name, value in read[number].items():
                    self.assertTrue(same(value, recorded[number][name]),
                                    f'{topic} {number} {name}: {value} is not {recorded[number][name]}')
        self.assertGreater(sum(sample['count'] for sample in self.samples['ticks']), 8000)
        self.assertGreater(len(self.samples['ticks'][0]), 12)

    def test_the_simulated_robot_stands_on_its_feet_in_what_it_prints(self):
        forces_N = [sample['contact_force_n'] for sample in self.samples['simulation']]
        self.assertTrue(all(len(force_N) == 4 for force_N in forces_N))
        self.assertGreater(max(force_N[1] + force_N[3] for force_N in forces_N), 100.0)

    def test_topics_have_the_names_and_the_type_hashes_of_ros_2(self):
        hashes = dict(re.findall(r'\{"([\w/]+)", "(RIHS01_\w{64})"\}',
                                 (TREE / 'firmware/telemetry/type_hashes.h').read_text()))
        seen = {one['topic_name']: one for one in self.samples['publication'] if one['topic_name'].startswith('rt/')}
        self.assertEqual(set(seen), {'rt/joint_states', 'rt/odom', 'rt/diagnostics', 'rt/stilt/command_reply',
                                     'rt/stilt/simulation',
                                     *(f'rt/stilt/{topic}' for topic in KEYS)})
        for one in seen.values():
            package, _, _, name = one['type_name'].split('::')
            self.assertEqual(one['type_name'], f'{package}::msg::dds_::{name}')
            ros_type = f'{package}/msg/{name.removesuffix("_")}'
            self.assertEqual(one['user_data'], f'typehash={hashes[ros_type]};')

    def test_records_and_the_package_define_the_same_fields(self):
        package_text = ''.join(f'===\nMSG: {PACKAGE.name}/{file.stem}\n{file.read_text()}\n'
                               for file in (PACKAGE / 'msg').glob('*.msg'))
        checked = set()
        for message in Reader(self.file).messages():
            schema = message.channel.schema
            if schema.name in checked:
                continue
            checked.add(schema.name)
            for name, fields in parse_definition(schema.text, schema.name).items():
                package, _, message_name = name.split('/')
                if package == PACKAGE.name:
                    text = (PACKAGE / 'msg' / f'{message_name}.msg').read_text()
                    self.assertEqual(parse_definition(f'{text}\n{package_text}', name)[name], fields)
        self.assertGreater(len(checked), 8)


class StandIn:
    """A class of ROS 2's launch."""

    def __init__(self, *values: object, **named: object) -> None:
        self.values, self.named = values, named

    def perform(self, context: dict[str, str]) -> str:
        return context[self.values[0]]


class Launch(unittest.TestCase):
    """The launch file with stand-ins for ROS 2's launch, which Debian does not have."""

    @classmethod
    def setUpClass(cls) -> None:
        stand_ins = {'': ('LaunchContext', 'LaunchDescription'), '.event_handlers': ('OnProcessIO',),
                     '.actions': ('DeclareLaunchArgument', 'ExecuteProcess', 'OpaqueFunction', 'RegisterEventHandler'),
                     '.substitutions': ('EnvironmentVariable', 'LaunchConfiguration')}
        for module, names in stand_ins.items():
            made = types.ModuleType(f'launch{module}')
            for name in names:
                setattr(made, name, type(name, (StandIn,), {}))
            sys.modules[f'launch{module}'] = made
        cls.launch = sys.modules['launch.actions']
        scope: dict = {}
        exec((PACKAGE / 'launch/stilt.launch.py').read_text(), scope)
        cls.actions = scope['generate_launch_description']().values[0]

    def setUp(self) -> None:
        self.programs = Programs(*PROGRAMS[:2])
        self.addCleanup(self.programs.end)

    def launched(self, **given: str) -> list[StandIn]:
        """The actions with these arguments."""
        defaults = {one.values[0]: one.named['default_value'] for one in self.actions
                    if isinstance(one, self.launch.DeclareLaunchArgument)}
        domain = defaults['domain']
        self.assertEqual((domain.values, domain.named), (('ROS_DOMAIN_ID',), {'default_value': ''}))
        [function] = [one.named['function'] for one in self.actions if isinstance(one, self.launch.OpaqueFunction)]
        return function({**defaults, 'domain': '', **given})

    def commands(self, actions: list[StandIn]) -> list[list[str]]:
        processes = [one.named for one in actions if isinstance(one, self.launch.ExecuteProcess)]
        for named in processes:
            self.assertGreaterEqual(float(named['sigterm_timeout']), 20.0)
        return [[word.replace('ros2_', f'ros2_{os.getpid()}_') for word in named['cmd']] for named in processes]

    def test_it_starts_stiltd_when_the_simulated_robot_is_ready(self):
        os.environ['XDG_RUNTIME_DIR'] = str(self.programs.folder)
        self.addCleanup(os.environ.pop, 'XDG_RUNTIME_DIR')
        actions = self.launched(domain=self.programs.domain, simulated='true')
        robot, monitor = self.commands(actions)
        self.programs.start('robot', 'sh', '-c', 'exec "$0" "$@" 2>errors', PROGRAMS[0], *robot[1:])
        self.programs.start('monitor', *monitor, '--port', '0')
        [handler] = [one.values[0].named for one in actions if isinstance(one, self.launch.RegisterEventHandler)]
        self.assertEqual(self.commands([handler['target_action']]), [robot])
        self.assertIsNone(handler['on_stderr'](types.SimpleNamespace(text=b'something else\n')))
        ready = self.programs.wait_for('errors', '.*ready.*\n')[0]
        [stiltd] = self.commands(handler['on_stderr'](types.SimpleNamespace(text=ready.encode())))
        self.programs.start('controller', *stiltd)
        self.programs.wait_for('controller', ' idle\n')
        with stilt.Robot(self.programs.wait_for('monitor', r'monitor: (http\S+#key=\w+)\n')[1], patience_s=60) as one:
            one.wait_for('idle', PATIENCE_S)

    def printed(self, stiltd: list[str]) -> str:
        """The configuration that it runs with."""
        return subprocess.run([PROGRAMS[1], *stiltd[1:], '--print-config'], capture_output=True, text=True,
                              check=True).stdout

    def test_a_real_robot_keeps_its_configuration(self):
        config = self.programs.folder / 'robot.toml'
        config.write_text('[telemetry]\ninterface = "eth7"\ndomain = 9\n')
        stiltd, monitor = self.commands(self.launched(config=str(config)))
        self.assertEqual(stiltd[0], 'stiltd')
        self.assertEqual(monitor, ['stilt', 'monitor', '--no-browser'])
        for line in ('\ninterface = "eth7"\n', '\ndomain = 9\n'):
            self.assertIn(line, self.printed(stiltd))

    def test_what_is_given_goes_to_stiltd_and_monitor(self):
        config = str(TREE / 'firmware/configuration/amber3m.toml')
        stiltd, monitor = self.commands(self.launched(config=config, domain='7', interface='eth0', peers='10.0.0.2',
                                                      security_folder='/etc/stilt/security',
                                                      monitor_security_folder='/etc/stilt/host'))
        for line in ('domain = 7', 'interface = "eth0"', 'peers = "10.0.0.2"',
                     'security_folder = "/etc/stilt/security"'):
            self.assertIn(f'\n{line}\n', self.printed(stiltd))
        self.assertEqual(monitor[3:], ['--domain', '7', '--interface', 'eth0', '--peers', '10.0.0.2',
                                       '--security-folder', '/etc/stilt/host'])


if __name__ == '__main__':
    PROGRAMS = sys.argv[1:4]
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])

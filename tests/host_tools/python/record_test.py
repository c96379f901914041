#!/usr/bin/python3
"""Records read in Python: every value against stilt log csv, and what is said of files that are no whole records.

  record_test.py STILT STILTD
"""
from __future__ import annotations

import json
import re
import struct
import subprocess
import sys
import unittest
from pathlib import Path

from programs import PACKAGE, PATIENCE_S, Programs
import mcap_writer

import lz4.frame
import numpy as np
import pandas as pd
import stilt
import zstandard
from stilt.mcap import Reader
from stilt.messages import name_with_units
from stilt.record import WIRE_VERSION

TREE = PACKAGE.parents[1]
CONFIGURATION = '/stilt/configuration'


def cell(text: str):
    """A cell of a table of stilt log csv, as the Python value it stands for."""
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text


def same(read, written) -> bool:
    """Whether a value is that of a cell; NaN is null in lists."""
    if isinstance(read, dict):
        lowered = {key.lower(): value for key, value in read.items()}
        return lowered.keys() == written.keys() and all(same(lowered[key], written[key]) for key in lowered)
    if isinstance(read, (list, np.ndarray)):
        return len(read) == len(written) and all(map(same, read, written))
    if isinstance(read, (float, np.floating)):
        if np.isnan(read):
            return written is None or written == 'nan'
        return type(read)(written) == read  # a float32 is written with as many digits as it takes
    return read == written or str(read) == str(written)


class Records(unittest.TestCase):
    programs: Programs

    @classmethod
    def setUpClass(cls) -> None:
        cls.programs = Programs(*PROGRAMS)
        cls.file = cls.programs.folder / 'walk.mcap'
        cls.programs.record(cls.file)
        cls.tables = cls.programs.folder / 'tables'
        subprocess.run([PROGRAMS[0], 'log', 'csv', cls.file, '--out', cls.tables], check=True,
                       stdout=subprocess.DEVNULL)
        cls.record = stilt.Record(cls.file)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.programs.end()

    def table(self, name: str) -> pd.DataFrame:
        """A table of stilt log csv, texts as they stand."""
        return pd.read_csv(self.tables / f'{name}.csv', dtype=str, keep_default_na=False)

    def refusal(self, path: Path, **options) -> str:
        with self.assertRaises(stilt.RecordError) as caught:
            stilt.Record(path, **options)
        self.assertNotIn('\n', str(caught.exception))
        return str(caught.exception)

    def rewritten(self, change, **how) -> Path:
        """A record with the configuration and one event, after change(topic, definition, data)."""
        kept = {}
        for message in Reader(self.file).messages():
            kept.setdefault(message.channel.topic, message)
        messages = [(topic, kept[topic].channel.schema.name,
                     *change(topic, kept[topic].channel.schema.text, bytes(kept[topic].data)))
                    for topic in (CONFIGURATION, '/stilt/event')]
        path = self.programs.folder / 'rewritten.mcap'
        mcap_writer.write(path, messages, **how)
        return path

    def test_every_value_of_every_topic_is_that_of_log_csv(self):
        topics = set(self.record.topics) - {'/stilt/ticks'}
        self.assertGreaterEqual(len(topics), 10)
        for topic in topics:
            arrays = self.record.arrays(topic)
            table = self.table(topic.strip('/').replace('/', '_'))
            names = {('node_time_s' if topic == '/stilt/plan' and column == 'time_s' else column): column
                     for column in table}
            arrays = {name.lower(): values for name, values in arrays.items() if name.lower() in names}
            self.assertEqual(arrays.keys(), names.keys(), topic)
            for name, column in names.items():
                self.assertEqual(len(arrays[name]), len(table), topic)
                for read, text in zip(arrays[name], table[column]):
                    written = text if isinstance(read, str) else cell(text)
                    self.assertTrue(same(read, written), f'{topic} {name}: {read} is not {text}')

    def test_every_tick_is_that_of_log_csv(self):
        ticks = self.record.frame('/stilt/ticks')
        table = self.table('ticks')
        self.assertGreater(len(table), 8000)
        self.assertEqual(list(ticks['tick']), list(table['tick'].astype(int)))
        np.testing.assert_allclose(ticks.index, table['time_s'].astype(float), rtol=0, atol=1e-12)
        factors = {'_us': ('_ns', 1e-3)}
        renamed = {'faults': 'present_faults'}
        words = {'state', 'fallback_level', 'reaction', 'action', 'faults', 'latched_faults'}
        for column in table.columns.drop(['tick', 'time_s']):
            name, factor = column, 1.0
            for ending, (other, value) in factors.items():
                if name.endswith(ending):
                    name, factor = name.removesuffix(ending) + other, value
            read = ticks[renamed.get(name, name)]
            if column in words or '_driver_state' in column or column.endswith('_driver_fault'):
                # The table has words: each number must have one word and each word one number.
                pairs = set(zip(read, table[column]))
                self.assertEqual(len(pairs), len({number for number, _ in pairs}), column)
                self.assertEqual(len(pairs), len({word for _, word in pairs}), column)
            else:
                np.testing.assert_array_equal(factor * read.to_numpy(), table[column].astype(float), column)

    def test_times_count_from_tick_0(self):
        supervisor = self.record.frame('/stilt/supervisor', ['tick', 'time_s'])
        np.testing.assert_allclose(supervisor.index, 1e-3 * supervisor['tick'], atol=1e-9)
        states = self.record.arrays('/joint_states', ['time_s', 'position'])
        ticks = np.round(1e3 * states['time_s']).astype(int)
        self.assertGreater(len(ticks), 500)
        np.testing.assert_allclose(1e-3 * ticks, states['time_s'], atol=1e-6)
        positions_rad = self.record.arrays('/stilt/ticks', ['joint_position_rad'])['joint_position_rad']
        np.testing.assert_array_equal(np.stack(states['position']), positions_rad[ticks])
        self.assertEqual(self.record.frame('/stilt/ticks', ['tick']).index[0], 0.0)

    def test_joints_and_states_have_dimensions_and_columns_of_their_own(self):
        arrays = self.record.arrays('/stilt/ticks', ['estimated_state', 'joint_torque_Nm'])
        rows = len(self.table('ticks'))
        self.assertEqual({name: values.shape for name, values in arrays.items()},
                         {'estimated_state': (rows, 14), 'joint_torque_Nm': (rows, 4)})
        frame = self.record.frame('/stilt/ticks', ['joint_torque_Nm'])
        self.assertEqual(list(frame), ['hip_L_torque_Nm', 'knee_L_torque_Nm', 'hip_R_torque_Nm', 'knee_R_torque_Nm'])
        self.assertEqual(list(self.record.arrays('/stilt/ticks', 'estimated_state')), ['estimated_state'])
        pd.testing.assert_frame_equal(self.record.frame('/stilt/ticks', 'joint_torque_Nm'), frame)
        with self.assertRaisesRegex(KeyError, '/stilt/ticks has no field torque; it has .*wanted_torque_Nm'):
            self.record.frame('/stilt/ticks', ['torque'])
        with self.assertRaisesRegex(KeyError, 'has no messages of /camera; it has /diagnostics, '):
            self.record.frame('/camera')

    def test_fields_that_are_not_asked_for_are_skipped_and_not_decoded(self):
        for topic in self.record.topics:
            whole = self.record.arrays(topic)
            for name in list(whole)[::5]:
                alone = self.record.arrays(topic, [name])
                self.assertEqual(list(alone), [name])
                self.assertEqual(repr(alone[name].tolist()), repr(whole[name].tolist()), f'{topic} {name}')
        types, name = self.record._type_of('/stilt/event')
        data = next(one.data for one in Reader(self.file).messages() if one.channel.topic == '/stilt/event')
        self.assertEqual(list(stilt.messages.Decoder(types, name).decode(data, {'bus'})), ['bus'])

    def test_names_are_those_of_the_messages_with_their_units(self):
        text = (TREE / 'firmware/telemetry/stilt_msgs.idl').read_text()
        names = re.findall(r'^ +(?:unsigned )?[\w<> ]+ (\w+);', text, re.MULTILINE)
        self.assertGreater(len(names), 150)
        for name in names:
            self.assertEqual(name_with_units(name.lower()), name)

    def test_it_reads_the_version_that_stiltd_writes(self):
        header = (TREE / 'firmware/telemetry/wire_version.h').read_text()
        self.assertEqual(int(re.search(r'kWireVersion = (\d+)', header)[1]), WIRE_VERSION)

    def test_configuration_and_robot_are_attached(self):
        self.assertIn('[torque_law]', self.record.configuration())
        self.assertIn('<robot', self.record.attachments['amber3m.urdf'])
        self.assertEqual(self.record.metadata['robot'], 'amber3m')

    def test_every_compression_is_read(self):
        whole = self.record.frame('/stilt/event').iloc[:1]
        for how in ({}, {'compression': 'zstd', 'compress': zstandard.ZstdCompressor().compress},
                    {'compression': 'lz4', 'compress': lz4.frame.compress}):
            record = stilt.Record(self.rewritten(lambda topic, text, data: (text, data), **how))
            pd.testing.assert_frame_equal(record.frame('/stilt/event').drop(columns='log_time_ns'),
                                          whole.drop(columns='log_time_ns'))
        self.assertIn('compression "brotli"; zstd, lz4 and none are read',
                      self.refusal(self.rewritten(lambda topic, text, data: (text, data), compression='brotli')))

    def test_fields_of_a_newer_release_are_read_when_they_are_defined_and_skipped_when_not(self):
        def defined(topic, text, data):
            if topic == CONFIGURATION:
                return text, data
            return text + 'float64 mood\n', data + bytes(-(len(data) - 4) % 8) + struct.pack('<d', 0.75)

        self.assertEqual(stilt.Record(self.rewritten(defined)).frame('/stilt/event')['mood'].iloc[0], 0.75)
        skipped = stilt.Record(self.rewritten(lambda topic, text, data: (text, data + bytes(16))))
        self.assertEqual(skipped.frame('/stilt/event')['text'].iloc[0],
                         self.record.frame('/stilt/event')['text'].iloc[0])

    def test_big_endian_messages_are_read(self):
        path = self.programs.folder / 'big.mcap'
        mcap_writer.write(path, [('/x', 'a/msg/X', 'uint8 a\nfloat64[] b\nuint16 c\nstring d\nfloat64[] e\nuint8 f\n',
                                  b'\0\0\0\0' + b'\7\0\0\0' + struct.pack('>I', 2) + struct.pack('>2d', 1.5, -2.0) +
                                  struct.pack('>H2xI', 513, 7) + b'hello!\0' + struct.pack('>xIB', 0, 9))])
        row = stilt.Record(path).frame('/x').iloc[0]
        self.assertEqual([row['a'], *row['b'], row['c'], row['d'], *row['e'], row['f']],
                         [7, 1.5, -2.0, 513, 'hello!', 9])

    def test_ticks_that_came_twice_are_in_it_once(self):
        messages = [message for message in Reader(self.file).messages() if message.channel.topic == '/stilt/ticks'][:4]
        schema = messages[0].channel.schema
        path = self.programs.folder / 'twice.mcap'
        mcap_writer.write(path, [('/stilt/ticks', schema.name, schema.text, bytes(messages[k].data))
                                 for k in (0, 1, 0, 1, 2, 3)])
        ticks = stilt.Record(path).frame('/stilt/ticks', ['tick', 'state'])
        self.assertEqual(list(ticks['tick']), list(range(len(ticks))))
        self.assertEqual(len(ticks), 4 * 25)

    def test_a_record_that_was_cut_off_is_refused_and_read_as_far_as_it_goes_on_demand(self):
        path = self.programs.folder / 'cut.mcap'
        path.write_bytes(self.file.read_bytes()[:self.file.stat().st_size // 2])
        self.assertRegex(self.refusal(path), r'cut.mcap: was cut off in the record at byte \d+, recording did not end '
                         r'in order; stilt.Record\(path, partial=True\) reads what is there')
        partial = stilt.Record(path, partial=True)
        self.assertEqual(len(partial.problems), 1)
        ticks = partial.frame('/stilt/ticks', ['tick', 'state'])
        self.assertEqual(list(ticks['tick']), list(range(len(ticks))))
        self.assertGreater(len(ticks), 1000)
        self.assertLess(len(ticks), len(self.table('ticks')))

    def test_a_damaged_chunk_is_named(self):
        path = self.rewritten(lambda topic, text, data: (text, data))
        data = bytearray(path.read_bytes())
        data[data.index(b'float64 time_s')] ^= 1
        path.write_bytes(data)
        self.assertRegex(self.refusal(path), r"a chunk's check sum is wrong \(record at byte \d+\)")

    def test_messages_of_an_unknown_channel_leave_the_others_of_their_chunk(self):
        path = self.programs.folder / 'channels.mcap'
        text = 'uint8 a\n'
        mcap_writer.write(path, [(topic, 'a/msg/X', text, bytes((0, 0, 0, 0, value)))
                                 for value, topic in enumerate(('/x', '/x', '/y', '/x', '/y', '/x', '/y', '/x'))],
                          per_chunk=2)
        data = bytearray(path.read_bytes())
        data[data.index(b'/y')] ^= 1  # the chunk that declares the channel
        path.write_bytes(data)
        record = stilt.Record(path, partial=True)
        self.assertEqual(list(record.frame('/x')['a']), [0, 1, 5, 7])
        self.assertEqual([re.search("check sum|unknown channel", problem)[0] for problem in record.problems],
                         ['check sum', 'unknown channel', 'unknown channel'])

    def test_a_message_that_ends_too_early_is_named(self):
        self.assertRegex(self.refusal(self.rewritten(lambda topic, text, data: (text, data[:40]))),
                         'rewritten.mcap: /stilt/configuration: a message of type stilt_msgs/msg/Configuration that')
        path = self.rewritten(lambda topic, text, data: (text, data if topic == CONFIGURATION else data[:40]))
        with self.assertRaisesRegex(stilt.RecordError, 'event: a message of type stilt_msgs/msg/Event that ends'):
            stilt.Record(path).frame('/stilt/event')

    def test_a_topic_that_cannot_be_decoded_is_named_and_the_others_read_on_demand(self):
        path = self.programs.folder / 'foreign.mcap'
        data = bytes((0, 1, 0, 0, 5, 0, 0, 0))
        whole = ('/whole', 'a/msg/W', 'int32 x\n', data)
        for definition, defect in (('B x\n', 'the message a/msg/B contains itself'),
                                   ('c/D x\n', 'the field x of a/msg/B has the type c/msg/D, which is not defined'),
                                   ('int32[N] x\n', 'the field x has the type int32[N], whose number of values is none')):
            mcap_writer.write(path, [('/foo', 'a/msg/B', definition, data), whole])
            self.assertIn(f'foreign.mcap: /foo: {defect}; stilt.Record(path, partial=True)', self.refusal(path))
            partial = stilt.Record(path, partial=True)
            self.assertEqual(len(partial.problems), 1)
            self.assertEqual(list(partial.frame('/whole')['x']), [5])
            with self.assertRaisesRegex(stilt.RecordError, '/foo: the '):
                partial.frame('/foo')

    def test_messages_in_json_are_named(self):
        path = self.programs.folder / 'json.mcap'
        mcap_writer.write(path, [('/foo', 'a/msg/B', 'int32 x\n', b'{}')], encoding='json')
        self.assertIn('/foo: its messages are json defined by ros2msg', self.refusal(path))

    def test_a_chunk_of_an_absurd_size_is_refused(self):
        path = self.programs.folder / 'bomb.mcap'
        for size in (1 << 60, 1 << 63):
            frame = b'\x28\xb5\x2f\xfd\xe0' + struct.pack('<Q', size) + b'\1\0\0'
            body = struct.pack('<QQQII', 0, 0, size, 0, 4) + b'zstd' + struct.pack('<Q', len(frame)) + frame
            path.write_bytes(mcap_writer.MAGIC + struct.pack('<BQ', 6, len(body)) + body +
                             struct.pack('<BQ', 2, 20) + bytes(20) + mcap_writer.MAGIC)
            self.assertRegex(self.refusal(path), rf'a chunk would be of {size} bytes; at most \d+ are read')

    def test_records_of_other_releases_are_refused(self):
        def without_version(topic, text, data):
            return text.replace('uint32 wire_version\n', ''), data

        urdf = self.record.attachments['amber3m.urdf'].encode() + b'\0'
        end = struct.pack('<I', len(urdf)) + urdf  # of the message; its version stands before

        def another_version(topic, text, data):
            return text, data.replace(struct.pack('<I', WIRE_VERSION) + end, struct.pack('<I', 7) + end)

        self.assertRegex(self.refusal(self.rewritten(without_version)), 'has the messages of release 0.1, but this '
                         f'package reads wire version {WIRE_VERSION}; use that of the release that recorded them$')
        self.assertRegex(self.refusal(self.rewritten(another_version)), 'has messages of wire version 7, but this')

    def test_what_is_no_record_is_said_in_one_sentence(self):
        text = self.programs.folder / 'text.mcap'
        text.write_text('not a record')
        self.assertRegex(self.refusal(text), 'text.mcap: is no MCAP file; name a record of stilt record$')
        self.assertRegex(self.refusal(self.programs.folder / 'none.mcap'),
                         r'none.mcap: cannot be read \(No such file or directory\); name a record of stilt record$')
        self.assertRegex(self.refusal(self.programs.folder), r'cannot be read \(Is a directory\)')

    def test_the_examples_plot_and_compare(self):
        """The scripts as programs; examples_test.py has what they compute, here against stilt log csv."""
        def ran(status: int, script: str, *words: str | Path) -> str:
            program = self.programs.start('example', '/usr/bin/python3', PACKAGE / 'examples' / script, *words)
            self.assertEqual(program.wait(PATIENCE_S), status, self.programs.said('example'))
            return self.programs.said('example')

        picture = self.programs.folder / 'plot.png'
        self.assertEqual(ran(0, 'plot_run.py', self.file, '--out', picture), '')
        self.assertEqual(picture.read_bytes()[:4], b'\x89PNG')
        walk = self.table('ticks').query('state == "walk"')
        torques_Nm = walk[['hip_L_torque_Nm', 'knee_L_torque_Nm', 'hip_R_torque_Nm', 'knee_R_torque_Nm']].astype(float)
        figures = {'walking_s': 1e-3 * len(walk), 'mean_speed_m_s': walk['estimated_x_b_m_s'].astype(float).mean(),
                   'peak_torque_Nm': torques_Nm.abs().to_numpy().max(), 'plans': len(self.table('stilt_planner'))}
        said = ran(0, 'compare_runs.py', self.file, self.file)
        for name, value in figures.items():
            self.assertRegex(said, rf'\n{name} +{value:.4g} +{value:.4g} +0\n')
        self.assertRegex(said, r'\nmedian_solve_ms +- +- +-\n', 'lock-step has no times')
        self.assertEqual(ran(2, 'plot_run.py', 'none.mcap'), 'plot_run.py: none.mcap: cannot be read (No such file or '
                         'directory); name a record of stilt record\n')


if __name__ == '__main__':
    PROGRAMS = sys.argv[1:3]
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

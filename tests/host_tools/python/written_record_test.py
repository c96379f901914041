#!/usr/bin/python3
"""Small records, written for each test (mcap_writer.py): several runs, damaged lengths."""
from __future__ import annotations

import struct
import tempfile
import unittest
from pathlib import Path

import programs  # noqa: F401  finds the package
import mcap_writer
import stilt
from stilt.record import WIRE_VERSION

S_NS = 1_000_000_000
CONFIGURATION = 'uint64 run_id\nint64 start_time_ns\nint64 start_clock_ns\nbool lockstep\nuint32 wire_version\n'
TICKS = 'uint64 run_id\nuint64 first_tick\nuint64 dropped\nuint32 count\nint64[] time_ns\n'
STAMPED = ('std_msgs/Header header\nint32 x\n===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\n'
           '===\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n')
LITTLE_ENDIAN = bytes((0, 1, 0, 0))


def run(number: int, start_ns: int, lockstep: bool = False) -> tuple[str, str, str, bytes]:
    return ('/stilt/configuration', 'a/msg/Configuration', CONFIGURATION,
            LITTLE_ENDIAN + struct.pack('<QqqB3xI', number, start_ns, 0, lockstep, WIRE_VERSION))


def stamped(x: int, stamp_ns: int) -> tuple[str, str, str, bytes]:
    return '/joint_states', 'a/msg/State', STAMPED, LITTLE_ENDIAN + struct.pack('<iIi', *divmod(stamp_ns, S_NS), x)


def ticks(number: int, first: int, count: int) -> tuple[str, str, str, bytes]:
    times_ns = [tick * 1_000_000 for tick in range(first, first + count)]
    return '/stilt/ticks', 'a/msg/Ticks', TICKS, LITTLE_ENDIAN + struct.pack(f'<QQQII{count}q', number, first, 0, count,
                                                                            count, *times_ns)


def plain(x: int) -> tuple[str, str, str, bytes]:
    return '/cmd_vel', 'a/msg/Speed', 'int32 x\n', LITTLE_ENDIAN + struct.pack('<i', x)


class WrittenRecords(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory(prefix='stilt-python-')
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name, 'small.mcap')

    def record(self, *messages: tuple[str, str, str, bytes]) -> stilt.Record:
        """Messages arrive at 1 ns, 2 ns and so on."""
        mcap_writer.write(self.path, list(messages))
        return stilt.Record(self.path)

    def rows(self, record: stilt.Record, number: int) -> list[tuple[float, int]]:
        arrays = record.arrays('/joint_states', ['time_s', 'x'], run=number)
        return list(zip(arrays['time_s'].round(9).tolist(), arrays['x'].tolist()))

    def test_messages_that_do_not_name_their_run_are_chosen_by_their_stamps(self):
        record = self.record(run(5, 100 * S_NS), stamped(1, 100 * S_NS), stamped(2, 103 * S_NS),
                             stamped(3, 110 * S_NS), run(7, 110 * S_NS), stamped(4, 111 * S_NS))
        self.assertEqual(record.runs, [5, 7])
        self.assertEqual(self.rows(record, 5), [(0.0, 1), (3.0, 2)])
        self.assertEqual(self.rows(record, 7), [(0.0, 3), (1.0, 4)])
        self.assertEqual(list(record.frame('/joint_states')['x']), [1, 2, 3, 4])

    def test_in_lock_step_they_are_chosen_by_their_arrival(self):
        """Stamps run ahead of the clock: the second run starts at 4 ns, while the first has come to 9 s."""
        record = self.record(run(5, 1, lockstep=True), stamped(1, 1), stamped(2, 9 * S_NS + 1),
                             run(7, 4, lockstep=True), stamped(3, 4), stamped(4, 9 * S_NS + 4))
        self.assertEqual(self.rows(record, 5), [(0.0, 1), (9.0, 2)])
        self.assertEqual(self.rows(record, 7), [(0.0, 3), (9.0, 4)])

    def test_an_unknown_run_is_refused_for_every_topic(self):
        record = self.record(run(5, 0), stamped(1, 0), plain(1))
        for topic in record.topics:
            self.assertEqual(len(record.frame(topic, run=5)), 1)
            with self.assertRaisesRegex(stilt.RecordError, r'the runs in it are 5; name one of them with run=$'):
                record.frame(topic, run=12345)

    def test_a_run_that_cannot_be_chosen_is_refused(self):
        """A clock that was set back between two runs, and messages without a time."""
        record = self.record(run(5, 100 * S_NS), stamped(1, 103 * S_NS), stamped(2, 104 * S_NS), run(7, 102 * S_NS),
                             stamped(3, 102 * S_NS), plain(1))
        with self.assertRaisesRegex(stilt.RecordError, '/joint_states do not name their run, and their times go back;'):
            self.rows(record, 5)
        with self.assertRaisesRegex(stilt.RecordError, '/cmd_vel have neither run nor time; leave run= out$'):
            record.frame('/cmd_vel', run=5)

    def test_ticks_that_are_missing_are_named_and_the_others_read(self):
        record = self.record(run(5, 0), ticks(5, 0, 4), ticks(5, 7, 4), ticks(5, 0, 4), ticks(5, 11, 1), run(7, 0), ticks(7, 3, 2),
                             ticks(7, 5, 2), ticks(7, 8, 1), run(9, 0), ticks(9, 0, 2), run(11, 0))
        self.assertEqual([record.missing(number) for number in record.runs], [[(4, 6)], [(0, 2), (7, 7)], [], []])
        self.assertEqual(record.problems, [f'{self.path}: ticks 4 to 6 of run 5 are missing',
                                           f'{self.path}: ticks 0 to 2, 7 of run 7 are missing'])
        self.assertEqual(list(record.frame('/stilt/ticks', run=5)['tick']), [0, 1, 2, 3, 7, 8, 9, 10, 11])
        with self.assertRaisesRegex(stilt.RecordError, r'the runs in it are 5, 7, 9, 11; name one of them with run=$'):
            record.missing()
        many = self.record(run(5, 0), *(ticks(5, 2 * k, 1) for k in range(1, 9)))
        self.assertEqual(many.problems, [f'{self.path}: ticks 0 to 1, 3, 5, 7, 9 and 3 more gaps of run 5 are missing'])

    def test_a_record_with_a_damaged_length_is_read_up_to_its_place(self):
        """Lengths beyond the end of the file, the memory and the address space."""
        self.record(plain(7), plain(8), plain(9))
        data = self.path.read_bytes()
        place = len(mcap_writer.MAGIC)
        for _ in ('header', 'first chunk', 'second chunk'):
            place += 9 + struct.unpack_from('<Q', data, place + 1)[0]
        for length in (1 << 20, 1 << 36, 1 << 62, (1 << 64) - 1):
            self.path.write_bytes(data[:place + 1] + struct.pack('<Q', length) + data[place + 9:])
            with self.assertRaisesRegex(stilt.RecordError, f'small.mcap: was cut off in the record at byte {place}, '
                                        'recording did not end in order; '):
                stilt.Record(self.path)
            self.assertEqual(list(stilt.Record(self.path, partial=True).frame('/cmd_vel')['x']), [7, 8])


if __name__ == '__main__':
    unittest.main()

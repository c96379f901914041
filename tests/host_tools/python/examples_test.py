#!/usr/bin/python3
"""What the examples compute from small records, written for each test (mcap_writer.py), and what they refuse."""
from __future__ import annotations

import contextlib
import io
import struct
import sys
import tempfile
import unittest
from pathlib import Path
from typing import Any

from programs import PACKAGE
import mcap_writer

import matplotlib
import numpy as np
import stilt
from stilt.record import WIRE_VERSION

matplotlib.use('Agg')
sys.path.insert(0, str(PACKAGE / 'examples'))
import compare_runs  # noqa: E402
import plot_run  # noqa: E402

STAND, WALK, SIT = 4, 6, 7
TICK_NS = 1_000_000
DEFINITIONS = {
    '/stilt/configuration': 'uint64 run_id\nint64 start_time_ns\nint64 start_clock_ns\nbool lockstep\nuint32 wire_version\n',
    '/stilt/ticks': 'uint64 run_id\nuint64 first_tick\nuint32 count\nint64[] time_ns\nuint8[] state\n'
                    'uint32[] stance_episode\nfloat64[] estimated_state\nfloat64[] joint_torque_nm\n'
                    'float64[] joint_velocity_rad_s\n',
    '/stilt/planner': 'uint64 run_id\nfloat64 time_s\nint64 solve_ns\nfloat64 equality_violation_max\n'
                      'float64 dynamics_defect_max\n',
    '/stilt/event': 'uint64 run_id\nfloat64 time_s\nuint8 kind\n',
}
CODES = {'uint64': 'Q', 'int64': 'q', 'uint32': 'I', 'uint8': 'B', 'bool': 'B', 'float64': 'd'}

Message = tuple[str, str, str, bytes]


def message(topic: str, *values: Any) -> Message:
    """Plain CDR, little endian, of the values in the order of the definition."""
    out = b''
    for line, value in zip(DEFINITIONS[topic].splitlines(), values, strict=True):
        kind, sequence, _ = line.split()[0].partition('[')
        numbers = list(value) if sequence else [value]
        if sequence:
            out += bytes(-len(out) % 4) + struct.pack('<I', len(numbers))
        for number in numbers:
            out += bytes(-len(out) % struct.calcsize(CODES[kind])) + struct.pack('<' + CODES[kind], number)
    return topic, 'a/msg/' + topic.split('/')[-1].title(), DEFINITIONS[topic], b'\0\1\0\0' + out


def run(number: int) -> Message:
    return message('/stilt/configuration', number, 0, 0, False, WIRE_VERSION)


def ticks(number: int, first: int, states: list[int], speed_m_s: float = 0.0) -> Message:
    """A robot at a height of 0.8 m on its feet, and as the estimator has it off them, at 0. Each joint gives -2 Nm at
    3 rad/s."""
    count = len(states)
    on_feet = [state in (STAND, WALK) for state in states]
    estimates = np.zeros((count, 14))
    estimates[:, 1] = np.where(on_feet, 0.8, 0.0)
    estimates[:, 7] = np.where(on_feet, speed_m_s, 0.0)
    return message('/stilt/ticks', number, first, count, [TICK_NS * (first + k) for k in range(count)], states,
                   [int(one) for one in on_feet], estimates.ravel(), [-2.0] * 4 * count, [3.0] * 4 * count)


def cycle(number: int, solve_ns: int) -> Message:
    return message('/stilt/planner', number, 0.0, solve_ns, 0.25, 1e-3)


class Examples(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory(prefix='stilt-python-')
        self.addCleanup(folder.cleanup)
        self.addCleanup(matplotlib.pyplot.close, 'all')
        self.folder = Path(folder.name)

    def path(self, name: str, *messages: Message) -> str:
        mcap_writer.write(self.folder / name, list(messages))
        return str(self.folder / name)

    def two_walks(self) -> str:
        """Walks 3 ticks, sits 4, walks 2; then 5 are missing, and it walks 2 more."""
        return self.path('two.mcap', run(5), ticks(5, 0, [STAND, WALK, WALK, WALK], 0.4), ticks(5, 4, [SIT] * 4),
                         ticks(5, 8, [WALK] * 2, 0.9), ticks(5, 15, [WALK] * 2, 0.4), cycle(5, 0))

    def ended(self, program: Any, *words: str) -> tuple[int, str, str]:
        """Exit status and output of a script."""
        out, errors = io.StringIO(), io.StringIO()
        sys.argv = [program.__file__, *words]
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
            status = program.main()
        return status, out.getvalue(), errors.getvalue()

    def lines(self, axes: Any) -> list[list[tuple[float, float]]]:
        """Points of each line, in milliseconds; a break is None."""
        return [[None if np.isnan(x + y) else (round(1e3 * x), round(y, 9)) for x, y in line.get_xydata()]
                for line in axes.get_lines()]

    def test_figures_are_of_the_ticks_in_which_the_robot_walks(self):
        record = stilt.Record(self.two_walks())
        figures = compare_runs.figures(record, compare_runs.walking(record))
        self.assertAlmostEqual(figures['walking_s'], 0.007)
        self.assertAlmostEqual(figures['mean_speed_m_s'], (5 * 0.4 + 2 * 0.9) / 7)
        self.assertAlmostEqual(figures['height_deviation_m'], 0.0)
        self.assertEqual(figures['peak_torque_Nm'], 2.0)
        self.assertEqual(figures['mean_joint_power_W'], 4 * 2.0 * 3.0)
        self.assertEqual((figures['plans'], figures['largest_equality_violation']), (1, 0.25))

    def test_solves_without_a_time_have_no_median(self):
        walk = ticks(5, 0, [WALK] * 3)
        path = self.path('times.mcap', run(5), walk, cycle(5, 4_000_000), cycle(5, 0), cycle(5, 2_000_000))
        timed, lockstep = stilt.Record(path), stilt.Record(self.two_walks())
        for record, median_ms in ((timed, 3.0), (lockstep, np.nan)):
            figures = compare_runs.figures(record, compare_runs.walking(record))
            np.testing.assert_equal(figures['median_solve_ms'], median_ms)
        status, out, _ = self.ended(compare_runs, path, lockstep.path)
        self.assertEqual(status, 0)
        self.assertRegex(out, r'\n *walking_s +0\.003 +0\.007 +0\.004\n(.*\n)*median_solve_ms +3 +- +-\n')

    def test_speeds_are_lines_of_their_own_that_break_between_two_walks_and_where_ticks_are_missing(self):
        two = self.two_walks()
        late = self.path('late.mcap', run(6), ticks(6, 40, [WALK] * 2, 0.3), cycle(6, 0))
        records = [stilt.Record(path) for path in (two, late, two)]
        figure = compare_runs.plot(records[:2], [compare_runs.walking(record) for record in records[:2]])
        first = [(0, 0.4), (1, 0.4), (2, 0.4), *[None] * 4, (7, 0.9), (8, 0.9), *[None] * 5, (14, 0.4), (15, 0.4)]
        self.assertEqual(self.lines(figure.axes[0]), [first, [(0, 0.3), (1, 0.3)]])
        same = compare_runs.plot(records[::2], [compare_runs.walking(record) for record in records[::2]])
        self.assertEqual(self.lines(same.axes[0]), [first, first])
        self.assertEqual([text.get_text() for text in same.axes[0].get_legend().get_texts()], [f'a: {two}', f'b: {two}'])

    def test_a_run_is_plotted_without_the_place_of_a_robot_off_its_feet(self):
        figure = plot_run.plot(stilt.Record(self.two_walks()))
        walk = [(0, 0.4), (1, 0.4), (2, 0.4), (3, 0.4), *[None] * 4, (8, 0.9), (9, 0.9), *[None] * 5, (15, 0.4), (16, 0.4)]
        height, pitch = self.lines(figure.axes[1])
        self.assertEqual(self.lines(figure.axes[0]), [walk])
        self.assertEqual(height, [point and (point[0], 0.8) for point in walk])
        self.assertEqual(pitch, [(k, 0.0) for k in range(10)] + [None] * 5 + [(15, 0.0), (16, 0.0)])
        self.assertEqual(self.lines(figure.axes[2]), [[point and (point[0], -2.0) for point in pitch]] * 4)
        self.assertEqual(self.lines(figure.axes[3]), [[(0, 1e-3)]])

    def test_a_record_without_plans_and_events_is_plotted(self):
        path = self.path('idle.mcap', run(5), ticks(5, 0, [STAND] * 3))
        figure = plot_run.plot(stilt.Record(path))
        self.assertEqual([len(axes.get_lines()) for axes in figure.axes], [1, 2, 4, 0])
        events = self.path('events.mcap', run(5), ticks(5, 0, [STAND] * 3), message('/stilt/event', 5, 0.001, 0),
                           message('/stilt/event', 5, 0.002, 4))
        self.assertEqual(self.lines(plot_run.plot(stilt.Record(events)).axes[0])[1:], [[(1, 0.0), (1, 1.0)]])
        self.assertEqual(self.ended(compare_runs, path, path),
                         (2, '', f'compare_runs.py: {path}: has no ticks or no plans; compare runs that walk\n'))

    def test_the_run_of_a_record_of_several_is_chosen(self):
        path = self.path('runs.mcap', run(5), ticks(5, 0, [WALK] * 3), cycle(5, 0), run(7), ticks(7, 0, [WALK] * 4),
                         cycle(7, 0))
        runs = f'{path}: the runs in it are 5, 7; name one of them with run=\n'
        self.assertEqual(self.ended(compare_runs, path, path), (2, '', f'compare_runs.py: {runs}'))
        self.assertEqual(self.ended(plot_run, path), (2, '', f'plot_run.py: {runs}'))
        self.assertRegex(self.ended(compare_runs, path, path, '--run-a', '7', '--run-b', '5')[1],
                         r'\n *walking_s +0\.004 +0\.003 +-0\.001\n')
        out = str(self.folder / 'run.png')
        self.assertEqual(self.ended(plot_run, path, '--run', '7', '--out', out), (0, '', ''))
        self.assertEqual(len(plot_run.plot(stilt.Record(path), 7).axes[0].get_lines()[0].get_xdata()), 4)

    def test_missing_ticks_are_named_once(self):
        path = self.two_walks()
        missing = f'{path}: ticks 10 to 14 of run 5 are missing\n'
        status, _, errors = self.ended(compare_runs, path, path)
        self.assertEqual((status, errors), (0, f'compare_runs.py: {missing}'))
        self.assertEqual(self.ended(plot_run, path, '--out', str(self.folder / 'a.png')), (0, '', f'plot_run.py: {missing}'))

    def test_a_file_that_cannot_be_written_is_named(self):
        path = self.path('walk.mcap', run(5), ticks(5, 0, [WALK] * 3), cycle(5, 0))
        for program, name, words in ((plot_run, 'plot_run.py', [path]), (compare_runs, 'compare_runs.py', [path, path])):
            for out in (str(self.folder / 'a.xyz'), str(self.folder / 'none' / 'a.png')):
                status, _, errors = self.ended(program, *words, '--out', out)
                self.assertEqual(status, 2)
                self.assertRegex(errors, rf'^{name}: {out}: cannot be written \(.*\)\n$')


if __name__ == '__main__':
    unittest.main()

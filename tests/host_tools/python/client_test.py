#!/usr/bin/python3
"""The client of the Python package against a monitor without a robot (stub_monitor.py)."""
from __future__ import annotations

import math
import statistics
import unittest
from collections.abc import Callable

import programs  # noqa: F401  finds the package
import stilt
from stub_monitor import PATIENCE_S, StubMonitor


class Client(unittest.TestCase):
    def setUp(self) -> None:
        self.monitor = StubMonitor()
        self.addCleanup(self.monitor.close)
        self.robot = stilt.Robot(self.monitor.address, token='0' * 32, patience_s=PATIENCE_S)
        self.addCleanup(self.robot.close)

    def test_signs_of_life_leave_ten_times_per_second_while_the_program_does_something_else(self):
        """The median of their distances, which a stall of the machine does not change."""
        times_s = self.monitor.arrivals('alive', 21)
        gap_s = statistics.median(after - before for before, after in zip(times_s, times_s[1:]))
        self.assertGreater(gap_s, 0.05)
        self.assertLess(gap_s, 0.3)

    def test_a_monitor_that_hangs_ends_the_wait(self):
        with self.assertRaisesRegex(stilt.RobotError, r'^the robot has been silent for \d+\.\d s$'):
            self.robot.wait(10.0)

    def test_a_robot_that_is_silent_ends_a_wait_for_the_state_that_it_reported_last(self):
        self.assertEqual(self.robot.state.state, 'stand')
        self.monitor.send({'type': 'link', 'time_s': 7.0, 'silent_s': 4.0})
        with self.robot._changed:
            self.robot._changed.wait_for(lambda: self.robot._link_time_s == 7.0, PATIENCE_S)
        for look in (lambda: self.robot.state, lambda: self.robot.wait_for('stand'), lambda: self.robot.wait(0.0)):
            with self.assertRaisesRegex(stilt.RobotError, r'^the robot has been silent for 4\.0 s$'):
                look()

    def test_a_connection_that_is_closed_or_lost_ends_a_wait_for_the_state_that_was_reported_last(self):
        def expect(address: str, robot: stilt.Robot, pattern: str) -> None:
            for look in (lambda: robot.state, lambda: robot.wait_for('stand')):
                with self.assertRaisesRegex(stilt.RobotError, f'^{address}: the connection to the monitor is {pattern}$'):
                    look()

        other = StubMonitor()
        self.addCleanup(other.close)
        robot = stilt.Robot(other.address, token='0' * 32, patience_s=PATIENCE_S)
        robot.close()
        expect(other.address, robot, 'closed')
        self.monitor.hang_up()
        with self.robot._changed:
            self.robot._changed.wait_for(lambda: self.robot._problem, PATIENCE_S)
        expect(self.monitor.address, self.robot, r'lost \(.*\)')

    def test_a_command_returns_the_newest_time_of_the_monitor(self):
        """The monitor refuses by it what comes late (live_view_commands_test.cc)."""
        self.robot.stop()
        for time_s in (7.0, 7.1):
            self.monitor.send({'type': 'link', 'time_s': time_s, 'silent_s': 0.0})
        with self.robot._changed:
            self.robot._changed.wait_for(lambda: self.robot._link_time_s == 7.1, PATIENCE_S)
        self.robot.sit()
        self.assertEqual(self.monitor.values('link_time_s'), [None, 7.1])

    def test_a_refusal_that_does_not_prove_the_token_counts_when_the_robot_itself_does_not_answer(self):
        self.monitor.forged = 'the robot is tired'
        self.robot.sit()
        self.monitor.answers = False
        with self.assertRaisesRegex(stilt.Refused, '^stop: refused by somebody without this token: the robot is tired$'):
            self.robot.stop()

    def test_a_number_that_is_not_finite_is_refused_before_it_is_sent(self):
        self.robot._patience_s = 0.5
        for value in (math.nan, math.inf, -math.inf):
            for name, command in (('walk', lambda: self.robot.walk(value)),
                                  ('height', lambda: self.robot.set_height(value)),
                                  ('tunable', lambda: self.robot.tune('gait.swing_height_m', value))):
                with self.assertRaisesRegex(ValueError, f'^{name}: the value is {value}; give a finite number$'):
                    command()
        self.assertEqual(self.monitor.commands(), [])

    def test_the_end_of_the_block_stops_a_robot_that_was_moved_and_lets_it_sit_down(self):
        def sent(*orders: Callable[[stilt.Robot], None]) -> list[str]:
            monitor = StubMonitor()
            self.addCleanup(monitor.close)
            with stilt.Robot(monitor.address, token='0' * 32, patience_s=PATIENCE_S) as robot:
                for order in orders:
                    order(robot)
            return monitor.commands()

        def lower(robot: stilt.Robot) -> None:
            robot.set_height(0.76)

        stand, sit, off = stilt.Robot.stand, stilt.Robot.sit, stilt.Robot.motors_off
        self.assertEqual(sent(stand), ['stand', 'stop'])
        self.assertEqual(sent(sit, stand), ['sit', 'stand', 'stop'])
        self.assertEqual(sent(stand, lower), ['stand', 'height', 'stop'])
        self.assertEqual(sent(stand, sit), ['stand', 'sit'])
        self.assertEqual(sent(stand, sit, lower), ['stand', 'sit', 'height'])
        self.assertEqual(sent(stand, off), ['stand', 'cut'])
        self.assertEqual(sent(lower), ['height'], 'it moves nothing')

    def test_a_wait_may_be_infinite_and_not_nan(self):
        for wait in (lambda: self.robot.wait(math.nan), lambda: self.robot.wait_for('stand', math.nan)):
            with self.assertRaisesRegex(ValueError, '^a wait of nan seconds has no end; give a number of seconds$'):
                wait()
        with self.assertRaisesRegex(stilt.RobotError, r'^the robot has been silent for'):
            self.robot.wait(math.inf)

    def kept_after(self, *bases_s: float) -> list[float]:
        """Times of the ticks that are kept once two have come at each of these times and half a second later."""
        for base_s in bases_s:
            self.monitor.send_ticks(base_s, [(0.0, 0.78), (0.5, 0.78)])
        newest_s = bases_s[-1] + 0.5
        with self.robot._changed:
            self.robot._changed.wait_for(
                lambda: self.robot._ticks and self.robot.recent().index[-1] == newest_s, PATIENCE_S)
        return list(self.robot.recent().index)

    def test_ticks_are_kept_for_a_minute(self):
        self.assertEqual(self.kept_after(0.0, 30.0), [0.0, 0.5, 30.0, 30.5])
        self.assertEqual(self.kept_after(61.0), [30.0, 30.5, 61.0, 61.5])
        self.monitor.send({'type': 'configuration', 'run_id': '000000000000000a', 'toml': 'again'})
        self.assertEqual(self.kept_after(62.0), [30.0, 30.5, 61.0, 61.5, 62.0, 62.5], 'the run goes on')

    def test_ticks_of_an_earlier_run_are_not_kept(self):
        """Whether the new run is younger than all of them, or than some."""
        for run_id, bases_s in (('b', (0.0, 5.0)), ('c', (2.0,)), ('d', (1.0,))):
            self.monitor.send({'type': 'configuration', 'run_id': run_id, 'toml': ''})
            self.assertEqual(self.kept_after(*bases_s), [time_s for base_s in bases_s for time_s in (base_s, base_s + 0.5)])


if __name__ == '__main__':
    unittest.main()

#!/usr/bin/python3
"""A simulated robot commanded from Python, through stiltd and the monitor as programs on loopback.

  robot_test.py STILT STILTD
"""
from __future__ import annotations

import signal
import sys
import threading
import time
import unittest
from pathlib import Path

from programs import PACKAGE, PATIENCE_S, Programs

import stilt

TIMEOUT_S = 2.0  # of the heartbeat, by the clock also in lock-step, in tests of signs of life

WALKER = """
import stilt, sys
with stilt.Robot(sys.argv[1], token_file=sys.argv[2]) as robot:
    robot.stand(60)
    robot.walk(0.2)
    print('walks', flush=True)
    robot.wait(600)
"""


class PatientRobot(stilt.Robot):
    """Orders again, as the refusal asks for, what a busy machine delivered more than half a second late."""

    def _ask(self, command: str, **values) -> None:
        try:
            super()._ask(command, **values)
        except stilt.Refused as refusal:
            if 'look, then order again' not in str(refusal):
                raise
            self._ask(command, **values)


class Commands(unittest.TestCase):
    def setUp(self) -> None:
        self.programs = Programs(*PROGRAMS)
        self.addCleanup(self.programs.end)
        self.programs.robot(*(('--fault', 'driver-fault:knee_L@2') if 'fault' in self._testMethodName else ()))
        own = ('--set', f'supervisor.heartbeat_timeout_s={TIMEOUT_S}') if 'life' in self._testMethodName else ()
        self.stiltd = self.programs.controller(*own)
        self.link = self.programs.monitor()
        self.address = self.link.split('/#')[0]

    def open(self, **how) -> stilt.Robot:
        """With the token, once stiltd has written it."""
        self.programs.wait_for('stiltd', 'idle')
        return PatientRobot(self.address, token_file=str(self.programs.token_file), patience_s=60, **how)

    def test_it_stands_walks_stops_sits_and_its_motors_go_off(self):
        with self.open() as robot:
            robot.wait_for('idle', PATIENCE_S)
            robot.stand(PATIENCE_S)
            self.assertEqual(robot.state.state, 'stand')
            robot.walk(0.3, PATIENCE_S)
            robot.wait(3.0)
            self.assertEqual((robot.state.state, robot.state.speed_m_s), ('walk', 0.3))
            ticks = robot.recent()
            since = ticks[ticks['state_number'] == 6]
            walked_m = since['estimated_state0'].iloc[-1] - since['estimated_state0'].iloc[0]
            self.assertAlmostEqual(walked_m / (since.index[-1] - since.index[0]), 0.3, delta=0.1)
            robot.tune('gait.swing_height_m', 0.07)
            robot.set_height(0.79)
            robot.stop()
            robot.wait_for('stand', PATIENCE_S)
            robot.sit()
            robot.wait_for('ready', PATIENCE_S)
            robot.motors_off()
            self.assertEqual(self.stiltd.wait(PATIENCE_S), 0)
        self.assertNotIn('heartbeat', self.programs.said('stiltd'))

    def test_the_link_of_the_monitor_commands_without_a_token(self):
        self.programs.wait_for('stiltd', 'idle')
        with PatientRobot(self.link, patience_s=60) as robot:
            robot.stand(PATIENCE_S)

    def test_a_refusal_is_an_exception_with_the_reason(self):
        with self.open() as robot:
            robot.wait_for('idle', PATIENCE_S)
            with self.assertRaisesRegex(stilt.Refused, '^walk: .* state idle; it steps and walks from stand$'):
                robot.walk(0.3)
            with self.assertRaisesRegex(stilt.Refused, '^reset: .* state idle; there is nothing to reset$'):
                robot.reset()
            with self.assertRaisesRegex(stilt.Refused, r'^walk: .*speed_limit_m_s'):
                robot.walk(9.0)
            with self.assertRaisesRegex(ValueError, 'dance is no state; boot, idle, '):
                robot.wait_for('dance')
            with self.assertRaisesRegex(stilt.RobotError, 'the robot is in the state idle, not stand, after 0.2 s'):
                robot.wait_for('stand', 0.2)
        other = stilt.Robot(self.address, token='0' * 32, patience_s=60)
        self.addCleanup(other.close)
        with self.assertRaisesRegex(stilt.Refused, '^stand: .*token'):
            other.stand()

    def test_it_stops_when_the_block_ends_with_an_exception(self):
        with self.assertRaisesRegex(ZeroDivisionError, 'of the program'), self.open() as robot:
            robot.stand(PATIENCE_S)
            robot.walk(0.2, PATIENCE_S)
            raise ZeroDivisionError('of the program')
        self.programs.wait_for('stiltd', r'walk\n(.*\n)* .* step\n(.*\n)* .* stand\n')
        self.assertNotIn('heartbeat', self.programs.said('stiltd'))

    def test_a_fault_ends_the_wait_with_its_joint_value_and_limit(self):
        with self.open() as robot:
            with self.assertRaisesRegex(stilt.RobotError, r'^the robot has the fault driver_fault; knee_L, \w'):
                robot.stand(PATIENCE_S)
                robot.wait(PATIENCE_S)
            state = robot.state
        self.assertEqual(len(state.found), len(state.faults))
        self.assertRegex(state.found[state.faults.index('driver_fault')], '^knee_L, ')

    def test_a_program_that_is_killed_gives_no_sign_of_life_and_the_robot_comes_to_a_stand(self):
        self.comes_to_a_stand_after(signal.SIGKILL)

    def test_a_program_that_is_suspended_gives_no_sign_of_life_and_the_robot_comes_to_a_stand(self):
        self.comes_to_a_stand_after(signal.SIGSTOP)

    def comes_to_a_stand_after(self, end: signal.Signals) -> None:
        self.programs.wait_for('stiltd', 'idle')
        walker = self.programs.start('walker', '/usr/bin/python3', '-c', WALKER, self.address, self.programs.token_file)
        self.programs.wait_for('walker', 'walks')
        walker.send_signal(end)
        self.programs.wait_for('stiltd', r'walk\n(.*\n)*.*heartbeat_lost(.*\n)* .* stand\n')

    def test_a_robot_that_goes_away_ends_the_wait(self):
        with self.open() as robot:
            robot.stand(PATIENCE_S)
            threading.Timer(0.5, self.stiltd.kill).start()
            with self.assertRaisesRegex(stilt.RobotError, r'^the robot has been silent for \d+\.\d s$'):
                robot.wait(PATIENCE_S)
            began_s = time.monotonic()
            robot._patience_s = 2.0
        self.assertLess(time.monotonic() - began_s, 10.0)

    def test_the_example_walks_ten_seconds_and_stops(self):
        self.programs.wait_for('stiltd', 'idle')
        example = self.programs.start('example', '/usr/bin/python3', PACKAGE / 'examples/walk_ten_seconds.py',
                                      '--address', self.address, '--token-file', self.programs.token_file)
        self.assertEqual(example.wait(PATIENCE_S), 0, self.programs.said('example'))
        self.assertRegex(self.programs.said('example'), r'^walked \d+\.\d\d m in 10 s; it stands\n$')


class NoRobot(unittest.TestCase):
    def setUp(self) -> None:
        self.programs = Programs(*PROGRAMS)
        self.addCleanup(self.programs.end)

    def test_a_monitor_that_is_not_there_and_one_without_a_robot_are_told_apart(self):
        with self.assertRaisesRegex(stilt.RobotError, r'^http://127.0.0.1:9: no monitor answers \(.*\); start stilt'):
            stilt.Robot('127.0.0.1:9', token='0' * 32)
        with self.assertRaisesRegex(stilt.RobotError, 'no robot sends to the monitor; start stiltd$'):
            stilt.Robot(self.programs.monitor(), patience_s=2.0)

    def test_a_token_file_that_others_may_read_or_that_is_none_is_refused(self):
        path = Path(self.programs.folder, 'token')
        for text, mode, wanted in (('a' * 32, 0o644, 'others may read or write it; chmod 600 makes it yours alone$'),
                                   ('short', 0o600, 'its first line is no token of 16 to 256 characters')):
            path.write_text(text)
            path.chmod(mode)
            with self.assertRaisesRegex(stilt.RobotError, f'^token file {path}: {wanted}'):
                stilt.Robot(token_file=str(path))
        path.unlink()
        with self.assertRaisesRegex(stilt.RobotError, 'No such file or directory; stiltd prints where its token is$'):
            stilt.Robot(token_file=str(path))
        path.symlink_to('/dev/null')
        with self.assertRaisesRegex(stilt.RobotError, f'^token file {path}: '):
            stilt.Robot(token_file=str(path))


if __name__ == '__main__':
    PROGRAMS = sys.argv[1:3]
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])

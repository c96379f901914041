#!/usr/bin/python3
"""Walks a simulated robot for ten seconds and stops it.

  walk_ten_seconds.py [--address ADDRESS] [--token-file FILE] [--domain N] [--speed V]

In three terminals before: stilt robot, stiltd and stilt monitor (docs/commands.md, Two programs).
"""
import argparse
import sys

import stilt

DURATION_S = 10.0


def main() -> int:
    parser = argparse.ArgumentParser(description='Walks a simulated robot for ten seconds and stops it.')
    parser.add_argument('--address', default='http://127.0.0.1:8080', help='of the monitor, or its link with the key')
    parser.add_argument('--token-file', help='default: the one that stiltd writes for this user')
    parser.add_argument('--domain', type=int, default=0, help='DDS domain, telemetry.domain of stiltd')
    parser.add_argument('--speed', type=float, default=0.3, help='m/s')
    words = parser.parse_args()
    try:
        with stilt.Robot(words.address, token_file=words.token_file, domain=words.domain) as robot:
            robot.stand()
            robot.wait(1.0)
            start_m = robot.recent()['estimated_state0'].iloc[-1]
            robot.walk(words.speed)
            robot.wait(DURATION_S)
            walked_m = robot.recent()['estimated_state0'].iloc[-1] - start_m
            robot.stop()
            robot.wait_for('stand')
            print(f'walked {walked_m:.2f} m in {DURATION_S:g} s; it stands')
    except stilt.RobotError as error:
        print(f'walk_ten_seconds.py: {error}', file=sys.stderr)
        return 2
    return 0


if __name__ == '__main__':
    sys.exit(main())

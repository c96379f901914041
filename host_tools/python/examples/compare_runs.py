#!/usr/bin/python3
"""Compares two runs: speed, torques and plans in a table, with --out a plot of both speeds.

  compare_runs.py RECORD RECORD [--out FILE]     FILE: png, svg or pdf
"""
import argparse
import sys

import pandas as pd
import stilt
from stilt.record import JOINTS

WALK = 6  # supervisor::State::walk, in the order of firmware/supervisor/state.h


def walking(record: stilt.Record) -> pd.DataFrame:
    """The ticks in which the robot walked; the time counts from the first of them."""
    ticks = record.frame('/stilt/ticks', ['estimated_state', 'joint_torque_Nm', 'joint_velocity_rad_s', 'state'])
    walk = ticks[ticks['state'] == WALK]
    if walk.empty:
        raise stilt.RecordError(f'{record.path}: the robot does not walk in it; compare runs that walk')
    return walk.set_axis(walk.index - walk.index[0])


def figures(record: stilt.Record, walk: pd.DataFrame) -> pd.Series:
    """What the table compares, with units in the names."""
    torques = walk[[f'{joint}_torque_Nm' for joint in JOINTS]]
    rates = walk[[f'{joint}_velocity_rad_s' for joint in JOINTS]]
    power_W = (torques.abs().to_numpy() * rates.abs().to_numpy()).sum(axis=1)
    plans = record.frame('/stilt/planner', ['solve_ns', 'equality_violation_max'])
    return pd.Series({
        'walking_s': walk.index[-1],
        'mean_speed_m_s': walk['estimated_x_b_m_s'].mean(),
        'height_deviation_m': walk['estimated_z_b_m'].std(),
        'pitch_deviation_rad': walk['estimated_pitch_b_rad'].std(),
        'peak_torque_Nm': torques.abs().to_numpy().max(),
        'mean_joint_power_W': power_W.mean(),
        'plans': len(plans),
        'median_solve_ms': 1e-6 * plans['solve_ns'].median(),
        'largest_equality_violation': plans['equality_violation_max'].max(),
    })


def main() -> int:
    parser = argparse.ArgumentParser(description='Compares two runs.')
    parser.add_argument('records', nargs=2, metavar='record')
    parser.add_argument('--out', help='plot of both speeds: png, svg or pdf')
    words = parser.parse_args()
    try:
        records = [stilt.Record(path) for path in words.records]
        walks = [walking(record) for record in records]
    except stilt.RecordError as error:
        print(f'compare_runs.py: {error}', file=sys.stderr)
        return 2
    table = pd.DataFrame({name: figures(record, walk) for name, record, walk in zip('ab', records, walks)})
    table['b - a'] = table['b'] - table['a']
    print(table.to_string(float_format='{:.4g}'.format))
    if words.out:
        speeds = pd.DataFrame({record.path: walk['estimated_x_b_m_s'] for record, walk in zip(records, walks)})
        speeds.plot(xlabel='time since the walk began (s)', ylabel='speed (m/s)').figure.savefig(words.out)
    return 0


if __name__ == '__main__':
    sys.exit(main())

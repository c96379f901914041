#!/usr/bin/python3
"""Compares two runs: speed, torques and plans in a table, with --out a plot of both speeds.

  compare_runs.py RECORD RECORD [--run-a N] [--run-b N] [--out FILE]     FILE: png, svg or pdf
"""
import argparse
import sys

import numpy as np
import pandas as pd
import stilt
from stilt.record import JOINTS

WALK = 6  # supervisor::State::walk, in the order of firmware/supervisor/state.h


def walking(record: stilt.Record, run: int | None = None) -> pd.DataFrame:
    """The ticks in which the robot walked, with their numbers and durations; the time counts from the first of them."""
    fields = ['tick', 'estimated_state', 'joint_torque_Nm', 'joint_velocity_rad_s', 'state']
    if not {'/stilt/ticks', '/stilt/planner'} <= record.topics.keys():
        raise stilt.RecordError(f'{record.path}: has no ticks or no plans; compare runs that walk')
    ticks = record.frame('/stilt/ticks', fields, run)
    duration_s = np.diff(ticks.index, append=np.nan)
    is_followed = np.diff(ticks['tick'], append=-1) == 1
    ticks['duration_s'] = np.where(is_followed, duration_s, np.median(duration_s[is_followed]))
    walk = ticks[ticks['state'] == WALK]
    if walk.empty:
        raise stilt.RecordError(f'{record.path}: the robot does not walk in it; compare runs that walk')
    return walk.set_axis(walk.index - walk.index[0])


def figures(record: stilt.Record, walk: pd.DataFrame, run: int | None = None) -> pd.Series:
    """What the table compares, with units in the names; NaN where the record has no such figure."""
    torques = walk[[f'{joint}_torque_Nm' for joint in JOINTS]]
    rates = walk[[f'{joint}_velocity_rad_s' for joint in JOINTS]]
    power_W = (torques.abs().to_numpy() * rates.abs().to_numpy()).sum(axis=1)
    plans = record.frame('/stilt/planner', ['solve_ns', 'equality_violation_max'], run)
    solve_ns = plans['solve_ns'][plans['solve_ns'] > 0]  # lock-step has no times
    return pd.Series({
        'walking_s': walk['duration_s'].sum(),
        'mean_speed_m_s': walk['estimated_x_b_m_s'].mean(),
        'height_deviation_m': walk['estimated_z_b_m'].std(),
        'pitch_deviation_rad': walk['estimated_pitch_b_rad'].std(),
        'peak_torque_Nm': torques.abs().to_numpy().max(),
        'mean_joint_power_W': power_W.mean(),
        'plans': len(plans),
        'median_solve_ms': 1e-6 * solve_ns.median(),
        'largest_equality_violation': plans['equality_violation_max'].max(),
    })


def table(records: list[stilt.Record], walks: list[pd.DataFrame], runs: list[int | None]) -> pd.DataFrame:
    """Figures of both runs, and their differences."""
    columns = pd.DataFrame({name: figures(*run) for name, *run in zip('ab', records, walks, runs)})
    return columns.assign(**{'b - a': columns['b'] - columns['a']})


def plot(records: list[stilt.Record], walks: list[pd.DataFrame]):
    """Speeds over the time since each walk began. Between two walks and where ticks are missing, lines break."""
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(layout='constrained')
    for name, record, walk in zip('ab', records, walks):
        ticks = walk.reset_index().set_index('tick')
        ticks = ticks.reindex(range(ticks.index[0], ticks.index[-1] + 1))
        axes.plot(ticks['time_s'], ticks['estimated_x_b_m_s'], label=f'{name}: {record.path}')
    axes.set(xlabel='time since the walk began (s)', ylabel='speed (m/s)')
    axes.legend()
    return figure


def main() -> int:
    parser = argparse.ArgumentParser(description='Compares two runs.')
    parser.add_argument('records', nargs=2, metavar='record')
    parser.add_argument('--run-a', type=int, help='number of the run, for a first record of several')
    parser.add_argument('--run-b', type=int, help='the same of the second record')
    parser.add_argument('--out', help='plot of both speeds: png, svg or pdf')
    words = parser.parse_args()
    runs = [words.run_a, words.run_b]
    try:
        records = [stilt.Record(path) for path in words.records]
        for problem in dict.fromkeys(problem for record in records for problem in record.problems):
            print(f'compare_runs.py: {problem}', file=sys.stderr)
        walks = [walking(record, run) for record, run in zip(records, runs)]
        print(table(records, walks, runs).to_string(float_format='{:.4g}'.format, na_rep='-'))
    except stilt.RecordError as error:
        print(f'compare_runs.py: {error}', file=sys.stderr)
        return 2
    try:
        if words.out:
            plot(records, walks).savefig(words.out)
    except (OSError, ValueError) as error:
        print(f'compare_runs.py: {words.out}: cannot be written ({error})', file=sys.stderr)
        return 2
    return 0


if __name__ == '__main__':
    sys.exit(main())

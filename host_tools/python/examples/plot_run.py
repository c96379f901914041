#!/usr/bin/python3
"""Plots a run: speed, height and pitch of the hip, joint torques, and how far plans kept to the dynamics.

  plot_run.py RECORD [--run N] [--out FILE]     FILE: png, svg or pdf; without it a window opens
"""
import argparse
import sys

import matplotlib.pyplot as plt
import pandas as pd
import stilt
from stilt.record import JOINTS


def frame(record: stilt.Record, topic: str, fields: list[str], run: int | None) -> pd.DataFrame:
    """As record.frame(), without rows for a topic that the record does not have."""
    if topic in record.topics:
        return record.frame(topic, fields, run)
    return pd.DataFrame(columns=fields, dtype=float)


def ticks_of(record: stilt.Record, run: int | None) -> pd.DataFrame:
    """The ticks with the column time_s. Those that are missing are rows of NaN: lines break there."""
    fields = ['tick', 'estimated_state', 'joint_torque_Nm', 'stance_episode']
    if '/stilt/ticks' not in record.topics:
        raise stilt.RecordError(f'{record.path}: has no ticks; plot a record of stilt record')
    ticks = record.frame('/stilt/ticks', fields, run).reset_index().set_index('tick')
    return ticks.reindex(range(ticks.index.min(), ticks.index.max() + 1))


def plot(record: stilt.Record, run: int | None = None) -> plt.Figure:
    """Four plots over the time since tick 0. Off its feet the place of the robot is unknown, and is not drawn."""
    ticks = ticks_of(record, run)
    on_feet = ticks.where(ticks['stance_episode'] > 0)
    plans = frame(record, '/stilt/planner', ['dynamics_defect_max'], run)
    events = frame(record, '/stilt/event', ['kind'], run)
    figure, axes = plt.subplots(4, 1, sharex=True, figsize=(10, 9), layout='constrained')
    axes[0].plot(ticks['time_s'], on_feet['estimated_x_b_m_s'])
    axes[0].set_ylabel('speed (m/s)')
    axes[1].plot(ticks['time_s'], on_feet['estimated_z_b_m'], label='height (m)')
    axes[1].plot(ticks['time_s'], ticks['estimated_pitch_b_rad'], label='pitch (rad)')
    axes[1].legend()
    for joint in JOINTS:
        axes[2].plot(ticks['time_s'], ticks[f'{joint}_torque_Nm'], label=joint, linewidth=0.7)
    axes[2].set_ylabel('torque (Nm)')
    axes[2].legend(ncols=len(JOINTS))
    if len(plans):
        axes[3].semilogy(plans['dynamics_defect_max'].clip(lower=1e-16), '.', markersize=3)
    axes[3].set_ylabel('largest defect' if len(plans) else 'no plans')
    axes[3].set_xlabel('time since tick 0 (s); grey lines: the state changes')
    for time_s in events.index[events['kind'] == 0]:
        axes[0].axvline(time_s, color='grey', linewidth=0.5)
    axes[0].set_title(f'{record.metadata.get("robot", "robot")}, {record.path}')
    return figure


def number(text: str) -> int:
    return int(text, 0)


def main() -> int:
    parser = argparse.ArgumentParser(description='Plots a run.')
    parser.add_argument('record')
    parser.add_argument('--run', type=number, help='number of the run, for a record of several; 0x and what stilt prints')
    parser.add_argument('--out', help='png, svg or pdf; without it a window opens')
    words = parser.parse_args()
    try:
        record = stilt.Record(words.record)
        for problem in record.problems:
            print(f'plot_run.py: {problem}', file=sys.stderr)
        figure = plot(record, words.run)
    except stilt.RecordError as error:
        print(f'plot_run.py: {error}', file=sys.stderr)
        return 2
    if not words.out:
        plt.show()
        return 0
    try:
        figure.savefig(words.out)
    except (OSError, ValueError) as error:
        print(f'plot_run.py: {words.out}: cannot be written ({error})', file=sys.stderr)
        return 2
    return 0


if __name__ == '__main__':
    sys.exit(main())

#!/usr/bin/python3
"""Plots a run: speed, height and pitch of the hip, joint torques, and how far plans kept to the dynamics.

  plot_run.py RECORD [--out FILE]     FILE: png, svg or pdf; without it a window opens
"""
import argparse
import sys

import matplotlib.pyplot as plt
import stilt
from stilt.record import JOINTS


def plot(record: stilt.Record) -> plt.Figure:
    """Four plots over the time since tick 0."""
    ticks = record.frame('/stilt/ticks', ['estimated_state', 'joint_torque_Nm', 'state'])
    plans = record.frame('/stilt/planner', ['dynamics_defect_max', 'iterations'])
    figure, axes = plt.subplots(4, 1, sharex=True, figsize=(10, 9), layout='constrained')
    axes[0].plot(ticks['estimated_x_b_m_s'])
    axes[0].set_ylabel('speed (m/s)')
    axes[1].plot(ticks['estimated_z_b_m'], label='height (m)')
    axes[1].plot(ticks['estimated_pitch_b_rad'], label='pitch (rad)')
    axes[1].legend()
    for joint in JOINTS:
        axes[2].plot(ticks[f'{joint}_torque_Nm'], label=joint, linewidth=0.7)
    axes[2].set_ylabel('torque (Nm)')
    axes[2].legend(ncols=len(JOINTS))
    axes[3].semilogy(plans['dynamics_defect_max'].clip(lower=1e-16), '.', markersize=3)
    axes[3].set_ylabel('largest defect')
    axes[3].set_xlabel('time since tick 0 (s); grey lines: the state changes')
    for _, event in record.frame('/stilt/event', ['kind', 'name']).query('kind == 0').iterrows():
        axes[0].axvline(event.name, color='grey', linewidth=0.5)
    axes[0].set_title(f'{record.metadata.get("robot", "robot")}, {record.path}')
    return figure


def main() -> int:
    parser = argparse.ArgumentParser(description='Plots a run.')
    parser.add_argument('record')
    parser.add_argument('--out', help='png, svg or pdf; without it a window opens')
    words = parser.parse_args()
    try:
        figure = plot(stilt.Record(words.record))
    except stilt.RecordError as error:
        print(f'plot_run.py: {error}', file=sys.stderr)
        return 2
    if words.out:
        figure.savefig(words.out)
    else:
        plt.show()
    return 0


if __name__ == '__main__':
    sys.exit(main())

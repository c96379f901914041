"""Records of Stilt as numpy arrays and pandas tables, and commands to a robot over its monitor.

    import stilt

    record = stilt.Record('walk.mcap')
    ticks = record.frame('/stilt/ticks')            # one row per tick, index time_s

    with stilt.Robot() as robot:                    # stilt monitor and stiltd run on this computer
        robot.stand()
        robot.walk(0.3)
        robot.wait(10.0)

docs/python.md describes both; docs/decisions/0032-python-and-ros2.md says why they are so.
"""
from stilt.errors import RecordError, Refused, RobotError
from stilt.record import Record
from stilt.robot import Robot, RobotState

__all__ = ['Record', 'RecordError', 'Refused', 'Robot', 'RobotError', 'RobotState']

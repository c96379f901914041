"""The parts of Stilt: programs, computers, buses."""
import sources
import svg

JOINTS = ('hip_L', 'knee_L', 'hip_R', 'knee_R')


def draw(root):
    c = sources.configuration(root)
    tick = sources.milliseconds(1.0 / c['timing']['torque_rate_hz'])
    period = sources.milliseconds(1.0 / c['timing']['plan_rate_hz'])
    d = svg.Drawing(1000, 400, 'Host, robot computer and robot')
    host(d)
    robot_computer(d, tick, period)
    robot(d, c)

    d.text(332, 286, 'DDS', 13, svg.GREY, 'middle', bold=True)
    d.arrow([(376, 312), (288, 312)], svg.GREY)
    d.text(332, 305, 'telemetry', 12, svg.GREY, 'middle')
    d.arrow([(288, 346), (376, 346)], svg.GREY)
    d.text(332, 339, 'commands', 12, svg.GREY, 'middle')
    d.text(332, 362, 'heartbeat', 12, svg.GREY, 'middle')
    d.text(332, 377, 'token', 12, svg.GREY, 'middle')
    d.text(726, 70, 'CAN', 13, svg.ORANGE, 'middle', bold=True)
    d.arrow([(660, 96), (776, 96)], svg.ORANGE)
    d.text(726, 89, 'commands', 12, svg.ORANGE, 'middle')
    d.arrow([(776, 130), (660, 130)], svg.ORANGE)
    d.text(726, 123, 'readings', 12, svg.ORANGE, 'middle')
    return d.svg()


def host(d):
    d.box(16, 16, 272, 368, 'Host: stilt', color=svg.GREY)
    d.box(32, 52, 240, 66, 'stilt monitor', ('page in the browser:', 'watch, command, STOP'), svg.GREY)
    d.box(32, 130, 240, 66, 'stilt record, replay', ('records (MCAP),', 'replayed bit for bit'), svg.GREY)
    d.box(32, 208, 240, 84, 'stilt sim, experiment', (
        'the same control loop and', 'planner on a MuJoCo plant,', 'without buses'), svg.GREY)
    d.box(32, 304, 240, 66, 'stilt robot', ('the plant behind emulated', 'drivers, instead of a robot'), svg.GREY)


def robot_computer(d, tick, period):
    d.box(376, 16, 300, 368, 'Robot computer: stiltd', color=svg.INK)
    d.box(392, 52, 268, 92, f'Torque loop, every {tick}', (
        'readings, estimate, faults,', 'fallback level, torque, bounds', 'real-time thread'), svg.BLUE)
    d.box(392, 174, 268, 66, f'Planner, every {period}', (
        'nonlinear MPC on the whole body', 'real-time thread'), svg.GREEN)
    d.box(392, 278, 268, 92, 'Housekeeping', (
        'commands, telemetry, events,', 'black box, reconnecting buses', 'ordinary thread'), svg.GREY)
    d.arrow([(470, 144), (470, 174)], svg.BLUE)
    d.text(462, 164, 'state', 12, svg.BLUE, 'end')
    d.arrow([(580, 174), (580, 144)], svg.GREEN)
    d.text(588, 164, 'plan', 12, svg.GREEN)
    d.text(526, 263, 'wait-free mailboxes between all threads', 12, svg.GREY, 'middle', italic=True)


def robot(d, c):
    d.box(776, 16, 208, 368, 'Robot', color=svg.ORANGE)
    y = 52
    for bus, name in enumerate(c['hardware']['buses'].split(',')):
        on_bus = [f'driver {joint}' for joint in JOINTS if c[joint]['bus'] == bus]
        if c['torso_sensor']['bus'] == bus:
            on_bus += ['torso sensor', 'state of emergency stop']
        height = 34 + 18 * len(on_bus)
        d.box(792, y, 176, height, f'bus {name}', on_bus, svg.ORANGE)
        y += height + 12
    d.box(792, y, 176, 84, 'Emergency stop', (
        'a switch that cuts the', 'motors\' power, without', 'any program'), svg.RED)

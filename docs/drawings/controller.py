"""Threads of stiltd, mailboxes between them, steps of a tick and of a planner cycle, fallback levels; with times."""
import sources
import svg

MAILBOXES = 'firmware/control_loop/mailboxes.h'
REALTIME_RUN = 'firmware/program/realtime_run.cc'


def draw(root):
    c = sources.configuration(root)
    d = svg.Drawing(1000, 860, 'Threads, mailboxes, tick, planner cycle and fallback levels of the controller')
    robots(d)
    torque_loop(d, c)
    planner(d, c)
    housekeeping(d, sources.constant(root, MAILBOXES, r'Ring<control_loop::TickRecord, (\d+)>'),
                 1e-9 * sources.constant(root, REALTIME_RUN, r"kHousekeepingPeriod_ns = ([\d']+)"))
    levels(d, c)
    return d.svg()


def robots(d):
    d.box(16, 16, 196, 336, 'Robot: hal/robot/robot.h', color=svg.ORANGE)
    for y, title, lines in ((54, 'RobotHardware', ('drivers on CAN buses,', 'real or emulated:', 'clock or lock-step')),
                            (150, 'PlantRobot', ('MuJoCo plant:', 'stilt sim, experiments')),
                            (230, 'RecordedRobot', ('record:', 'stilt replay'))):
        d.box(28, y, 172, 30 + 18 * len(lines), title, lines, svg.ORANGE)
    d.arrow([(212, 76), (300, 76)], svg.ORANGE)
    d.text(256, 68, 'readings', 12, svg.ORANGE, 'middle')
    d.arrow([(300, 270), (212, 270)], svg.ORANGE)
    d.text(256, 262, 'commands', 12, svg.ORANGE, 'middle')
    d.text(28, 320, 'One of the three; the tick', 12, svg.GREY)
    d.text(28, 336, 'is the same.', 12, svg.GREY)


def torque_loop(d, c):
    tick = sources.milliseconds(1.0 / c['timing']['torque_rate_hz'])
    r = c['runtime']
    d.box(300, 16, 300, 336, f'Torque loop: tick every {tick}', color=svg.BLUE)
    d.text(310, 54, f'SCHED_FIFO {r["torque_priority"]}, processor {r["torque_core"]}', 12, svg.GREY)
    steps = ('1  read: newest reading of every channel', '2  plan_at: plan at this instant, its age',
             '3  estimate_state: base from stance feet', '4  track_gait: gait in step with the robot',
             '5  observe: what the faults are judged by', '6  supervise: faults, state, fallback level',
             '7  torques: law on plan or gait', '8  bound: limits; hold, sit, damp', '9  send: commands to the drivers',
             '10 request_plan: state to the planner', '11 record, report_events')
    for i, step in enumerate(steps):
        number, words = step.split(None, 1)
        y = 84 + 24 * i
        d.text(328, y, number, 12, svg.BLUE, 'end', bold=True)
        d.text(338, y, words, 12)


def planner(d, c):
    period = sources.milliseconds(1.0 / c['timing']['plan_rate_hz'])
    r = c['runtime']
    grid = c['discretisation']
    x = 716
    d.box(x, 16, 268, 336, f'Planner: cycle every {period}', color=svg.GREEN)
    d.text(x + 10, 54, f'SCHED_FIFO {r["planner_priority"]}, processor {r["planner_core"]}', 12, svg.GREY)
    steps = (('1', 'newest request: state, command'), ('2', 'contact schedule, reference'),
             ('3', f'grid: {grid["horizon_s"]:g} s in steps of {sources.milliseconds(grid["time_step_s"])}'),
             ('4', 'last solution, shifted: first iterate'),
             ('5', f'SQP, at most {c["sqp"]["iterations"]} iterations:'),
             ('', 'linearise, project constraints,'), ('', 'Riccati sweep, line search'),
             ('6', 'record of the cycle'), ('7', 'usable: plan with gains to the'),
             ('', 'torque loop; else the plan before'))
    for i, (number, words) in enumerate(steps):
        y = 84 + 24 * i
        if number:
            d.text(x + 22, y, number, 12, svg.GREEN, 'end', bold=True)
        d.text(x + 32, y, words, 12)
    d.arrow([(716, 104), (600, 104)], svg.GREEN)
    d.text(658, 96, 'plans, results', 12, svg.GREEN, 'middle')
    d.text(658, 121, 'every cycle', 12, svg.GREY, 'middle', italic=True)
    d.arrow([(600, 294), (716, 294)], svg.BLUE)
    d.text(658, 286, 'requests', 12, svg.BLUE, 'middle')
    d.text(658, 311, 'every tick', 12, svg.GREY, 'middle', italic=True)


def housekeeping(d, ring_ticks, period_s):
    period = sources.milliseconds(period_s)
    d.box(300, 428, 684, 92, f'Housekeeping: program/realtime_run.cc, ordinary thread, every {period}', (
        'commands of the monitor (telemetry/telemetry_node.h) or of --start',
        'events to the log, black box and statistics to files',
        'telemetry over DDS; connects lost buses again after a reset'), svg.GREY)
    d.arrow([(340, 428), (340, 352)], svg.GREY)
    d.text(348, 384, 'commands,', 12, svg.GREY)
    d.text(348, 400, 'torque_tunings', 12, svg.GREY)
    d.arrow([(470, 352), (470, 428)], svg.BLUE)
    d.text(478, 376, 'events,', 12, svg.BLUE)
    d.text(478, 392, f'ring of {ring_ticks:g} ticks,', 12, svg.BLUE)
    d.text(478, 408, 'black_box', 12, svg.BLUE)
    d.arrow([(740, 428), (740, 352)], svg.GREY)
    d.text(748, 392, 'planner_tunings', 12, svg.GREY)
    d.arrow([(880, 352), (880, 428)], svg.GREEN)
    d.text(888, 384, 'cycles,', 12, svg.GREEN)
    d.text(888, 400, 'previews', 12, svg.GREEN)
    d.text(16, 446, 'Mailboxes', 13, svg.INK, bold=True)
    for i, words in enumerate(('Latest value of three slots, or a', 'ring that drops when it is full:',
                               'no thread waits for another', '(exchange/, decision 0006).')):
        d.text(16, 466 + 18 * i, words, 12)


def levels(d, c):
    s = c['supervisor']
    older, stale = (sources.milliseconds(s[key]) for key in ('plan_feedback_after_s', 'stale_plan_s'))
    tracker = c['gait_tracker']
    feedback = sources.milliseconds(c['torque_law']['feedback_from_age_s'])
    top = 600
    d.text(16, 560, 'Fallback levels, the best first', 14, svg.INK, bold=True)
    d.text(16, 580, 'supervisor/fallback.h: every tick takes the best level that its state, its faults and the age of '
           'the plan allow. kp in Nm/rad, kd in Nm s/rad.', 12)
    rows = (('plan', svg.GREEN, ('plan newer', f'than {older}'), ('torque law of', 'the plan; feedback', f'from {feedback} on')),
            ('plan_feedback', svg.GREEN, (f'plan of {older}', f'to {stale}'), ('torque law of', 'the plan, all of', 'its feedback')),
            ('gait', svg.BLUE, ('no plan below', f'{stale}, from the', 'next touch-down'),
             ('joint PD on the', f'gait, kp {tracker["joint_kp_Nm_rad"]:g},', f'kd {tracker["joint_kd_Nms_rad"]:g}')),
            ('hold', svg.ORANGE, (f'{s["missed_hold_ticks"]} missed replies', 'in a row'),
             ('measured pose,', f'kp {s["hold_kp_Nm_rad"]:g}, kd {s["hold_kd_Nms_rad"]:g}', 'in the driver')),
            ('sit', svg.ORANGE, ('neither plan', 'nor gait; heat;', 'low voltage'),
             ('to the sitting', f'pose in {s["sit_s"]:g} s,', 'then damp')),
            ('damp', svg.RED, (f'{s["missed_damp_ticks"]} missed replies,', 'limits, bus,', 'driver, fall'),
             (f'kd {s["damping_kd_Nms_rad"]:g}, at most', f'{s["damping_torque_Nm"]:g} Nm, in the', 'driver')),
            ('off', svg.RED, ('bring-up failed;', 'idle; the end'), ('drivers disabled',)))
    width = 130
    for i, (name, color, when, what) in enumerate(rows):
        x = 16 + i * (width + 9.6)
        d.box(x, top, width, 200, name, color=color)
        d.text(x + 10, top + 46, 'when', 11, svg.GREY, italic=True)
        for line, words in enumerate(when):
            d.text(x + 10, top + 64 + 17 * line, words, 12)
        d.text(x + 10, top + 128, 'joints', 11, svg.GREY, italic=True)
        for line, words in enumerate(what):
            d.text(x + 10, top + 146 + 17 * line, words, 12)
    watchdog = sources.milliseconds(c['hardware']['driver_watchdog_s'])
    d.text(16, 826, f'No command for {watchdog} (stiltd has ended, the cable is cut): the watchdog of a driver '
           'that has one disables or damps it, without stiltd.', 12, svg.RED)
    d.text(16, 846, f'No heartbeat of the operator for {s["heartbeat_timeout_s"]:g} s: walk, step in place for '
           f'{s["slow_down_s"]:g} s, stand.', 12, svg.RED)

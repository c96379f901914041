"""The robot with its frames, coordinates and signs; lengths and ranges from the shipped URDF."""
import math

import sources
import svg

SCALE = 400.0  # pixels per metre
GROUND = 590.0  # y of the ground
HIP_X = 330.0
PLANT = 'host_tools/simulation/plant/plant.h'

# Pose of the large picture: every angle but the right hip is positive.
PITCH_rad = 0.22
LEFT_rad = (0.16, 0.45)
RIGHT_rad = (-0.75, 0.40)


def along(x, y, angle_rad, length_m):
    """The point below (x, y) on a link that is turned by an angle, clockwise in the picture, from straight down."""
    return (x - SCALE * length_m * math.sin(angle_rad), y + SCALE * length_m * math.cos(angle_rad))


class Pose:
    """Points of the picture, from the hip down and up."""

    def __init__(self, robot, push_height_m, hip, pitch_rad, left_rad, right_rad):
        self.hip = hip
        self.pitch_rad = pitch_rad
        self.top = along(*self.hip, pitch_rad + math.pi, robot.torso_m)
        self.com = along(*self.hip, pitch_rad + math.pi, robot.com_m)
        self.push = along(*self.hip, pitch_rad + math.pi, push_height_m)
        self.legs = []
        for hip_rad, knee_rad in (left_rad, right_rad):
            thigh_rad = pitch_rad + hip_rad
            knee = along(*self.hip, thigh_rad, robot.thigh_m)
            self.legs.append((knee, along(*knee, thigh_rad + knee_rad, robot.shin_m), thigh_rad, thigh_rad + knee_rad))


def links(d, pose, width):
    for (knee, foot, _, _), color in zip(pose.legs, ('#a9b4c0', svg.INK), strict=True):
        d.line([pose.hip, knee, foot], color, width)
        d.circle(*knee, 0.7 * width, color)
        d.circle(*foot, 0.5 * width, color, color)
    d.line([pose.hip, pose.top], svg.INK, 1.4 * width)
    d.circle(*pose.hip, 0.9 * width, svg.INK)


def extension(d, point, angle_rad, length_m, color):
    d.line([point, along(*point, angle_rad, length_m)], color, 1.2, dashed=True)


def angles(d, pose):
    extension(d, pose.hip, math.pi, 0.47, svg.BLUE)
    d.arc(*pose.hip, 168, math.pi, math.pi + pose.pitch_rad, svg.BLUE)
    d.text(pose.hip[0] - 6, pose.hip[1] - 164, 'pitch_b > 0', 13, svg.BLUE, 'end', bold=True)
    extension(d, pose.hip, pose.pitch_rad, 0.34, svg.BLUE)
    (left_knee, _, left_thigh, left_shin), (right_knee, _, right_thigh, right_shin) = pose.legs
    d.arc(*pose.hip, 84, pose.pitch_rad, right_thigh, svg.GREEN)
    d.text(pose.hip[0] + 58, pose.hip[1] + 66, 'hip_R < 0', 13, svg.GREEN, bold=True)
    d.arc(*pose.hip, 112, pose.pitch_rad, left_thigh, svg.BLUE)
    d.text(pose.hip[0] - 62, pose.hip[1] + 84, 'hip_L > 0', 13, svg.BLUE, 'end', bold=True)
    for knee, thigh_rad, shin_rad, name, side, anchor in ((left_knee, left_thigh, left_shin, 'knee_L', -64, 'end'),
                                                          (right_knee, right_thigh, right_shin, 'knee_R', 14, 'start')):
        extension(d, knee, thigh_rad, 0.26, svg.BLUE)
        d.arc(*knee, 72, thigh_rad, shin_rad, svg.BLUE)
        d.text(knee[0] + side, knee[1] + (52 if side < 0 else 4), f'{name} > 0', 13, svg.BLUE, anchor, bold=True)


def world_frame(d):
    x, y = 52, 112
    d.arrow([(x, y), (x + 70, y)], svg.INK, 2)
    d.arrow([(x, y), (x, y - 70)], svg.INK, 2)
    d.circle(x, y, 7)
    d.line([(x - 4.5, y - 4.5), (x + 4.5, y + 4.5)])
    d.line([(x - 4.5, y + 4.5), (x + 4.5, y - 4.5)])
    d.text(x + 74, y + 5, 'x forward', 13, bold=True)
    d.text(x - 6, y - 78, 'z up', 13, bold=True)
    d.text(x - 36, y + 26, 'y into the page: left', 12)
    d.line([(16, GROUND), (640, GROUND)], svg.GREY, 2)
    d.text(20, GROUND + 18, 'ground, z = 0', 12, svg.GREY)


def forces(d, pose, robot, push_height_m):
    d.arrow([(pose.push[0] - 86, pose.push[1]), (pose.push[0] - 8, pose.push[1])], svg.ORANGE, 2.4)
    d.text(pose.push[0] - 92, pose.push[1] - 4, 'push at the torso,', 12, svg.ORANGE, 'end')
    d.text(pose.push[0] - 92, pose.push[1] + 12, f'{push_height_m:g} m above the hip', 12, svg.ORANGE, 'end')
    d.arrow([(pose.hip[0] - 96, pose.hip[1]), (pose.hip[0] - 14, pose.hip[1])], svg.ORANGE, 2.4)
    d.text(pose.hip[0] - 102, pose.hip[1] + 4, 'push at the hip', 12, svg.ORANGE, 'end')
    d.circle(*pose.com, 6, svg.INK, '#ffffff', 2)
    d.text(pose.com[0] + 16, pose.com[1] + 16, f'centre of mass, {robot.com_m:.3f} m', 12)
    d.text(pose.hip[0] + 18, pose.hip[1] + 2, 'hip: base, (x_b, z_b)', 13, bold=True)
    d.text(pose.top[0] + 14, pose.top[1] + 8, 'torso sensor:', 12)
    d.text(pose.top[0] + 14, pose.top[1] + 24, 'pitch, pitch rate', 12)
    _, foot, _, _ = pose.legs[1]
    d.arrow([(foot[0], foot[1]), (foot[0], foot[1] - 90)], svg.RED, 2.4)
    d.text(foot[0] + 8, foot[1] - 76, 'fz_R', 13, svg.RED, bold=True)
    d.arrow([(foot[0], foot[1]), (foot[0] + 70, foot[1])], svg.RED, 2.4)
    d.text(foot[0] + 74, foot[1] - 6, 'fx_R', 13, svg.RED, bold=True)
    d.text(foot[0] - 6, foot[1] + 18, 'foot_R', 13, bold=True)
    _, left, _, _ = pose.legs[0]
    d.text(left[0] - 12, left[1] + 4, 'foot_L', 13, svg.GREY, 'end', bold=True)


def text_panel(d, robot):
    x, y = 672, 342
    hips, knees = robot.range_rad['hip_L'], robot.range_rad['knee_L']
    d.box(x, y, 312, 264, 'Coordinates, SI units', (
        'q = [x_b, z_b, pitch_b,', '  hip_L, knee_L, hip_R, knee_R]', 'v = dq/dt, state x = [q; v]',
        'u = [joint accelerations (4);', '  fx_L, fz_L, fx_R, fz_R]',
        f'hips {hips[0]:g} to {hips[1]:g} rad', f'knees {knees[0]:g} to {knees[1]:g} rad, bent backward',
        f'thigh {robot.thigh_m:.4f} m, shin {robot.shin_m:.4f} m', f'torque at most {robot.torque_Nm:g} Nm per joint',
        'Angles are rotations about +y:', 'clockwise in this view from the',
        'right. Forces act on the robot.'), svg.INK)


def zero_pose(d, robot):
    d.box(672, 16, 312, 308, 'All angles zero', color=svg.GREY)
    hip_y = 148.0
    scale = 0.42
    torso, thigh, shin = (scale * SCALE * length for length in (robot.torso_m, robot.thigh_m, robot.shin_m))
    x = 760.0
    d.line([(x, hip_y - torso), (x, hip_y)], svg.INK, 9)
    d.line([(x, hip_y), (x, hip_y + thigh + shin)], svg.INK, 6)
    d.circle(x, hip_y, 6)
    d.circle(x, hip_y + thigh, 4.5)
    d.line([(700, hip_y + thigh + shin + 4), (972, hip_y + thigh + shin + 4)], svg.GREY, 2)
    for line, words in ((0, 'torso upright:'), (1, 'hip and centre of mass'), (2, 'on one vertical line'),
                        (4, 'legs straight down,'), (5, 'one behind the other')):
        d.text(800, 74 + 18 * line, words, 12)


def draw(root):
    robot = sources.Robot(root)
    d = svg.Drawing(1000, 622, 'AMBER-3M from its right side: frames, coordinates, positive directions')
    push_height_m = sources.constant(root, PLANT, r'kTorsoPushHeight_m = ([\d.]+)')
    angles_rad = (PITCH_rad, LEFT_rad, RIGHT_rad)
    below_hip = Pose(robot, push_height_m, (0.0, 0.0), *angles_rad).legs[1][1][1]
    pose = Pose(robot, push_height_m, (HIP_X, GROUND - below_hip - 4.0), *angles_rad)
    world_frame(d)
    angles(d, pose)
    links(d, pose, 9)
    forces(d, pose, robot, push_height_m)
    zero_pose(d, robot)
    text_panel(d, robot)
    return d.svg()

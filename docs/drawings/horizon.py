"""The horizon of one planning problem: nodes, contact phases, touch-downs; what holds for a foot in each phase."""
import sources
import svg

LEFT_x = 120.0
WIDTH = 850.0
SINCE_TOUCHDOWN_s = 0.1  # of the present, in the picture


def draw(root):
    c = sources.configuration(root)
    return Horizon(c).drawing().svg()


class Horizon:
    def __init__(self, c):
        self.grid = c['discretisation']
        self.gait = c['gait']
        self.horizon_s = self.grid['horizon_s']
        step_s = self.gait['single_support_s']
        self.switches_s = []
        time_s = step_s - SINCE_TOUCHDOWN_s
        while time_s < self.horizon_s:
            self.switches_s.append(time_s)
            time_s += step_s

    def x(self, time_s):
        return LEFT_x + WIDTH * time_s / self.horizon_s

    def nodes_s(self):
        """The grid and the contact switches."""
        count = round(self.horizon_s / self.grid['time_step_s'])
        return sorted({round(k * self.grid['time_step_s'], 6) for k in range(count)} |
                      {round(t, 6) for t in self.switches_s} | {self.horizon_s})

    def drawing(self):
        d = svg.Drawing(1000, 400, 'Horizon of a planning problem')
        self.time_axis(d)
        for row, name in enumerate(('foot_L', 'foot_R')):
            self.foot(d, 110 + 92 * row, name, row == 0)
        self.legend(d)
        return d

    def time_axis(self, d):
        d.text(16, 62, 'nodes', 13, bold=True)
        d.line([(self.x(0.0), 58), (self.x(self.horizon_s), 58)], svg.GREY)
        for time_s in self.nodes_s():
            d.line([(self.x(time_s), 52), (self.x(time_s), 64)], svg.GREY, 1.2)
        d.text(self.x(0.0), 30, 'present: estimated state', 12, svg.INK)
        d.text(self.x(self.horizon_s), 30, f'{self.horizon_s:g} s: terminal cost', 12, svg.INK, 'end')
        for time_s in self.switches_s:
            d.line([(self.x(time_s), 44), (self.x(time_s), 282)], svg.RED, 1.4, dashed=True)
            d.text(self.x(time_s) + 6, 92, 'touch-down', 12, svg.RED)

    def foot(self, d, y, name, stance):
        d.text(16, y + 34, name, 13, bold=True)
        edges_s = [0.0, *self.switches_s, self.horizon_s]
        for start_s, end_s in zip(edges_s, edges_s[1:], strict=False):
            left, right = self.x(start_s), self.x(end_s)
            if stance:
                d.box(left + 2, y, right - left - 4, 66, color=svg.BLUE)
                d.text(0.5 * (left + right), y + 38, 'stance', 13, svg.BLUE, 'middle', bold=True)
            else:
                self.swing(d, y, start_s, end_s)
            stance = not stance

    def swing(self, d, y, start_s, end_s):
        """Reference of the height, mpc_core/gait/swing.h."""
        step_s = self.gait['single_support_s']
        lift_off_s = end_s - step_s if end_s in self.switches_s else start_s
        slope_m = self.gait['touchdown_velocity_m_s'] * step_s
        rise_m = 16.0 * (self.gait['swing_height_m'] + slope_m / 8.0)
        points = []
        for i in range(41):
            time_s = start_s + (end_s - start_s) * i / 40
            s = (time_s - lift_off_s) / step_s
            z_m = rise_m * s * s * (1.0 - s) * (1.0 - s) + slope_m * s * s * (s - 1.0)
            points.append((self.x(time_s), y + 62 - 56 * z_m / self.gait['swing_height_m']))
        d.line(points, svg.GREEN, 2)
        d.text(self.x(0.5 * (start_s + end_s)), y + 52, 'swing', 13, svg.GREEN, 'middle', bold=True)

    def legend(self, d):
        time_step = sources.milliseconds(self.grid['time_step_s'])
        d.box(16, 300, 310, 84, 'Stance foot', ('x, z: constraint, a + kd v = 0', 'force: friction cone, barrier',
                                                'all of its motion: cost'), svg.BLUE)
        d.box(345, 300, 310, 84, 'Swing foot', ('z: constraint, follows the curve',
                                                'x: cost alone: the foothold is free',
                                                'force: constraint, f = 0'), svg.GREEN)
        d.box(674, 300, 310, 84, 'Touch-down', ('impact map: velocity after the impact',
                                                'cost on v_x of the foot before it',
                                                f'a node of its own beside the {time_step}'), svg.RED)

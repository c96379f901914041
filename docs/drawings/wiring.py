"""The wiring of a robot: buses with their ends, supplies, the two contacts of the emergency stop."""
import sources
import svg

JOINTS = ('hip_L', 'knee_L', 'hip_R', 'knee_R')
BUS_LEFT, BUS_RIGHT = 196, 950
FIRST_Y, BUS_APART = 116, 112


def draw(root):
    c = sources.configuration(root)
    names = c['hardware']['buses'].split(',')
    d = svg.Drawing(1000, 470, 'Buses, supplies and emergency stop of a robot')
    d.box(16, 16, 180, FIRST_Y + BUS_APART * (len(names) - 1) + 20, 'Robot computer', (
        'own supply: lives on', 'when the motors\' is cut'), svg.INK)
    drivers = []
    for number, name in enumerate(names):
        drivers += bus(d, c, number, name, FIRST_Y + BUS_APART * number)
    power(d, drivers, FIRST_Y + BUS_APART * len(names) + 4)
    return d.svg()


def end(d, x, y):
    """A resistor across the two wires."""
    d.add(f'<rect x="{x - 5:.1f}" y="{y - 12:.1f}" width="10" height="24" fill="#ffffff" stroke="{svg.ORANGE}" '
          'stroke-width="1.4"/>')
    d.text(x, y - 18, '120 ohm', 11, svg.ORANGE, 'middle')


def bus(d, c, number, name, y):
    """A pair of wires with its devices below; returns the places of the drivers' supplies."""
    for wire in (-3, 3):
        d.line([(BUS_LEFT, y + wire), (BUS_RIGHT, y + wire)], svg.ORANGE)
    d.text(186, y + 4, f'adapter {name}', 12, svg.ORANGE, 'end', bold=True)
    end(d, BUS_LEFT + 30, y)
    end(d, BUS_RIGHT - 6, y)
    places = []
    x = BUS_LEFT + 70
    for joint in JOINTS:
        if c[joint]['bus'] != number:
            continue
        d.line([(x + 70, y + 3), (x + 70, y + 22)], svg.ORANGE)
        d.box(x, y + 22, 140, 32, f'driver {joint}', color=svg.ORANGE)
        places.append((x + 140, y + 38))
        x += 200
    if c['torso_sensor']['bus'] == number:
        d.line([(x + 85, y + 3), (x + 85, y + 22)], svg.ORANGE)
        d.box(x, y + 22, 200, 50, 'torso sensor', ('reads the second contact',), svg.ORANGE)
    return places


def power(d, drivers, y):
    d.box(16, y, 180, 52, 'Supply of the motors', ('takes energy back',), svg.RED)
    d.box(250, y, 230, 70, 'Emergency stop', ('first contact: cuts this supply', 'second contact: to the sensor'), svg.RED)
    d.line([(196, y + 26), (250, y + 26)], svg.RED, 2)
    rail = 648
    d.line([(480, y + 26), (rail, y + 26)], svg.RED, 2)
    top = min(place for _, place in drivers)
    d.line([(rail, y + 26), (rail, top + 24)], svg.RED, 2)
    for x, place in drivers:
        d.line([(x, place), (x + 20, place), (x + 20, place + 24), (rail, place + 24)], svg.RED)
    d.text(rail + 12, y + 30, 'power of the drivers', 12, svg.RED)
    d.text(16, y + 96, 'Each bus ends in 120 ohm at both ends and nowhere else; drivers sit along it, on short stubs. '
           'One ground for all.', 12, svg.GREY, italic=True)

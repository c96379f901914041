"""What the drawings take from the project, so that a changed default changes the drawing."""
import re
import tomllib
import xml.etree.ElementTree


def configuration(root):
    """The shipped configuration, sections of keys."""
    return tomllib.loads((root / 'firmware' / 'configuration' / 'amber3m.toml').read_text())


def constant(root, file, pattern):
    """A number of the code: the group of a pattern that the file has once."""
    found = re.findall(pattern, (root / file).read_text())
    if len(found) != 1:
        raise LookupError(f'{file} has {pattern!r} {len(found)} times')
    return float(found[0].replace("'", ''))


class Robot:
    """Lengths in m and joint ranges in rad of the shipped robot."""

    def __init__(self, root):
        urdf = xml.etree.ElementTree.parse(root / 'codegen' / 'robots' / 'amber3m.urdf').getroot()
        joints = {joint.get('name'): joint for joint in urdf.findall('joint')}
        links = {link.get('name'): link for link in urdf.findall('link')}
        self.thigh_m = -self.height_m(joints['knee_L'])
        self.shin_m = -self.height_m(joints['sole_L'])
        self.torso_m = 2.0 * self.height_m(links['torso'].find('visual'))
        self.com_m = self.height_m(links['torso'].find('inertial'))
        self.range_rad = {}
        for name in ('hip_L', 'knee_L'):
            limit = joints[name].find('limit')
            self.range_rad[name] = (float(limit.get('lower')), float(limit.get('upper')))
        self.torque_Nm = float(joints['hip_L'].find('limit').get('effort'))

    @staticmethod
    def height_m(element):
        return float(element.find('origin').get('xyz').split()[2])


def milliseconds(seconds):
    return f'{1000.0 * seconds:g} ms'

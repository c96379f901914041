"""SVG of boxes, arrows and text for the drawings of this folder. Coordinates in pixels, y down."""
import math
import xml.sax.saxutils

INK = '#1f2328'
GREY = '#59636e'
BLUE = '#0b5cad'
GREEN = '#1a7f37'
ORANGE = '#b35900'
RED = '#b42318'
TINT = {INK: '#f6f8fa', GREY: '#f6f8fa', BLUE: '#e8f1fb', GREEN: '#e9f6ec', ORANGE: '#fdf1e3', RED: '#fdecea'}

# Width of a character of the fonts below, as a share of the font size: wider than the average of a line.
CHARACTER_WIDTH = 0.56


class Overflow(Exception):
    """A text is wider than its box."""


class Drawing:
    """Collects the elements; svg() gives the text. A white background keeps it readable on dark pages."""

    def __init__(self, width, height, title):
        self.width = width
        self.height = height
        self.title = title
        self.elements = []

    def add(self, element):
        self.elements.append(element)

    def text(self, x, y, words, size=13, color=INK, anchor='start', bold=False, italic=False):
        style = ' font-weight="600"' if bold else ''
        style += ' font-style="italic"' if italic else ''
        place = f'x="{x:.1f}" y="{y:.1f}" font-size="{size}" fill="{color}" text-anchor="{anchor}"'
        self.add(f'<text {place}{style}>{xml.sax.saxutils.escape(words)}</text>')

    def box(self, x, y, width, height, title='', lines=(), color=INK, size=12, dashed=False):
        """A frame with a bold title and lines of text below it, from its upper left corner on."""
        dashes = ' stroke-dasharray="5 4"' if dashed else ''
        self.add(f'<rect x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" rx="6" '
                 f'fill="{TINT[color]}" stroke="{color}" stroke-width="1.2"{dashes}/>')
        rows = [(title, size + 1, True)] if title else []
        rows += [(line, size, False) for line in lines]
        for row, (words, row_size, bold) in enumerate(rows):
            if len(words) * row_size * CHARACTER_WIDTH > width - 12:
                raise Overflow(f'{words!r} is wider than its box of {width} pixels')
            self.text(x + 10, y + 20 + row * (size + 6), words, row_size, color if bold else INK, bold=bold)

    def line(self, points, color=INK, width=1.4, arrow=False, dashed=False):
        """A line through the points; arrow: with a head at its end."""
        path = ' '.join(f'{x:.1f},{y:.1f}' for x, y in points)
        extra = ' stroke-dasharray="5 4"' if dashed else ''
        extra += f' marker-end="url(#head{color[1:]})"' if arrow else ''
        self.add(f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="{width:g}"{extra}/>')

    def arrow(self, points, color=INK, width=1.4, dashed=False):
        self.line(points, color, width, True, dashed)

    def arc(self, x, y, radius, start_rad, end_rad, color=INK):
        """An arrow along a circle; angles clockwise from straight down."""
        steps = 24
        angles = [start_rad + (end_rad - start_rad) * i / steps for i in range(steps + 1)]
        self.arrow([(x - radius * math.sin(a), y + radius * math.cos(a)) for a in angles], color)

    def circle(self, x, y, radius, color=INK, fill='#ffffff', width=1.4):
        self.add(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}" fill="{fill}" stroke="{color}" '
                 f'stroke-width="{width:g}"/>')

    def svg(self):
        heads = ''.join(
            f'<marker id="head{color[1:]}" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="8" markerHeight="8" '
            f'markerUnits="userSpaceOnUse" orient="auto"><path d="M0 0.8 L10 5 L0 9.2 z" fill="{color}"/></marker>\n'
            for color in TINT)
        return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width}" height="{self.height}" '
                f'viewBox="0 0 {self.width} {self.height}" font-family="Helvetica, Arial, sans-serif">\n'
                f'<!-- written by toolchain/drawings, do not edit -->\n'
                f'<title>{xml.sax.saxutils.escape(self.title)}</title>\n<defs>\n{heads}</defs>\n'
                f'<rect width="{self.width}" height="{self.height}" rx="8" fill="#ffffff"/>\n' +
                '\n'.join(self.elements) + '\n</svg>\n')

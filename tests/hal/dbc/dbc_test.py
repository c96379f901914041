"""Reads what the codecs encode with the DBC files of hal and canmatrix (Debian: python3-canmatrix).

dbc_test.py VECTOR_PROGRAM DBC_FILE...

Exit status 0: every frame decodes to the values it was encoded from, and every message of the files occurred.
77: the reader is not installed. 1: otherwise.
"""
import subprocess
import sys
import warnings

warnings.simplefilter("ignore")
try:
    import canmatrix.formats
except ImportError:
    print("canmatrix is not installed: apt install python3-canmatrix")
    sys.exit(77)

RELATIVE_TOLERANCE = 2e-6  # floats on the wire, nine digits in the vectors


def check(messages, line):
    """Decodes one line of vectors; the list of its differences."""
    identifier, digits, *pairs = line.split()
    message = messages[int(identifier)]
    data = bytes.fromhex(digits)
    if len(data) != message.size:
        return [f"{message.name}: {len(data)} bytes, the DBC says {message.size}"]
    decoded = message.decode(data)
    expected = dict(pair.split("=") for pair in pairs)
    if set(decoded) != set(expected):
        return [f"{message.name}: signals {sorted(decoded)}, encoded {sorted(expected)}"]
    wrong = []
    for signal, text in expected.items():
        value, wanted = float(decoded[signal].phys_value), float(text)
        if abs(value - wanted) > RELATIVE_TOLERANCE * max(1.0, abs(wanted)):
            wrong.append(f"{message.name}.{signal}: {value}, encoded from {wanted}, bytes {digits}")
    return wrong


def main(vector_program, *dbc_files):
    frames = [frame for file in dbc_files for frame in canmatrix.formats.loadp_flat(file).frames]
    messages = {frame.arbitration_id.id: frame for frame in frames}
    lines = subprocess.run([vector_program], check=True, capture_output=True, text=True).stdout.splitlines()
    differences = [difference for line in lines for difference in check(messages, line)]
    seen = {int(line.split()[0]) for line in lines}
    differences += [f"{messages[i].name}: no frame was encoded" for i in sorted(set(messages) - seen)]
    print("\n".join(differences) or f"{len(lines)} frames of {len(messages)} messages agree")
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))

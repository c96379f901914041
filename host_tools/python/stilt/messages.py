"""Types of messages, read from their definitions in a record (ros2msg), and the decoder of their bytes (CDR)."""
from __future__ import annotations

import dataclasses
import struct
from typing import Any, Literal

import numpy as np

# Bytes of the basic types, as numpy and struct call them.
BASIC = {'bool': 'B', 'byte': 'B', 'char': 'B', 'int8': 'b', 'uint8': 'B', 'int16': 'h', 'uint16': 'H', 'int32': 'i',
         'uint32': 'I', 'int64': 'q', 'uint64': 'Q', 'float32': 'f', 'float64': 'd'}

# Units with capital letters, which ROS 2 does not allow in the names of fields.
UNITS = {'nm': 'Nm', 'nms': 'Nms', 'n': 'N', 'c': 'C', 'v': 'V'}

DEEPEST = 100  # messages inside of each other


@dataclasses.dataclass(frozen=True)
class Field:
    """A field of a message: `count` values of an array, None for a single value, -1 for a sequence."""
    name: str
    type: str
    count: int | None


Types = dict[str, list[Field]]


def name_with_units(name: str) -> str:
    """The name of a field as stilt_msgs.idl and ticks.csv have it: joint_torque_nm is joint_torque_Nm."""
    first, *rest = name.split('_')
    rest = [UNITS.get(word, word) for word in rest]
    if rest and rest[-1] == 'ns' and 'impulse' in (first, *rest):  # newton seconds, not nanoseconds
        rest[-1] = 'Ns'
    return '_'.join([first, *rest])


def parse_definition(text: str, name: str) -> Types:
    """The message `name`, such as 'std_msgs/msg/Header', and those it uses.

    Raises ValueError for a line that is no field, a message that is not defined, and one that contains itself."""
    types: Types = {name: []}
    current = name
    for line in text.splitlines():
        line = line.split('#')[0].strip()
        if line.startswith('===') or not line:
            continue
        if line.startswith('MSG:'):
            current = _long_name(line[4:].strip(), current)
            types[current] = []
            continue
        words = line.split()
        if len(words) < 2:
            raise ValueError(f'the definition of {current} has the line "{line}", which is no field')
        if '=' in line.split('"')[0]:
            continue  # a constant
        types[current].append(_field(words[0], words[1], current))
    _check(types, name, [], set())
    return types


def _check(types: Types, name: str, outer: list[str], checked: set[str]) -> None:
    """outer    messages that contain this one
    checked  those without a defect"""
    if len(outer) > DEEPEST:
        raise ValueError(f'its messages contain each other {DEEPEST} times')
    for field in types[name]:
        if field.type in BASIC or field.type == 'string' or field.type in checked:
            continue
        if field.type not in types:
            raise ValueError(f'the field {field.name} of {name} has the type {field.type}, which is not defined')
        if field.type in (*outer, name):
            raise ValueError(f'the message {field.type} contains itself')
        _check(types, field.type, [*outer, name], checked)
    checked.add(name)


def _field(word: str, name: str, user: str) -> Field:
    word, bracket, size = word.partition('[')
    count = None
    if bracket:
        size = size.partition(']')[0]
        if not (size == '' or size.startswith('<=') or size.isdecimal()):
            raise ValueError(f'the field {name} has the type {word}[{size}], whose number of values is none')
        count = int(size) if size.isdecimal() else -1
    word = word.split('<=')[0]
    basic = word in BASIC or word == 'string'
    return Field(name, word if basic else _long_name(word, user), count)


def _long_name(name: str, user: str) -> str:
    """std_msgs/Header is std_msgs/msg/Header; a message may omit its own package."""
    if '/' not in name:
        return f'{user.rsplit("/", 1)[0]}/{name}'
    return name if '/msg/' in name else name.replace('/', '/msg/')


class Decoder:
    """Decodes messages of one type. Fields that a newer release appended to the bytes are skipped."""

    def __init__(self, types: Types, name: str) -> None:
        self._types = types
        self._name = name

    def decode(self, data: memoryview, wanted: set[str] | None = None) -> dict[str, Any]:
        """The values by name; those of messages inside have names such as 'header.stamp.sec'. Arrays and sequences of
        numbers are numpy arrays, those of texts and messages lists.

        wanted  fields to return, with all others skipped; None: all

        Raises ValueError when the bytes end too early."""
        try:
            cursor = _Cursor(data)
            values: dict[str, Any] = {}
            self._message(cursor, self._name, '', wanted, values)
        except (struct.error, IndexError) as error:
            raise ValueError(f'a message of type {self._name} that ends too early') from error
        return values

    def _message(self, cursor: _Cursor, name: str, prefix: str, wanted: set[str] | None, out: dict[str, Any]) -> None:
        for field in self._types[name]:
            full = prefix + name_with_units(field.name)
            if field.count is None and field.type in self._types:
                self._message(cursor, field.type, full + '.', wanted, out)
            elif wanted is None or full in wanted:
                out[full] = self._value(cursor, field)
            else:
                self._skip(cursor, field)

    def _value(self, cursor: _Cursor, field: Field) -> Any:
        if field.count is None:
            return self._single(cursor, field.type)
        count = cursor.number('I') if field.count < 0 else field.count
        if field.type in BASIC:
            return cursor.numbers(field.type, count)
        return [self._single(cursor, field.type) for _ in range(count)]

    def _skip(self, cursor: _Cursor, field: Field) -> None:
        if field.type in BASIC and field.count is not None:
            cursor.skip(field.type, cursor.number('I') if field.count < 0 else field.count)
        else:
            self._value(cursor, field)

    def _single(self, cursor: _Cursor, name: str) -> Any:
        if name == 'string':
            return cursor.text()
        if name in BASIC:
            value = cursor.number(BASIC[name])
            return bool(value) if name == 'bool' else value
        inner: dict[str, Any] = {}
        self._message(cursor, name, '', None, inner)
        return inner


class _Cursor:
    """A place in the bytes of a message: plain CDR, each number aligned to its size behind the head of four bytes."""

    def __init__(self, data: memoryview) -> None:
        if len(data) < 4 or data[0] != 0 or data[1] not in (0, 1):
            raise ValueError('a message that is no plain CDR')
        self._order: Literal['<', '>'] = '<' if data[1] == 1 else '>'
        self._data = data[4:]
        self._at = 0

    def number(self, code: str) -> Any:
        size = struct.calcsize(code)
        self._at += -self._at % size
        value, = struct.unpack_from(self._order + code, self._data, self._at)
        self._at += size
        return value

    def numbers(self, name: str, count: int) -> np.ndarray:
        kind = np.dtype('?' if name == 'bool' else BASIC[name])
        start = self.skip(name, count)
        return np.frombuffer(self._data, kind.newbyteorder(self._order), count, start).astype(kind)

    def skip(self, name: str, count: int) -> int:
        """Where the numbers begin that end here from now on."""
        size = struct.calcsize(BASIC[name])
        if count > 0:
            self._at += -self._at % size
        start = self._at
        self._at += count * size
        if self._at > len(self._data):
            raise IndexError
        return start

    def text(self) -> str:
        size = self.number('I')
        if size > len(self._data) - self._at:
            raise IndexError
        text = bytes(self._data[self._at:self._at + max(size - 1, 0)])
        self._at += size
        return text.decode('utf-8', 'replace')

"""Records of stilt record as numpy arrays and pandas tables, one per topic."""
from __future__ import annotations

import collections
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from stilt.errors import RecordError
from stilt.mcap import Message, Reader
from stilt.messages import BASIC, Decoder, Field, Types, name_with_units, parse_definition

WIRE_VERSION = 3  # of the messages, kWireVersion of firmware/telemetry/wire_version.h

JOINTS = ('hip_L', 'knee_L', 'hip_R', 'knee_R')
STATES = ('x_b_m', 'z_b_m', 'pitch_b_rad', 'hip_L_rad', 'knee_L_rad', 'hip_R_rad', 'knee_R_rad',
          'x_b_m_s', 'z_b_m_s', 'pitch_b_rad_s', 'hip_L_rad_s', 'knee_L_rad_s', 'hip_R_rad_s', 'knee_R_rad_s')

CONFIGURATION = '/stilt/configuration'
TICKS = '/stilt/ticks'
GAPS_NAMED = 5  # in one sentence

# Fields that times and runs take, asked for or not.
NEEDED = {'run_id', 'first_tick', 'count', 'time_ns', 'time_s', 'start_time_s', 'header.stamp.sec',
          'header.stamp.nanosec'}


class Record:
    """A record of stilt record.

        record = stilt.Record('walk.mcap')
        record.topics                             # {'/stilt/ticks': 521, '/joint_states': 1301, ...}
        record.frame('/stilt/ticks')              # a pandas.DataFrame with a row per tick
        record.arrays('/stilt/plan')              # numpy arrays by the names of the fields

    Names of fields are those of firmware/telemetry/stilt_msgs.idl, with their units. The definitions come from the
    file, so that fields of a newer release are read as well.

    Raises RecordError with one sentence for a file that is no record, is cut off or damaged, or has messages of another
    release. With partial=True a record that was cut off is read as far as it goes, without the topics whose messages
    cannot be decoded. `problems` names both, and ticks that are missing, with which a record is read as any other.
    """

    def __init__(self, path: str | Path, partial: bool = False) -> None:
        self.path = str(path)
        self.topics: dict[str, int] = {}
        """Number of messages of each topic."""
        self._types: dict[str, tuple[Types, str]] = {}
        self._starts: dict[int, tuple[int, int]] = {}  # of each run: clock and time of day of tick 0, nanoseconds
        self._lockstep = False  # in one of the runs
        self._defects: dict[str, str] = {}  # of each topic whose messages cannot be decoded
        self._received: dict[int, _Received] = {}  # ticks of each run
        reader = Reader(self.path)
        for message in reader.messages():
            self._look_at(message)
        self.problems: list[str] = [*reader.problems, *self._defects.values()]
        """What is wrong with the file or missing in it, one sentence each."""
        if self.problems and not partial:
            raise RecordError(f'{self.problems[0]}; stilt.Record(path, partial=True) reads what is there')
        self.problems += [f'{self.path}: {_listed(received.gaps)} of run {run} are missing'
                          for run, received in self._received.items() if received.gaps]
        self.attachments: dict[str, str] = reader.attachments
        """Texts in the record by name: configuration_RUN.toml, ROBOT.urdf."""
        self.metadata: dict[str, str] = dict(reader.metadata[-1][1]) if reader.metadata else {}
        """robot, version, compiler and so on of the last run."""

    @property
    def runs(self) -> list[int]:
        """The numbers of the runs of stiltd in this record, in the order in which they began."""
        return list(self._starts)

    def missing(self, run: int | None = None) -> list[tuple[int, int]]:
        """First and last number of each gap in the ticks of a run, before the last tick that is in the record. The
        ticks of a gap did not reach the recorder, or it started later than stiltd."""
        run = self._chosen(run)
        return list(self._received[run].gaps) if run in self._received else []

    def start_time_ns(self, run: int | None = None) -> int:
        """Time of day of tick 0, nanoseconds since 1970."""
        return self._starts[self._chosen(run)][1]

    def arrays(self, topic: str, fields: str | Iterable[str] | None = None,
               run: int | None = None) -> dict[str, np.ndarray]:
        """The fields of a topic by name, all with as many rows as there are messages, or ticks.

        topic   such as '/stilt/ticks'
        fields  the one or the ones to read, such as 'estimated_state'; None: all
        run     number of a run, for a record with several. Messages that do not name their run are chosen by time;
                RecordError where that is not possible

        time_s holds seconds since tick 0 (NaN for messages without a time), log_time_ns the time of arrival since 1970.
        A field with a fixed number of values has two dimensions: joints in the order hip_L, knee_L, hip_R, knee_R,
        states in that of docs/conventions.md. A sequence of any length is an array, or a list, per row.
        """
        types, name = self._type_of(topic)
        wanted = None if fields is None else _names(fields)
        if wanted is not None:
            known = {_shown(key, field) for key, field in _columns(types, name).items()} | {'time_s', 'log_time_ns'}
            known |= {'tick'} if _is_batch(types, name) else set()
            for field in sorted(wanted - known):
                raise KeyError(f'{topic} has no field {field}; it has {", ".join(sorted(known))}')
        names_run = 'run_id' in _columns(types, name) and self._starts
        chosen = self._chosen(run) if names_run or run is not None else None
        read = self._ticks if _is_batch(types, name) else self._messages
        columns = read(topic, types, name, chosen, None if wanted is None else wanted | NEEDED)
        return {key: values for key, values in columns.items() if wanted is None or key in wanted}

    def frame(self, topic: str, fields: str | Iterable[str] | None = None, run: int | None = None) -> pd.DataFrame:
        """As arrays(), as a table with the index time_s. A field with several values has a column for each:
        joint_position_rad gives hip_L_position_rad and so on, as ticks.csv of stilt log csv names them."""
        asked = None if fields is None else _names(fields) | {'time_s'}
        arrays = self.arrays(topic, asked, run)
        columns: dict[str, Any] = {}
        for name, values in arrays.items():
            if values.ndim == 1:
                columns[name] = values
            else:
                columns.update({column: values[:, k] for k, column in enumerate(column_names(name, values.shape[1]))})
        return pd.DataFrame(columns).set_index('time_s')

    def configuration(self, run: int | None = None) -> str:
        """Every key of the configuration that a run began with, TOML."""
        return self.attachments[f'configuration_{self._chosen(run)}.toml']

    def _look_at(self, message: Message) -> None:
        """Counts a message, and takes what the first pass is for."""
        topic, schema = message.channel.topic, message.channel.schema
        self.topics[topic] = self.topics.get(topic, 0) + 1
        if topic in self._defects:
            return
        try:
            if schema is None:
                raise ValueError('the type of its messages is not defined')
            if schema.encoding != 'ros2msg' or message.channel.encoding != 'cdr':
                raise ValueError(f'its messages are {message.channel.encoding} defined by {schema.encoding}, '
                                 'where cdr defined by ros2msg can be read')
            if topic not in self._types:
                self._types[topic] = (parse_definition(schema.text, schema.name), schema.name)
            if topic == CONFIGURATION:
                self._configuration(message)
            elif topic == TICKS:
                self._count(message)
        except RecordError:
            raise
        except ValueError as error:
            self._defects[topic] = f'{self.path}: {topic}: {error}'

    def _configuration(self, message: Message) -> None:
        types, name = self._types[CONFIGURATION]
        if all(field.name != 'wire_version' for field in types[name]):
            raise RecordError(f'{self.path}: has the messages of release 0.1, {self._needed()}')
        values = Decoder(types, name).decode(message.data)
        if values['wire_version'] != WIRE_VERSION:
            raise RecordError(f'{self.path}: has messages of wire version {values["wire_version"]}, {self._needed()}')
        self._starts.setdefault(values['run_id'], (values['start_clock_ns'], values['start_time_ns']))
        self._lockstep = self._lockstep or values['lockstep']

    def _count(self, message: Message) -> None:
        """Notes which ticks a batch has, without a look at their values."""
        types, name = self._types[TICKS]
        wanted = {'run_id', 'first_tick', 'count'}
        if not wanted <= {field.name for field in types[name]}:
            return
        end = max(at for at, field in enumerate(types[name], 1) if field.name in wanted)
        values = Decoder({**types, name: types[name][:end]}, name).decode(message.data, wanted)
        self._received.setdefault(values['run_id'], _Received()).add(values['first_tick'], values['count'])

    @staticmethod
    def _needed() -> str:
        return f'but this package reads wire version {WIRE_VERSION}; use that of the release that recorded them'

    def _type_of(self, topic: str) -> tuple[Types, str]:
        if topic in self._defects:
            raise RecordError(self._defects[topic])
        if topic not in self._types:
            raise KeyError(f'{self.path} has no messages of {topic}; it has {", ".join(sorted(self._types))}')
        return self._types[topic]

    def _chosen(self, run: int | None) -> int:
        if run is None and len(self._starts) == 1:
            return next(iter(self._starts))
        if run in self._starts:
            return run
        held = ', '.join(map(str, self._starts)) or 'none'
        raise RecordError(f'{self.path}: the runs in it are {held}; name one of them with run=')

    def _decoded(self, topic: str, types: Types, name: str, run: int | None,
                 wanted: set[str] | None) -> Iterator[tuple[Message, dict[str, Any]]]:
        decoder = Decoder(types, name)
        for message in Reader(self.path).messages():
            if message.channel.topic != topic:
                continue
            try:
                values = decoder.decode(message.data, wanted)
            except ValueError as error:
                raise RecordError(f'{self.path}: {topic}: {error}') from error
            if run is None or values.get('run_id', run) == run:
                yield message, values

    def _messages(self, topic: str, types: Types, name: str, run: int | None,
                  wanted: set[str] | None) -> dict[str, np.ndarray]:
        rows: dict[str, list[Any]] = collections.defaultdict(list)
        for message, values in self._decoded(topic, types, name, run, wanted):
            rows['log_time_ns'].append(message.log_time_ns)
            for key, value in values.items():
                rows[key].append(value)
        times_ns = np.array(rows.pop('log_time_ns', []), np.int64)
        columns = {_shown(key, field): _column(rows.get(key, []), field)
                   for key, field in _columns(types, name).items() if wanted is None or key in wanted}
        stamps_ns = _stamps_ns(columns)
        columns = {'time_s': self._time_s(columns, stamps_ns, run, len(times_ns)), 'log_time_ns': times_ns,
                   **{key: values for key, values in columns.items() if key != 'time_s'}}
        if run is None or 'run_id' in columns or len(self._starts) == 1:
            return columns
        rows_of_run = self._rows_of_run(topic, times_ns if self._lockstep else stamps_ns, run)
        return {key: values[rows_of_run] for key, values in columns.items()}

    def _time_s(self, columns: dict[str, np.ndarray], stamps_ns: np.ndarray | None, run: int | None,
                rows: int) -> np.ndarray:
        """Seconds since tick 0, of the first run where neither a message nor the caller names one."""
        for name in ('time_s', 'start_time_s'):
            if name in columns:
                return columns[name]
        if stamps_ns is None or not self._starts:
            return np.full(rows, np.nan)
        return 1e-9 * (stamps_ns - self._starts[self.runs[0] if run is None else run][1])

    def _rows_of_run(self, topic: str, times_ns: np.ndarray | None, run: int) -> slice:
        """Of messages that do not name their run: those from its start to that of the next run. Their times are stamps,
        by the clock of the starts. In lock-step stamps run ahead of that clock, and the times are those of arrival."""
        if times_ns is None:
            raise RecordError(f'{self.path}: the messages of {topic} have neither run nor time; leave run= out')
        if (np.diff(times_ns) < 0).any():
            raise RecordError(f'{self.path}: the messages of {topic} do not name their run, and their times go back; '
                              'leave run= out')
        start_ns = self._starts[run][1]
        later_ns = [other_ns for _, other_ns in self._starts.values() if other_ns > start_ns]
        first, end = np.searchsorted(times_ns, [start_ns, min(later_ns, default=np.iinfo(np.int64).max)])
        return slice(first, end)

    def _ticks(self, topic: str, types: Types, name: str, run: int | None,
               wanted: set[str] | None) -> dict[str, np.ndarray]:
        """A row per tick: a batch holds the values of `count` ticks, one after the other. Late joiners of the recorder
        get batches twice; the second are left out."""
        parts: dict[str, list[np.ndarray]] = collections.defaultdict(list)
        per_tick = {key: field for key, field in _columns(types, name).items()
                    if field.count == -1 and (wanted is None or key in wanted)}
        following = 0
        for message, values in self._decoded(topic, types, name, run, wanted):
            count, first = values['count'], values['first_tick']
            skipped = min(max(following - first, 0), count)
            if skipped == count:
                continue
            following = first + count
            ticks = np.arange(first + skipped, following, dtype=np.int64)
            parts['tick'].append(ticks)
            parts['log_time_ns'].append(np.full(len(ticks), message.log_time_ns, np.int64))
            for key in per_tick:
                if len(values[key]) % count:
                    raise RecordError(f'{self.path}: {topic}: {key} has {len(values[key])} values of {count} ticks')
                parts[key].append(values[key].reshape(count, -1)[skipped:])
        columns = {key: np.concatenate(part) for key, part in parts.items()}
        if not columns:
            columns = {'tick': np.empty(0, np.int64), 'log_time_ns': np.empty(0, np.int64),
                       **{key: np.empty(0, BASIC[field.type]) for key, field in per_tick.items()}}
        columns = {key: values[:, 0] if values.ndim == 2 and values.shape[1] == 1 else values
                   for key, values in columns.items()}
        start_ns = self._starts[run][0] if run in self._starts else min(columns['time_ns'], default=0)
        return {'tick': columns.pop('tick'), 'time_s': 1e-9 * (columns['time_ns'] - start_ns), **columns}


class _Received:
    """Ticks of a run in the order of their arrival, as TickLedger of stilt record counts them."""

    def __init__(self) -> None:
        self.gaps: list[tuple[int, int]] = []  # first and last tick that are missing
        self._following = 0

    def add(self, first: int, count: int) -> None:
        if first + count <= self._following:
            return
        if first > self._following:
            self.gaps.append((self._following, first - 1))
        self._following = first + count


def _listed(gaps: list[tuple[int, int]]) -> str:
    words = [f'{first} to {last}' if last > first else str(first) for first, last in gaps[:GAPS_NAMED]]
    more = f' and {len(gaps) - GAPS_NAMED} more gaps' if len(gaps) > GAPS_NAMED else ''
    return f'ticks {", ".join(words)}{more}'


def column_names(field: str, count: int) -> list[str]:
    """Columns of a field with several values: those of ticks.csv for joints and states, else field_0, field_1, ..."""
    if count == len(STATES) and field.endswith('_state'):
        return [f'{field.removesuffix("state")}{state}' for state in STATES]
    if count != len(JOINTS):
        return [f'{field}_{k}' for k in range(count)]
    first, _, rest = field.partition('_')
    if first == 'joint':
        return [f'{joint}_{rest}' for joint in JOINTS]
    if first in ('wanted', 'sent'):
        return [f'{first}_{joint}_{rest}' for joint in JOINTS]
    return [f'{joint}_{field}' for joint in JOINTS]


def _names(fields: str | Iterable[str]) -> set[str]:
    return {fields} if isinstance(fields, str) else set(fields)


def _columns(types: Types, name: str, prefix: str = '') -> dict[str, Field]:
    """Fields of a message and of the messages in it, by their full names."""
    columns: dict[str, Field] = {}
    for field in types[name]:
        full = prefix + name_with_units(field.name)
        if field.count is None and field.type in types:
            columns.update(_columns(types, field.type, full + '.'))
        else:
            columns[full] = field
    return columns


def _stamps_ns(columns: dict[str, np.ndarray]) -> np.ndarray | None:
    """Times of day in the headers of messages that have one."""
    if 'header.stamp.sec' not in columns:
        return None
    return columns['header.stamp.sec'].astype(np.int64) * 1_000_000_000 + columns['header.stamp.nanosec']


def _shown(name: str, field: Field) -> str:
    """The name under which a field is returned: time_s is that of the message, so those of its nodes have another."""
    return 'node_time_s' if name == 'time_s' and field.count == -1 else name


def _is_batch(types: Types, name: str) -> bool:
    """Whether a message holds several ticks."""
    return {'first_tick', 'count', 'time_ns'} <= {field.name for field in types[name]}


def _column(values: list[Any], field: Field) -> np.ndarray:
    if field.type in BASIC and field.count is None:
        return np.array(values, '?' if field.type == 'bool' else BASIC[field.type])
    if field.type in BASIC and field.count is not None and field.count > 0 and values:
        return np.stack(values)
    column = np.empty(len(values), object)
    for row, value in enumerate(values):
        column[row] = value
    return column

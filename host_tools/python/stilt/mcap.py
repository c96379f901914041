"""Reader of MCAP files (https://mcap.dev/spec): messages of all chunks in order, attachments, metadata."""
from __future__ import annotations

import dataclasses
import os
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

from stilt.errors import RecordError

MAGIC = b'\x89MCAP0\r\n'
RECORD_HEAD = struct.Struct('<BQ')
LARGEST_CHUNK_BYTES = 1 << 30  # recorders write chunks of some megabytes

# Kinds of records; the index and the summary at the end of a file repeat what this reader has read by then.
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, ATTACHMENT, METADATA = 0x02, 0x03, 0x04, 0x05, 0x06, 0x09, 0x0C


@dataclasses.dataclass(frozen=True)
class Schema:
    """The definition of a type of messages."""
    name: str
    encoding: str
    text: str


@dataclasses.dataclass(frozen=True)
class Channel:
    """A topic and the schema of its messages; the schema is None where the file has none."""
    topic: str
    encoding: str
    schema: Schema | None


@dataclasses.dataclass(frozen=True)
class Message:
    """One message as it was received."""
    channel: Channel
    log_time_ns: int  # of its arrival, nanoseconds since 1970
    data: memoryview


class _Fields:
    """Takes the fields of a record one after the other."""

    def __init__(self, data: memoryview) -> None:
        self.data = data
        self.at = 0

    def number(self, code: str) -> int:
        value, = struct.unpack_from('<' + code, self.data, self.at)
        self.at += struct.calcsize('<' + code)
        return value

    def raw(self, size: int) -> memoryview:
        if size > len(self.data) - self.at:
            raise ValueError('a record whose parts are longer than itself')
        self.at += size
        return self.data[self.at - size:self.at]

    def text(self) -> str:
        return bytes(self.raw(self.number('I'))).decode('utf-8', 'replace')

    def texts(self) -> dict[str, str]:
        end = self.number('I') + self.at
        entries = {}
        while self.at < end:
            key = self.text()
            entries[key] = self.text()
        return entries

    def rest(self) -> memoryview:
        return self.raw(len(self.data) - self.at)


def _decompress(data: memoryview, compression: str, size: int) -> bytes | memoryview:
    """The records of a chunk, `size` bytes."""
    if compression == '':
        return data
    if size > LARGEST_CHUNK_BYTES:
        raise ValueError(f'a chunk would be of {size} bytes; at most {LARGEST_CHUNK_BYTES} are read')
    name = {'zstd': 'zstandard', 'lz4': 'lz4.frame'}.get(compression)
    if name is None:
        raise ValueError(f'a chunk with the compression "{compression}"; zstd, lz4 and none are read')
    try:
        module = __import__(name, fromlist=['x'])
    except ModuleNotFoundError as error:
        package = {'zstd': 'python3-zstandard', 'lz4': 'python3-lz4'}[compression]
        raise RecordError(f'the record is compressed with {compression}, which takes the package {package}; '
                          f'apt install {package}') from error
    try:
        if compression == 'zstd':
            return module.ZstdDecompressor().decompress(bytes(data), max_output_size=size)
        return module.decompress(bytes(data))
    except Exception as error:  # each library has exceptions of its own
        raise ValueError('a chunk that cannot be decompressed') from error


class Reader:
    """One pass over a file. What is wrong with it is in `problems`, a sentence each, once the pass has ended."""

    def __init__(self, path: str | Path) -> None:
        self.path = str(path)
        self.problems: list[str] = []
        self.attachments: dict[str, str] = {}
        self.metadata: list[tuple[str, dict[str, str]]] = []
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}

    def messages(self) -> Iterator[Message]:
        """The messages in the order of the file. Raises RecordError for a file that is no MCAP file."""
        try:
            file = open(self.path, 'rb')
        except OSError as error:
            raise RecordError(f'{self.path}: cannot be read ({error.strerror}); '
                              'name a record of stilt record') from error
        with file:
            end = os.fstat(file.fileno()).st_size
            if self._read(file, len(MAGIC)) != MAGIC:
                raise RecordError(f'{self.path}: is no MCAP file; name a record of stilt record')
            while True:
                place = file.tell()
                head = self._read(file, RECORD_HEAD.size)
                if len(head) < RECORD_HEAD.size:
                    self.problems.append(f'{self.path}: was cut off at byte {place}, recording did not end in order')
                    return
                kind, size = RECORD_HEAD.unpack(head)
                body = self._read(file, size) if size <= end - file.tell() else b''
                if len(body) < size:
                    self.problems.append(f'{self.path}: was cut off in the record at byte {place}, '
                                         'recording did not end in order')
                    return
                if kind == FOOTER:
                    return
                try:
                    yield from self._take(kind, memoryview(body))
                except (ValueError, struct.error) as error:
                    if isinstance(error, RecordError):
                        raise
                    self.problems.append(f'{self.path}: {error} (record at byte {place})')

    def _read(self, file, size: int) -> bytes:
        try:
            return file.read(size)
        except (OSError, MemoryError) as error:
            raise RecordError(f'{self.path}: cannot be read ({str(error) or "too little memory"})') from error

    def _take(self, kind: int, body: memoryview) -> Iterator[Message]:
        fields = _Fields(body)
        if kind == SCHEMA:
            number = fields.number('H')
            self._schemas.setdefault(number, Schema(fields.text(), fields.text(), fields.text()))
        elif kind == CHANNEL:
            number, schema = fields.number('H'), fields.number('H')
            self._channels.setdefault(number, Channel(fields.text(), fields.text(), self._schemas.get(schema)))
        elif kind == MESSAGE:
            raise ValueError('a message outside of a chunk, where no check sum covers it')
        elif kind == CHUNK:
            yield from self._chunk(fields)
        elif kind == ATTACHMENT:
            self._attachment(fields)
        elif kind == METADATA:
            self.metadata.append((fields.text(), fields.texts()))

    def _chunk(self, fields: _Fields) -> Iterator[Message]:
        fields.raw(16)  # times of the first and the last message
        size, check_sum = fields.number('Q'), fields.number('I')
        compression = fields.text()
        data = memoryview(_decompress(fields.raw(fields.number('Q')), compression, size))
        if check_sum not in (0, zlib.crc32(data)):
            raise ValueError("a chunk's check sum is wrong")
        records = _Fields(data)
        first_defect = None  # a record that cannot be read leaves the others of its chunk
        while records.at < len(data):
            kind = records.number('B')
            body = records.raw(records.number('Q'))
            try:
                if kind == MESSAGE:
                    yield self._message(_Fields(body))
                elif kind in (SCHEMA, CHANNEL):
                    yield from self._take(kind, body)
            except (ValueError, struct.error) as error:
                first_defect = first_defect or error
        if first_defect:
            raise first_defect

    def _message(self, fields: _Fields) -> Message:
        number = fields.number('H')
        fields.raw(4)  # sequence
        log_time_ns = fields.number('Q')
        fields.raw(8)  # publish time
        if number not in self._channels:
            raise ValueError('a message of an unknown channel')
        return Message(self._channels[number], log_time_ns, fields.rest())

    def _attachment(self, fields: _Fields) -> None:
        fields.raw(16)  # times
        name = fields.text()
        fields.text()  # media type
        text = bytes(fields.raw(fields.number('Q'))).decode('utf-8', 'replace')
        if zlib.crc32(fields.data[:fields.at]) != fields.number('I'):
            raise ValueError("an attachment's check sum is wrong")
        self.attachments[name] = text

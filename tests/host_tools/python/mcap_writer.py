"""Writes small MCAP files for tests, as https://mcap.dev/spec has them."""
from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from pathlib import Path

MAGIC = b'\x89MCAP0\r\n'


def _text(text: str) -> bytes:
    return struct.pack('<I', len(text.encode())) + text.encode()


def _record(kind: int, body: bytes) -> bytes:
    return struct.pack('<BQ', kind, len(body)) + body


def write(path: Path, messages: list[tuple[str, str, str, bytes]], compression: str = '',
          compress: Callable[[bytes], bytes] = bytes, per_chunk: int = 1, encoding: str = 'cdr') -> None:
    """Messages are (topic, type, definition, CDR bytes); log times count from 1 ns."""
    channels: dict[str, int] = {}
    out = [MAGIC, _record(0x01, _text('') + _text('test'))]
    records = b''
    for number, (topic, name, definition, data) in enumerate(messages, 1):
        if topic not in channels:
            channel = channels[topic] = len(channels) + 1
            records += _record(0x03, struct.pack('<H', channel) + _text(name) + _text('ros2msg') + _text(definition))
            records += _record(0x04, struct.pack('<HH', channel, channel) + _text(topic) + _text(encoding) + _text(''))
        records += _record(0x05, struct.pack('<HIQQ', channels[topic], number, number, number) + data)
        if number % per_chunk and number < len(messages):
            continue
        packed = compress(records)
        out.append(_record(0x06, struct.pack('<QQQI', number, number, len(records), zlib.crc32(records)) +
                           _text(compression) + struct.pack('<Q', len(packed)) + packed))
        records = b''
    out += [_record(0x02, bytes(20)), MAGIC]
    path.write_bytes(b''.join(out))

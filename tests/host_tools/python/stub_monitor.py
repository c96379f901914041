"""A monitor without a robot: a WebSocket server that sends what a test gives it, and keeps what a client sends."""
from __future__ import annotations

import base64
import hashlib
import json
import socket
import struct
import threading
import time
from typing import Any

PATIENCE_S = 60
TEXT, BINARY, CLOSE = 1, 2, 8  # opcodes, RFC 6455
GREETING = (
    {'type': 'hello', 'live': True, 'columns': {'ticks': ['time_s', 'height_m']}, 'faults': [],
     'states': [{'name': 'stand'}], 'fallback_levels': [{'name': 'plan'}]},
    {'type': 'access'},
    {'type': 'configuration', 'run_id': '000000000000000a', 'toml': ''},
    {'type': 'supervisor', 'time_s': 0.0, 'state': 0, 'fallback_level': 0, 'present': 0, 'latched': 0, 'found': {},
     'speed_m_s': 0.0, 'base_height_m': 0.78},
)


class StubMonitor:
    """Greets one client like a live monitor whose robot stands, takes all commands, and sends no more by itself.

    forged   reason of a refusal without proof that comes before each reply; empty: none does
    answers  whether a reply comes
    """

    def __init__(self) -> None:
        self._listener = socket.create_server(('127.0.0.1', 0))
        self.address = f'http://127.0.0.1:{self._listener.getsockname()[1]}'
        self._changed = threading.Condition()
        self.forged, self.answers = '', True
        self._received: list[tuple[float, dict[str, Any]]] = []
        threading.Thread(target=self._serve, daemon=True).start()

    def send(self, message: dict[str, Any]) -> None:
        self._frame(TEXT, json.dumps(message).encode())

    def send_ticks(self, base_s: float, rows: list[tuple[float, ...]]) -> None:
        """A table of ticks (host_tools/web/monitor/table_message.h)."""
        values = [value for row in rows for value in row]
        self._frame(BINARY, struct.pack(f'<B3xIdd{len(values)}f', 1, len(rows), base_s, 0.0, *values))

    def arrivals(self, key: str, count: int) -> list[float]:
        """Waits for the first `count` messages with a key; when each arrived, s."""
        def times() -> list[float]:
            return [time_s for time_s, message in self._received if key in message]
        with self._changed:
            if not self._changed.wait_for(lambda: len(times()) >= count, PATIENCE_S):
                raise AssertionError(f'{len(times())} instead of {count} messages with {key}')
            return times()[:count]

    def commands(self) -> list[str]:
        return [message['command'] for _, message in self._received if 'command' in message]

    def values(self, key: str) -> list[Any]:
        """Of the commands, in their order; None where a command has no such key."""
        return [message.get(key) for _, message in self._received if 'command' in message]

    def hang_up(self) -> None:
        """Ends the connection."""
        self._client.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        self._listener.close()
        self._client.close()

    def _serve(self) -> None:
        self._client, _ = self._listener.accept()
        self._stream = self._client.makefile('rb')
        fields = dict(line.decode().strip().split(': ', 1) for line in iter(self._stream.readline, b'\r\n') if b': ' in line)
        key = fields['Sec-WebSocket-Key'] + '258EAFA5-E914-47DA-95CA-C5AB0DC85B11'
        accept = base64.b64encode(hashlib.sha1(key.encode()).digest()).decode()
        self._client.sendall('\r\n'.join(['HTTP/1.1 101 Switching Protocols', 'Upgrade: websocket', 'Connection: Upgrade',
                                          f'Sec-WebSocket-Accept: {accept}', '', '']).encode())
        for message in GREETING:
            self.send(message)
        try:
            while self._receive():
                pass
        except (OSError, ValueError, struct.error):
            pass  # the connection is closed

    def _frame(self, opcode: int, data: bytes) -> None:
        size = bytes([len(data)]) if len(data) < 126 else struct.pack('>BH', 126, len(data))
        self._client.sendall(bytes([0x80 | opcode]) + size + data)

    def _receive(self) -> bool:
        """Takes a frame of the client, which is masked and short."""
        opcode, size = self._stream.read(2)
        size &= 0x7f
        if size == 126:
            size = struct.unpack('>H', self._stream.read(2))[0]
        mask = self._stream.read(4)
        data = bytes(byte ^ mask[k % 4] for k, byte in enumerate(self._stream.read(size)))
        if opcode & 0xf == CLOSE:
            return False
        message = json.loads(data)
        with self._changed:
            self._received.append((time.monotonic(), message))
            self._changed.notify_all()
        if 'command' in message:
            reply = {'type': 'reply', 'sequence': message['sequence'], 'accepted': True, 'reason': '', 'proven': True}
            if self.forged:
                self.send({**reply, 'accepted': False, 'reason': self.forged, 'proven': False})
                time.sleep(0.1)  # so that the client has taken it
            if self.answers:
                self.send(reply)
        return True

"""Commands to a robot, over the WebSocket of its monitor (host_tools/web/monitor/page_messages.h)."""
from __future__ import annotations

import collections
import dataclasses
import json
import math
import struct
import threading
import time
from typing import Any
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pandas as pd

from stilt.errors import Refused, RobotError
from stilt.token import read_token, token_path

ALIVE_PERIOD_S = 0.1  # sign of life; the robot begins to stop 0.9 s after the last one
SILENCE_S = 1.0  # without a tick, after which the robot counts as silent
KEPT_S = 60.0  # of ticks, for recent()
OWN_REPLY_S = 1.0  # for the robot's own reply after a refusal that does not prove the token

MOVES = {'stand': True, 'step': True, 'walk': True, 'sit': False, 'cut': False}  # orders; whether a stop shall end them

TABLE_HEAD = struct.Struct('<B3xIdd')  # kind, rows, base time, first number
TABLE_KINDS = {1: 'ticks', 2: 'planner', 3: 'plan', 4: 'truth'}


@dataclasses.dataclass(frozen=True)
class RobotState:
    """What the supervisor of a robot reported last."""
    time_s: float  # since tick 0
    state: str  # idle, stand, walk, ...
    fallback_level: str
    faults: tuple[str, ...]  # names of those that are present or latched
    found: tuple[str, ...]  # of each of them joint, condition, value and limit, in words
    speed_m_s: float  # asked of the planner
    base_height_m: float  # of the hip, as the planner uses it


class Robot:
    """A robot that is commanded. Open it with `with`: leaving the block stops the robot, after an exception as well. A
    robot that was asked to sit goes on sitting down.

        with stilt.Robot() as robot:
            robot.stand()
            robot.walk(0.3)          # m/s
            robot.wait(10.0)         # s

    address     of the monitor: 'http://127.0.0.1:8080', or the link that stilt monitor prints, with its key
    token       of the run, else taken from token_file
    token_file  its file, else the one that stiltd writes for this user in this DDS domain. Not used with a key
    patience_s  for answers of monitor and robot, seconds

    While it is open, signs of life leave ten times per second. When the program ends, is killed or is suspended, the
    robot begins to stop within a second: it steps in place, then stands.

    A command leaves with the newest time that the monitor sent. When that is older than 0.5 s on arrival, the network or
    the program stood still. Then the monitor refuses all but stop and motors_off.

    Raises Refused with the robot's reason when it does not take a command, RobotError when it cannot be reached.
    Raises ValueError for a value that is not finite; a wait may be infinite.
    """

    def __init__(self, address: str = 'http://127.0.0.1:8080', *, token: str | None = None,
                 token_file: str | None = None, domain: int = 0, patience_s: float = 10.0) -> None:
        parts = urlsplit(address if '://' in address else f'http://{address}')
        key = parse_qs(parts.fragment).get('key', [''])[0]
        self._token = token or ('' if key else read_token(token_file or token_path(domain)))
        self._address = f'{parts.scheme}://{parts.netloc}'
        self._patience_s = patience_s
        self._changed = threading.Condition()
        self._problem = ''
        self._hello: dict[str, Any] = {}
        self._access: dict[str, Any] = {}
        self._configuration: dict[str, Any] = {}
        self._supervisor: dict[str, Any] = {}
        self._silent_s = 0.0
        self._link_time_s: float | None = None
        self._received_s = time.monotonic()
        self._replies: dict[int, dict[str, Any]] = {}
        self._doubts: dict[int, str] = {}  # reasons of refusals that do not prove the token: anybody may send them
        self._sequence = 0
        self._moves = False  # leaving the block stops it
        self._closed = threading.Event()
        self._ticks: collections.deque[tuple[float, np.ndarray]] = collections.deque()
        self._socket = self._connect(parts.scheme)
        for work in (self._receive, self._beat):
            threading.Thread(target=work, daemon=True).start()
        try:
            self._send({'key': key or 'none'})
            self._until(lambda: self._hello and self._access, 'the monitor sends nothing')
            if not self._hello['live']:
                raise RobotError(f'{self._address}: shows a record, which takes no commands')
            self._until(lambda: self._configuration and self._supervisor, 'no robot sends to the monitor; start stiltd')
        except BaseException:
            self.close()
            raise

    def _connect(self, scheme: str) -> Any:
        try:
            import websocket
        except ModuleNotFoundError as error:
            raise RobotError('commands take the package python3-websocket; apt install python3-websocket') from error
        url = f'{ {"https": "wss"}.get(scheme, "ws") }://{urlsplit(self._address).netloc}/live'
        try:
            socket = websocket.create_connection(url, timeout=self._patience_s, enable_multithread=True)
        except (OSError, ValueError, websocket.WebSocketException) as error:
            raise RobotError(f'{self._address}: no monitor answers ({error}); start stilt monitor') from error
        socket.settimeout(None)
        return socket

    def __enter__(self) -> Robot:
        return self

    def __exit__(self, *_: object) -> None:
        try:
            if self._moves and not self._problem:
                self.stop()
        except RobotError:
            pass  # without signs of life it comes to a stand by itself
        finally:
            self.close()

    def close(self) -> None:
        """Ends the connection; a robot that moves comes to a stand."""
        self._closed.set()
        self._lose('the connection to the monitor is closed')
        self._socket.shutdown()

    @property
    def state(self) -> RobotState:
        """What the robot reported last. Raises RobotError when it is silent or the connection is lost or closed."""
        with self._changed:
            self._check()
            now, hello = self._supervisor, self._hello
        rows = [row['name'] for bit, row in enumerate(hello['faults']) if (now['present'] | now['latched']) >> bit & 1]
        return RobotState(now['time_s'], hello['states'][now['state']]['name'],
                          hello['fallback_levels'][now['fallback_level']], tuple(rows),
                          tuple(now['found'].get(name, '') for name in rows), now['speed_m_s'], now['base_height_m'])

    @property
    def configuration(self) -> str:
        """Every key of the configuration of this run, TOML."""
        return self._configuration['toml']

    def stand(self, timeout_s: float = 30.0) -> None:
        """Brings the drivers up if need be, and waits until the robot stands."""
        self._ask('stand')
        self.wait_for('stand', timeout_s)

    def step(self, timeout_s: float = 10.0) -> None:
        """Steps in place, and waits until the robot does; it must stand, step or walk."""
        self._ask('step')
        self.wait_for('step', timeout_s)

    def walk(self, speed_m_s: float, timeout_s: float = 10.0) -> None:
        """Walks, backward with a negative speed, and waits until the robot does; it must stand, step or walk."""
        self._ask('walk', value=float(speed_m_s))
        self.wait_for('walk', timeout_s)

    def set_height(self, height_m: float) -> None:
        """Sets the height of the hip above the ground."""
        self._ask('height', value=float(height_m))

    def tune(self, key: str, value: float) -> None:
        """Changes a live tunable, such as 'torque_law.joint_kp_Nm_rad'; docs/tuning.md lists them."""
        self._ask('tunable', tunable=key, value=float(value))

    def stop(self) -> None:
        """Stops walking: the robot steps in place and stands. No emergency stop."""
        self._ask('stop')

    def sit(self) -> None:
        """Sits down."""
        self._ask('sit')

    def reset(self) -> None:
        """Resets latched faults whose cause is over, and waits until the robot has left the state fault."""
        self._ask('reset')
        self._until(lambda: self.state.state != 'fault', 'the robot is in the state fault although it took a reset')

    def motors_off(self) -> None:
        """Motors off at once, the end of stiltd: a robot on its feet falls."""
        self._ask('cut')

    def wait(self, duration_s: float) -> None:
        """Waits while the robot goes on. Raises RobotError when it has a fault or falls silent meanwhile."""
        end_s = _end_s(duration_s)
        with self._changed:
            while (left_s := end_s - time.monotonic()) > 0.0:
                self._look()
                self._changed.wait(min(left_s, ALIVE_PERIOD_S))
        self._look()

    def wait_for(self, state: str, timeout_s: float = 30.0) -> None:
        """Waits until the robot is in a state, such as 'stand'. Raises RobotError when it has a fault or falls silent
        meanwhile, or does not get there in time."""
        names = [row['name'] for row in self._hello['states']]
        if state not in names:
            raise ValueError(f'{state} is no state; {", ".join(names)} are')
        end_s = _end_s(timeout_s)
        with self._changed:
            while (now := self._look(state).state) != state:
                if time.monotonic() >= end_s:
                    raise RobotError(f'the robot is in the state {now}, not {state}, after {timeout_s:g} s')
                self._changed.wait(ALIVE_PERIOD_S)

    def recent(self) -> pd.DataFrame:
        """The ticks of the last minute of this run at most, with the index time_s (since tick 0) and the columns of the page.
        They are estimated_state0 to 13, measured_torque_Nm0 to 3 and so on, as 32-bit floats."""
        with self._changed:
            parts = list(self._ticks)
        names = self._hello['columns']['ticks']
        if not parts:
            return pd.DataFrame(columns=names).set_index('time_s')
        frame = pd.DataFrame(np.concatenate([rows for _, rows in parts]), columns=names)
        frame['time_s'] = np.concatenate([base_s + rows[:, 0].astype(float) for base_s, rows in parts])
        return frame.set_index('time_s')

    def _check(self) -> None:
        """Raises why the last report is no longer what the robot does."""
        if self._problem:
            raise RobotError(self._problem)
        silent_s = max(self._silent_s, time.monotonic() - self._received_s - SILENCE_S)
        if silent_s > SILENCE_S:
            raise RobotError(f'the robot has been silent for {silent_s:.1f} s')

    def _look(self, wanted: str = '') -> RobotState:
        """What the robot reported last; raises what keeps it from going on."""
        now = self.state
        if now.state == 'fault' and wanted != 'fault':
            what = f'the robot has the fault {" and ".join(now.faults)}'
            raise RobotError('; '.join([what, *filter(None, now.found)]))
        return now

    def _ask(self, command: str, **values: Any) -> None:
        """Sends a command and waits for the reply."""
        if not math.isfinite(value := values.get('value', 0.0)):
            raise ValueError(f'{command}: the value is {value}; give a finite number')
        with self._changed:
            self._sequence += 1
            number = self._sequence
        if self._link_time_s is not None:
            values['link_time_s'] = self._link_time_s  # the monitor refuses what comes late
        self._send({'command': command, 'sequence': number, 'token': self._token, **values})
        self._until(lambda: number in self._replies or number in self._doubts,
                    f'the robot does not answer the command {command}')
        with self._changed:
            self._changed.wait_for(lambda: number in self._replies or self._problem, OWN_REPLY_S)
        doubt = self._doubts.pop(number, '')
        reply = self._replies.pop(number, {'accepted': False, 'reason': f'refused by somebody without this token: {doubt}'})
        if not reply['accepted']:
            raise Refused(f'{command}: {reply["reason"]}')
        self._moves = MOVES.get(command, self._moves)

    def _until(self, done: Any, otherwise: str) -> None:
        with self._changed:
            if self._changed.wait_for(lambda: done() or self._problem, self._patience_s) and not self._problem:
                return
        raise RobotError(self._problem or f'{self._address}: {otherwise}')

    def _send(self, message: dict[str, Any]) -> None:
        try:
            self._socket.send(json.dumps(message))
        except Exception as error:  # of the socket or of the library
            raise RobotError(f'{self._address}: the connection to the monitor is lost ({error})') from error

    def _beat(self) -> None:
        """Signs of life, as long as the thread that runs the program is there."""
        while not self._closed.wait(ALIVE_PERIOD_S) and threading.main_thread().is_alive():
            try:
                self._send({'alive': True})
            except RobotError:
                return

    def _receive(self) -> None:
        try:
            while data := self._socket.recv():
                with self._changed:
                    self._take(data)
                    self._received_s = time.monotonic()
                    self._changed.notify_all()
            reason = 'it ended it'
        except Exception as error:  # of the socket or of the library
            reason = str(error)
        self._lose(f'the connection to the monitor is lost ({reason})')

    def _lose(self, problem: str) -> None:
        """Keeps the first reason why nothing comes any more."""
        with self._changed:
            self._problem = self._problem or f'{self._address}: {problem}'
            self._changed.notify_all()

    def _take(self, data: str | bytes) -> None:
        if isinstance(data, bytes):
            self._table(data)
            return
        message = json.loads(data)
        kind = message['type']
        if kind == 'reply' and not message.get('proven', True):
            self._doubts[message['sequence']] = message['reason']
        elif kind == 'reply':
            self._replies[message['sequence']] = message
        elif kind == 'link':
            self._silent_s, self._link_time_s = message['silent_s'], message['time_s']
        elif kind in ('hello', 'access', 'configuration', 'supervisor'):
            if kind == 'configuration' and message['run_id'] != self._configuration.get('run_id'):
                self._ticks.clear()  # the ticks before are those of an earlier run
            setattr(self, f'_{kind}', message)

    def _table(self, data: bytes) -> None:
        kind, rows, base_s, _ = TABLE_HEAD.unpack_from(data)
        if TABLE_KINDS.get(kind) != 'ticks' or not rows:
            return
        values = np.frombuffer(data, '<f4', offset=TABLE_HEAD.size).reshape(rows, -1)
        self._ticks.append((base_s, values))
        while base_s - self._ticks[0][0] > KEPT_S:
            self._ticks.popleft()


def _end_s(duration_s: float) -> float:
    """When a wait ends, by time.monotonic()."""
    if math.isnan(duration_s):
        raise ValueError('a wait of nan seconds has no end; give a number of seconds')
    return time.monotonic() + duration_s

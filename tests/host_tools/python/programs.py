"""The programs that the tests of the Python package run: simulated robot and stiltd in lock-step, monitor, recorder."""
from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

PATIENCE_S = 120
PACKAGE = Path(__file__).resolve().parents[3] / 'host_tools' / 'python'
sys.path.insert(0, str(PACKAGE))
sys.dont_write_bytecode = True

# A busy machine changes how fast robot and controller take turns, and nothing else.
PATIENT = ('supervisor.torque_loop_stall_s=10', 'supervisor.missed_hold_ticks=500', 'supervisor.missed_damp_ticks=1000',
           'supervisor.stale_plan_s=5', 'supervisor.heartbeat_timeout_s=30', 'supervisor.operator_gone_s=60',
           'telemetry.release_s=60')


class Programs:
    """Programs in a folder of their own, which ends them."""

    def __init__(self, stilt: str, stiltd: str) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix='stilt-python-'))
        self.domain = os.environ['STILT_TEST_DOMAIN']
        self.token_file = self.folder / 'token'
        self._programs = {'stilt': stilt, 'stiltd': stiltd}
        self._buses = [word for side in 'lr' for word in ('--bus', f'loopback:python_{os.getpid()}_{side}')]
        self._running: list[subprocess.Popen] = []

    def start(self, name: str, *words: str | Path) -> subprocess.Popen:
        """Starts a program whose output goes to the file `name`; 'stilt' and 'stiltd' are those of the build."""
        with open(self.folder / name, 'w', encoding='utf-8') as said:
            program = subprocess.Popen([self._programs.get(str(words[0]), str(words[0])), *map(str, words[1:])],
                                       stdout=said, stderr=subprocess.STDOUT, cwd=self.folder,
                                       env={**os.environ, 'PYTHONPATH': str(PACKAGE), 'PYTHONDONTWRITEBYTECODE': '1'})
        self._running.append(program)
        return program

    def said(self, name: str) -> str:
        path = self.folder / name
        return path.read_text(encoding='utf-8', errors='replace') if path.exists() else ''

    def wait_for(self, name: str, pattern: str) -> re.Match[str]:
        """Waits until the output of a program has the pattern."""
        end = time.monotonic() + PATIENCE_S
        while not (found := re.search(pattern, self.said(name))):
            if time.monotonic() > end:
                raise AssertionError(f'no {pattern} in the output of {name}:\n{self.said(name)}')
            time.sleep(0.02)
        return found

    def robot(self, *words: str) -> None:
        self.start('robot', 'stilt', 'robot', '--lockstep', *self._buses, '--publish', '--domain', self.domain, *words)
        self.wait_for('robot', 'ready')

    def controller(self, *words: str) -> subprocess.Popen:
        settings = (*PATIENT, f'telemetry.domain={self.domain}', f'telemetry.token_file={self.token_file}')
        return self.start('stiltd', 'stiltd', '--lockstep', *self._buses,
                          *(word for setting in settings for word in ('--set', setting)), *words)

    def monitor(self) -> str:
        """Starts it; its link, with the key."""
        self.start('monitor', 'stilt', 'monitor', '--port', '0', '--no-browser', '--domain', self.domain)
        return self.wait_for('monitor', r'monitor: (http\S+#key=\w+)\n')[1]

    def record(self, file: Path, *words: str) -> None:
        """Records a walk of two seconds and its end."""
        self.robot()
        recorder = self.start('recorder', 'stilt', 'record', '--out', file, '--domain', self.domain)
        self.wait_for('recorder', 'recording to')
        controller = self.controller('--start', 'walk@0.4', '--duration', '5', *words)
        assert controller.wait(PATIENCE_S) == 0, self.said('stiltd')
        recorder.send_signal(signal.SIGINT)
        assert recorder.wait(PATIENCE_S) == 0, self.said('recorder')

    def end(self) -> None:
        for program in reversed(self._running):
            with contextlib.suppress(ProcessLookupError):
                program.kill()
            program.wait(PATIENCE_S)
        subprocess.run(['rm', '-r', self.folder], check=True)


@contextlib.contextmanager
def programs(stilt: str, stiltd: str) -> Iterator[Programs]:
    running = Programs(stilt, stiltd)
    try:
        yield running
    finally:
        running.end()

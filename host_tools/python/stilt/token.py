"""The token of a run of stiltd, under the rules of docs/security.md."""
from __future__ import annotations

import os
import re
import stat

from stilt.errors import RobotError

TOKEN = re.compile(r'[A-Za-z0-9+/=_-]{16,256}')


def token_path(domain: int = 0) -> str:
    """Where stiltd writes the token for programs of this user, unless telemetry.token_file names another place."""
    runtime = os.environ.get('XDG_RUNTIME_DIR', '')
    folder = f'{runtime}/stilt' if runtime.startswith('/') else f'/tmp/stilt-{os.geteuid()}'
    return f'{folder}/token-{domain}'


def read_token(path: str) -> str:
    """The first line of a file of this user or root, which no other user may read. Raises RobotError."""
    def refuse(why: str) -> RobotError:
        return RobotError(f'token file {path}: {why}')

    try:
        number = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW | os.O_CLOEXEC)
    except OSError as error:
        raise refuse(f'{error.strerror}; stiltd prints where its token is') from error
    with open(number, 'rb', closefd=True) as file:
        status = os.fstat(number)
        if not stat.S_ISREG(status.st_mode):
            raise refuse('it is no regular file')
        if status.st_uid not in (os.geteuid(), 0):
            raise refuse('it belongs to another user; run as the user of stiltd')
        if status.st_mode & 0o077:
            raise refuse('others may read or write it; chmod 600 makes it yours alone')
        token = file.read(257).split(b'\n')[0].decode('ascii', 'replace')
    if not TOKEN.fullmatch(token):
        raise refuse('its first line is no token of 16 to 256 characters, which are letters, digits, + / = - or _')
    return token

#!/usr/bin/env python3
"""A DDS domain that no other test process of this machine has, as in tests/own_domain.h.

  own_domain.py COMMAND...    runs the command with the number of the domain in $STILT_TEST_DOMAIN
"""
import fcntl
import os
import sys

_held = []


def own_domain():
    """Number of the domain, as text; this process holds it until it ends."""
    for domain in range(5, 95):
        try:
            file = os.open(f'/tmp/stilt-test-domain-{domain}', os.O_RDWR | os.O_CREAT, 0o666)
        except OSError:
            continue  # the file of another user
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(file)
            continue
        _held.append(file)
        return str(domain)
    raise RuntimeError('no DDS domain is free for this test: /tmp/stilt-test-domain-* are all locked, or of other users')


if __name__ == '__main__':
    os.environ['STILT_TEST_DOMAIN'] = own_domain()
    os.set_inheritable(_held[0], True)  # the command holds the domain on
    os.execvp(sys.argv[1], sys.argv[1:])

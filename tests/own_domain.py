"""A DDS domain that no other test process of this machine has, as in tests/own_domain.h."""
import fcntl
import os

_held = []


def own_domain():
    """Number of the domain, as text; this process holds it until it ends."""
    for domain in range(5, 95):
        file = os.open(f'/tmp/stilt-test-domain-{domain}', os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(file)
            continue
        _held.append(file)
        return str(domain)
    raise RuntimeError('no DDS domain is free for this test: /tmp/stilt-test-domain-* are all locked')

"""Finds the guardian that stands beside a bridge."""

import time
from contextlib import suppress
from pathlib import Path

PATIENCE = 60.0
"""Seconds within which a bridge should have a guardian."""


def guardian_of(bridge: int) -> int:
    """Returns the process id of the guardian of a bridge, which has a name once it has begun.

    Raises:
        AssertionError: It has none.
    """
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        for path in Path("/proc").glob("[0-9]*/cmdline"):
            with suppress(OSError):
                words = path.read_bytes().split(b"\0")
                # The bridge is its last argument.
                if b"guardian.process" in b" ".join(words) and words[-2] == str(bridge).encode():
                    return int(path.parent.name)
        time.sleep(0.01)
    raise AssertionError(f"no guardian of {bridge} within {PATIENCE} s")

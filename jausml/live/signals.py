"""Signals that end what lasts in good order, in the midst of nothing."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from jausml.runtime.base.process import end_signals


@contextmanager
def ended_by_signals(end: Callable[[], None]) -> Iterator[None]:
    """Lets the signals that ask a process to end call a function while a block runs."""
    former = {number: signal.signal(number, lambda *_: end()) for number in end_signals()}
    try:
        yield
    finally:
        for number, handler in former.items():
            signal.signal(number, handler)

"""Keys of the terminal, as they are pressed."""

from __future__ import annotations

import os
import select
import sys
from contextlib import contextmanager
from threading import Thread
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


@contextmanager
def pressed(take: Callable[[str], None]) -> Iterator[bool]:
    """Has keys taken while a block runs, and says whether there are any: not without a terminal.

    Args:
        take: Takes each, on another thread.
    """
    if not _has_terminal():
        yield False
        return
    import termios
    import tty

    keyboard = sys.stdin.fileno()
    former = termios.tcgetattr(keyboard)
    ended, end = os.pipe()
    reader = Thread(target=_read, args=(keyboard, ended, take), daemon=True)
    tty.setcbreak(keyboard)
    reader.start()
    try:
        yield True
    finally:
        os.close(end)
        reader.join()
        os.close(ended)
        if _has_terminal():
            termios.tcsetattr(keyboard, termios.TCSADRAIN, former)


def _has_terminal() -> bool:
    """Whether stdin is a terminal, and we are before it: in the background we would be stopped."""
    try:
        keyboard = sys.stdin.fileno()
        if not os.isatty(keyboard):
            return False
    except (AttributeError, OSError, ValueError):  # it was closed
        return False
    try:
        return os.tcgetpgrp(keyboard) == os.getpgrp()
    except AttributeError:  # Windows
        return False
    except OSError:  # nobody's terminal stops nobody
        return True


def _read(keyboard: int, ended: int, take: Callable[[str], None]) -> None:
    while True:
        ready, _, _ = select.select([keyboard, ended], [], [])
        if ended in ready:
            return
        try:
            data = os.read(keyboard, 64)
        except OSError:  # the terminal has gone
            return
        if not data:
            return
        for key in data.decode(errors="replace"):
            take(key)

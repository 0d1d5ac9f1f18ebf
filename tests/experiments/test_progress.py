"""Progress: one line on a terminal, few lines in a log."""

from __future__ import annotations

import io

import pytest

from experiments.right_turn.progress import Progress, clock


class Clock:
    """Seconds that a test sets."""

    now = 0.0

    def __call__(self):
        return self.now


@pytest.mark.parametrize(("seconds", "text"), [(0, "0:00"), (59.9, "0:59"), (187, "3:07")])
def test_times_are_minutes_and_seconds(seconds, text):
    assert clock(seconds) == text


def test_a_log_gets_a_line_now_and_then():
    stream, now = io.StringIO(), Clock()
    progress = Progress(stream, None, now)
    progress.begin("[1/2] wall", 240)
    for each in range(100):
        now.now = each / 10
        progress.tell(f"pair {each}")
    progress.end("done")
    assert stream.getvalue().splitlines() == [
        "[1/2] wall (0:00 of at most 4:00)",
        "[1/2] wall (0:05 of at most 4:00): pair 50",
        "[1/2] wall: done (0:09)",
    ]


def test_a_terminal_has_one_line_that_changes_and_never_wraps():
    stream, now = io.StringIO(), Clock()
    progress = Progress(stream, 40, now)
    progress.begin("sweep", 60)
    now.now = 1.0
    progress.tell("cell 1 of 300, " + "long words " * 20)
    progress.end("done")
    text = stream.getvalue()
    assert text.count("\n") == 1
    assert text.endswith("\r\x1b[Ksweep: done (0:01)\n")
    assert all(len(each.removeprefix("\x1b[K")) < 40 for each in text.split("\r"))

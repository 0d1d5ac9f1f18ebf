"""The fuzz target of the generated codecs, for a moment."""

import re
import sys
from pathlib import Path

import pytest
from scripts import succeeded

RUN = Path(__file__).with_name("run.py")


@pytest.mark.slow
def test_bodies_are_refused_or_go_out_as_they_came():
    done = succeeded(
        [sys.executable, str(RUN), "bodies", "--plain", "--runs", "5000", "--seed", "7"],
        timeout=110,
    )
    report = re.search(
        r"(\d+) messages: (\d+) refused, (\d+) taken but not sent, (\d+) sent again", done.stdout
    )
    assert report is not None
    messages, *outcomes = map(int, report.groups())
    assert messages > 300
    assert sum(outcomes) == 5_000
    assert min(outcomes) > 0

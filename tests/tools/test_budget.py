"""A run of tests ends in the time that it has."""

import os
import sys
from pathlib import Path

import pytest
from scripts import succeeded

SUPPORT = Path(__file__).resolve().parents[1] / "support"


@pytest.mark.slow
@pytest.mark.parametrize(("seconds", "outcome"), [("100", "2 passed"), ("0", "2 skipped")])
def test_what_is_left_is_skipped_and_counted(tmp_path, seconds, outcome):
    file = tmp_path / "test_two.py"
    file.write_text("def test_one(): pass\ndef test_other(): pass\n", encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "-rs", "-p", "budget", "--budget", seconds, file]
    result = succeeded(
        command,
        cwd=tmp_path,
        env={
            **os.environ,
            "PYTHONPATH": str(SUPPORT),
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",  # half of what it takes to begin
        },
        timeout=60,
    )
    assert outcome in result.stdout
    assert ("out of time" in result.stdout) == (seconds == "0")

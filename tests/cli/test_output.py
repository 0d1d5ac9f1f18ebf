"""Standard streams that are closed, full, or read by nobody."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys

import pytest

JAUSML = f"{shlex.quote(sys.executable)} -m jausml"


@pytest.fixture
def shell(folder):
    """Runs a line of bash in the folder of models; `jausml` in it is this one."""

    def run(line: str) -> subprocess.CompletedProcess[str]:
        line = line.replace("jausml", JAUSML)
        return subprocess.run(
            ["bash", "-c", line], cwd=folder, capture_output=True, text=True, timeout=100
        )

    return run


@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&-", "<&- >&- 2>&-"])
def test_streams_may_be_closed(shell, closed):
    result = shell(f"jausml validate good.xmi {closed}")
    assert (result.returncode, result.stdout) == (0, ""), result.stderr
    assert "Traceback" not in result.stderr
    assert "internal error" not in result.stderr


def test_no_file_takes_the_place_of_a_closed_stream(shell, folder):
    result = shell("jausml validate good.xmi --format json --output report.json >&- 2>&-")
    assert result.returncode == 0
    assert (folder / "report.json").read_text("utf-8").rstrip().endswith("}")


@pytest.mark.parametrize("words", ["--version", "--help", "list --help", "list messages"])
def test_output_without_room_is_told(shell, words):
    result = shell(f"jausml {words} > /dev/full")
    assert result.returncode == 2
    assert result.stderr == "Error: cannot write the output: No space left on device\n"


@pytest.mark.parametrize("words", ["--help", "list --help", "list messages", "rules"])
def test_a_reader_that_has_gone_is_no_problem_of_the_models(words):
    reader, writer = os.pipe()
    os.close(reader)
    try:
        command = [sys.executable, "-m", "jausml", *words.split()]
        result = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, timeout=100)
    finally:
        os.close(writer)
    assert (result.returncode, result.stderr) == (141, b"")

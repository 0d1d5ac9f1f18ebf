"""Standard streams that are closed, full, or read by nobody."""

import os
import re
import shlex
import signal
import subprocess
import sys

import pytest
import warm
from scripts import ran
from sweeps import sweep
from terminal import at_terminal

JAUSML = f"{shlex.quote(sys.executable)} -m jausml"


@pytest.fixture
def shell(folder):
    """Runs a line of bash in the folder of models; `jausml` in it is this one."""

    def run(line: str) -> subprocess.CompletedProcess[str]:
        line = line.replace("jausml", JAUSML)
        return ran(["bash", "-c", line], cwd=folder, timeout=100)

    return run


@pytest.mark.parametrize("closed", sweep(["<&- >&- 2>&-", ">&-", "2>&-", "<&-"], every=4))
def test_streams_may_be_closed_and_no_file_takes_their_place(shell, folder, closed):
    result = shell(f"jausml validate good.xmi --format json --output report.json {closed}")
    assert (result.returncode, result.stdout) == (0, ""), result.stderr
    assert "Traceback" not in result.stderr
    assert "internal error" not in result.stderr
    assert (folder / "report.json").read_text("utf-8").rstrip().endswith("}")


@pytest.mark.parametrize("words", ["--version", "--help", "list --help", "list messages"])
def test_output_without_room_is_told(shell, words):
    result = shell(f"jausml {words} > /dev/full")
    assert result.returncode == 2
    assert result.stderr == "Error: cannot write the output: No space left on device\n"


def test_output_without_room_is_no_file_of_a_new_project(shell):
    origin = "--from topics scan:sensor_msgs/LaserScan --yes"
    result = shell(f"PYTHONUNBUFFERED=1 jausml init rover {origin} > /dev/full")
    assert result.returncode == 2
    assert result.stderr.endswith("Error: cannot write the output: No space left on device\n")


def test_a_file_for_which_there_is_no_room_stays_as_it_was(shell, folder):
    before = (folder / "good.xmi").read_bytes()
    # Modules that are compiled here would be cut off, and no later process could load them.
    result = shell(
        "ulimit -f 1; PYTHONDONTWRITEBYTECODE=1 jausml merge good.xmi good.xmi bad.xmi -o good.xmi"
    )
    assert (result.returncode, result.stderr) == (
        2,
        "Error: cannot write good.xmi: File too large\n",
    )
    assert (folder / "good.xmi").read_bytes() == before


@pytest.mark.parametrize("words", ["--help", "list --help", "list messages"])
def test_a_reader_that_has_gone_is_no_problem_of_the_models(words):
    reader, writer = os.pipe()
    os.close(reader)
    try:
        command = [sys.executable, "-m", "jausml", *words.split()]
        result = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, timeout=100)
    finally:
        os.close(writer)
    assert (result.returncode, result.stderr) == (141, b"")


@pytest.mark.parametrize(
    ("verb", "line", "said"),
    [("decode", "02400000000000", "ReportStatus"), ("encode", "QueryStatus", "0220")],
)
def test_what_comes_of_a_line_is_there_before_the_next_and_an_interrupt_ends_it(verb, line, said):
    """A loop of a shell ends with a program that died of the signal, and goes on otherwise."""
    process = subprocess.Popen(
        [*warm.command(), verb, *(["-"] if verb == "decode" else [])],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        process.stdin.write(f"{line}\n")
        process.stdin.flush()
        assert said in process.stdout.readline()
        process.send_signal(signal.SIGINT)  # it waits for the next line
        process.wait(timeout=100)
        output, errors = process.stdout.read(), process.stderr.read()
    finally:
        process.kill()
        process.wait()
        for io in (process.stdin, process.stdout, process.stderr):
            io.close()
    assert (process.returncode, output, errors) == (-signal.SIGINT, "", "\n")


@pytest.mark.usefixtures("folder")
def test_an_interrupt_within_another_program_is_a_status(jausml, monkeypatch):
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("jausml.language.validation.engine.check_project", interrupted)
    assert jausml("validate", "good.xmi").exit_code == 130


@pytest.mark.parametrize("value", ["", "1"])
def test_severities_have_colours_on_terminals(folder, value):
    command = (*warm.command(), "validate", "bad.xmi")
    with at_terminal(*command, cwd=folder, environment={"NO_COLOR": value}) as terminal:
        shown = terminal.read_all()
    assert ("\x1b[31m\x1b[1merror\x1b[0m: JML425" in shown) == (not value), shown
    # Progress, which a busy computer shows, moves the cursor and has no colours.
    assert bool(re.search(r"\x1b\[[\d;]*m", shown)) == (not value)


@pytest.mark.parametrize(
    "words",
    [
        "validate . --output",
        "model-check good.xmi --output",
        "report good.xmi -o",
        "diff doubtful.xmi good.xmi -o",
        "generate good.xmi --check --output",
    ],
)
def test_no_report_takes_the_place_of_a_model(jausml, folder, words):
    model = folder / "good.xmi"
    before = model.read_bytes()
    result = jausml(*words.split(), "good.xmi")
    assert (result.exit_code, model.read_bytes()) == (2, before)
    assert "good.xmi is read; name another file" in result.stderr

"""Stories of users: commands in an empty folder, and what each of them must say.

A story is text. `$` begins a command of bash, `&` one that runs on beside the others. `>` is a part
of its output, in order, for which `&` waits; `!` an exit status that is not 0. `<<` and a name
begin a file, up to a line of `>>`. Other lines tell what happens.
"""

import os
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

PATIENCE = 120
"""Seconds for one command, on a computer that is busy with others."""


@dataclass
class Step:
    """One command: the line of the story where it stands, and what it must say."""

    line: int
    command: str
    runs_on: bool = False
    status: int = 0
    expected: list[str] = field(default_factory=list)


@dataclass
class File:
    """A file that the user writes."""

    name: str
    lines: list[str] = field(default_factory=list)


def read(text: str) -> Iterator[Step | File]:
    """Yields the steps of a story."""
    step: Step | None = None
    file: File | None = None
    for number, line in enumerate(text.splitlines(), 1):
        mark, _, rest = line.partition(" ")
        if file is not None:
            if line == ">>":
                yield file
                file = None
            else:
                file.lines.append(line)
        elif mark in {"$", "&", "<<"}:
            if step is not None:
                yield step
            step = None if mark == "<<" else Step(number, rest, mark == "&")
            file = File(rest) if mark == "<<" else None
        elif mark == ">" and step is not None:
            step.expected.append(rest)
        elif mark == "!" and step is not None:
            step.status = int(rest)
    if step is not None:
        yield step


class Teller:
    """Runs a story in a folder."""

    def __init__(self, folder: Path, words: Mapping[str, str], programs: Sequence[Path]) -> None:
        """Begins.

        Args:
            words: What takes the place of words in capitals between braces, as {NOTATION}.
            programs: The folders of the `jausml` and the `python` that the user has installed.
        """
        self._folder = folder
        self._words = words
        self._environment = {
            **os.environ,
            "PATH": os.pathsep.join([*map(str, programs), os.environ["PATH"]]),
            "HOME": str(folder),
            "PYTHONUNBUFFERED": "1",
        }
        self._bash = shutil.which("bash") or "bash"
        self.commands = 0

    def tell(self, text: str) -> None:
        """Runs all steps; an AssertionError tells the first one that did not go as it should."""
        for name, value in self._words.items():
            text = text.replace(f"{{{name}}}", value)
        with ExitStack() as running:
            for step in read(text):
                if isinstance(step, File):
                    path = self._folder / step.name
                    path.parent.mkdir(parents=True, exist_ok=True)
                    path.write_text("\n".join([*step.lines, ""]), encoding="utf-8")
                    continue
                self.commands += 1
                if step.runs_on:
                    self._start(step, running)
                else:
                    self._run(step)

    def _run(self, step: Step) -> None:
        done = subprocess.run(
            [self._bash, "-c", step.command],
            cwd=self._folder,
            env=self._environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
        told = f"line {step.line}: {step.command}\n{done.stdout}"
        assert done.returncode == step.status, f"{told}exit status {done.returncode}"
        missing = _missing(step, done.stdout)
        assert not missing, f"{told}does not say: {missing}"

    def _start(self, step: Step, running: ExitStack) -> None:
        output = self._folder / f".output-{step.line}"
        with output.open("wb") as file:
            process = subprocess.Popen(
                [self._bash, "-c", f"exec {step.command}"],
                cwd=self._folder,
                env=self._environment,
                stdout=file,
                stderr=subprocess.STDOUT,
            )
        running.callback(_end, process)
        end = time.monotonic() + PATIENCE
        while missing := _missing(step, output.read_text("utf-8", "replace")):
            is_over = process.poll() is not None or time.monotonic() > end
            told = f"line {step.line}: {step.command}\n{output.read_text('utf-8', 'replace')}"
            assert not is_over, f"{told}does not say: {missing}"
            time.sleep(0.1)


def _missing(step: Step, output: str) -> str:
    """Returns the first expected part that does not follow those before it; empty for none."""
    place = 0
    for part in step.expected:
        place = output.find(part, place)
        if place < 0:
            return part
        place += len(part)
    return ""


def _end(process: subprocess.Popen[bytes]) -> None:
    process.send_signal(signal.SIGINT)
    try:
        process.wait(20)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()

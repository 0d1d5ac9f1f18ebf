"""The compiler of the suite makes what the real one makes, and of the same text only once."""

import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import compile_once
import pytest
from scripts import succeeded

GUARDS = ("tests/support/compile_once.py",)
REAL = next(filter(None, map(shutil.which, ("g++", "clang++"))), None)

pytestmark = pytest.mark.needs("compiler")


class Compiler:
    """A real compiler that counts what it links, and the one of the suite before it."""

    def __init__(self, folder: Path) -> None:
        self.log = folder / "log"
        self.log.touch()
        self.real = folder / "counted"
        self.real.write_text(
            f'#!/bin/sh\ncase "$*" in *-E*) ;; *) echo >> {self.log} ;; esac\nexec {REAL} "$@"\n'
        )
        self.real.chmod(0o755)
        self.kept = folder / "kept"
        self.kept.mkdir()

    def __call__(self, source: Path, *options: str) -> str:
        """Compiles, and returns what the program says; of a compiler that fails what it says."""
        made = source.with_suffix("")
        made.unlink(missing_ok=True)
        line = [compile_once.__file__, self.kept, self.real, *options, "-o", made, source]
        done = subprocess.run([sys.executable, *line], capture_output=True, text=True, check=False)
        if done.returncode:
            assert not made.exists()
            return done.stderr
        return succeeded([made]).stdout

    @property
    def times(self) -> int:
        return len(self.log.read_text().splitlines())


@pytest.fixture
def compiler(tmp_path: Path) -> Compiler:
    return Compiler(tmp_path)


def written(folder: Path, said: str, program: str = "puts(SAID);") -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "said.hpp").write_text(f'#include <cstdio>\n#define SAID "{said}"\n')
    source = folder / "program.cpp"
    source.write_text(f'#include "said.hpp"\nint main() {{ {program} }}\n')
    return source


def test_the_same_text_is_compiled_once_wherever_it_lies(compiler, tmp_path):
    assert compiler(written(tmp_path / "one", "same")) == "same\n"
    assert compiler(written(tmp_path / "two", "same")) == "same\n"
    assert compiler.times == 1


def test_another_header_or_option_is_another_program(compiler, tmp_path):
    assert compiler(written(tmp_path / "one", "first")) == "first\n"
    assert compiler(written(tmp_path / "one", "other")) == "other\n"
    program = 'printf("%.3f", 0.1 * LEVEL);'
    for level in (1, 2, 1):
        source = written(tmp_path / "level", "", program)
        assert compiler(source, f"-DLEVEL={level}") == f"0.{level}00"
    assert compiler(written(tmp_path / "one", "first"), "-ffp-contract=off") == "first\n"
    assert compiler.times == 5


def test_what_a_compiler_says_is_said_each_time(compiler, tmp_path):
    wrong = written(tmp_path / "wrong", "", "return nothing;")
    for _ in range(2):
        assert "nothing" in compiler(wrong)
    doubtful = written(tmp_path / "doubtful", "", "int unused = 1;")
    for _ in range(2):
        compiler(doubtful, "-Wall")
    assert compiler.times == 4


def test_workers_and_what_they_start_use_it(tmp_path, monkeypatch):
    monkeypatch.setenv("CXX", "")
    compile_once.use(tmp_path, REAL)
    named = os.environ["CXX"]
    compile_once.use(tmp_path, named)  # as a worker does, which has it of the first process
    assert os.environ["CXX"] == named
    source = written(tmp_path / "source", "hello")
    subprocess.run([named, "-o", tmp_path / "made", source], check=True)
    assert subprocess.run([tmp_path / "made"], capture_output=True, check=True).stdout == b"hello\n"


def test_who_asks_meanwhile_waits_for_it(compiler, tmp_path):
    slow = compiler.real.read_text().replace("echo >>", "sleep 1; echo >>")
    compiler.real.write_text(slow)
    sources = [written(tmp_path / name, "same") for name in ("one", "two")]
    with ThreadPoolExecutor() as pool:
        assert [*pool.map(compiler, sources)] == ["same\n", "same\n"]
    assert compiler.times == 1

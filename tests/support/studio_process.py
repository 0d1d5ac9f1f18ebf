"""Runs `jausml studio` or `jausml operate` with a page of the test: the built one may be missing.

Usage: studio_process.py PAGE VERB ARGUMENT...
"""

import importlib
import sys
from pathlib import Path

from jausml.cli import main

HOMES = {"studio": "jausml.authoring.studio.serving", "operate": "jausml.live.operating.serving"}

if __name__ == "__main__":
    importlib.import_module(HOMES[sys.argv[2]]).PAGE = Path(sys.argv[1])
    main(sys.argv[2:])

"""The right turn: JAUS alone against ROS through the generated bridge."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
"""Root of the repository."""

EXAMPLE = ROOT / "models" / "catvehicle"
"""Models, user code and vehicle science of the scenario."""

# The package `catvehicle` is user code of the example: it is copied into workspaces, not installed.
if str(EXAMPLE / "src" / "catvehicle") not in sys.path:
    sys.path.insert(0, str(EXAMPLE / "src" / "catvehicle"))

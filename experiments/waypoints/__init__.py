"""A robot on two wheels drives a list of waypoints that a JAUS operator gives it."""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
"""Root of the repository."""

EXAMPLE = ROOT / "models" / "examples" / "waypoint_list"
"""Model, operator and nodes of the scenario."""

TOOLS = ROOT / "tools"
"""Programs of the repository; one makes the action type that no wheel has."""

for _each in map(str, (TOOLS, EXAMPLE)):
    if _each not in sys.path:
        sys.path.insert(0, _each)

"""A bridge beside a simulator: the JAUS side is served at the pace of the simulation."""

from __future__ import annotations

import sys
from pathlib import Path

MODELS = Path(__file__).resolve().parents[2] / "models"
"""Models and user code of the repository."""

CATVEHICLE = MODELS / "catvehicle" / "src" / "catvehicle"
"""The package of plant, path and control laws: user code, copied into workspaces, not installed."""

if str(CATVEHICLE) not in sys.path:
    sys.path.insert(0, str(CATVEHICLE))

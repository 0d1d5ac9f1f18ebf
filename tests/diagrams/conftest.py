"""Lets the tests import what they share with each other and with those of the generators."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1] / "generators")]

"""Makes the experiments and the example's package importable."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
for folder in (ROOT, ROOT / "models" / "catvehicle" / "src" / "catvehicle"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))


@pytest.fixture(scope="session")
def virtual_workspaces(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The generated code of both systems, by name."""
    from experiments.right_turn.systems import BRIDGED, JAUS_ALONE, generate

    folder = tmp_path_factory.mktemp("virtual")
    return {
        system.name: generate(system, folder / system.name).folder
        for system in (JAUS_ALONE, BRIDGED)
    }

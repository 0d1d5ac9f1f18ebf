"""Makes mapping_support importable, and the bridges of the ready maps available."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from mapping_support import Translator, generate

if TYPE_CHECKING:
    from collections.abc import Callable


@pytest.fixture(scope="session")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Returns a folder with a generated bridge for each file of ready maps."""
    folder = tmp_path_factory.mktemp("mappings")
    generate(folder)
    return folder


@pytest.fixture(scope="session")
def translator(workspace: Path) -> Callable[[str], Translator]:
    """Returns the translations of a file of ready maps by its name."""
    made: dict[str, Translator] = {}

    def of(stem: str) -> Translator:
        if stem not in made:
            made[stem] = Translator(workspace / f"{stem}_bridge")
        return made[stem]

    return of

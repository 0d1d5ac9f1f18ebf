"""Makes mapping_support importable, and the bridges of the ready maps available."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from jausml.language.model.reading.reader import ReadResult

sys.path.insert(0, str(Path(__file__).parent))
sys.path.append(str(Path(__file__).parents[2] / "generators"))

from mapping_support import Translator, generated, read, system_text


@pytest.fixture(scope="session")
def system(tmp_path_factory: pytest.TempPathFactory) -> ReadResult:
    """Returns a system with a bridge for each file of ready maps."""
    path = tmp_path_factory.mktemp("system") / "system.ros2jaus"
    path.write_text(system_text(), encoding="utf-8")
    return read(path)


@pytest.fixture(scope="session")
def workspace(system: ReadResult) -> Path:
    """Returns a folder with the generated bridges."""
    return generated(system)


@pytest.fixture(scope="session")
def translator(workspace: Path) -> Callable[[str], Translator]:
    """Returns the translations of a file of ready maps by its name."""
    made: dict[str, Translator] = {}

    def of(stem: str) -> Translator:
        if stem not in made:
            made[stem] = Translator(workspace / f"{stem}_bridge")
        return made[stem]

    return of

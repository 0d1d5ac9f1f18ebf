"""Shared parts of the verbs that look up attribute maps: ready ones and those of the user."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jausml.cli.common import find_models
from jausml.cli.messages import ModelFault
from jausml.language.metamodel.classes import bridge
from jausml.language.model import Severity, library_root, read_models
from jausml.language.semantics.map_overview import MapOverview, overview
from jausml.language.text.notation import NOTATIONS

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True)
class FoundMap:
    """An attribute map and its file.

    Attributes:
        module: What imports it in text, e.g. `mappings.range_sensor`; empty for a user's file.
    """

    overview: MapOverview
    path: str
    line: int
    module: str

    def to_json(self) -> dict[str, Any]:
        """Returns what the map is, and where."""
        place = {"file": self.path, "line": self.line, "module": self.module or None}
        return {**self.overview.to_json(), **place}


def open_maps(models: Sequence[str], word: str = "") -> list[FoundMap]:
    """Returns the attribute maps of the library and of models, in the order of their files.

    Args:
        word: Text that stands in the files of the library that are meant; all when empty.
    """
    folder = library_root() / "mappings"
    ready = sorted(folder.glob("*.ros2jaus"))
    ready = [path for path in ready if word in path.read_text(encoding="utf-8")]
    paths = [*map(str, ready), *find_models(models)]
    if not paths:
        return []
    result = read_models(paths, notations=NOTATIONS)
    errors = [each for each in result.diagnostics if each.severity is Severity.ERROR]
    if errors:
        raise ModelFault("\n".join(f"{e.location}: {e.rule} {e.message}" for e in errors))
    found = []
    for each in result.model.instances(bridge.AttributeMap):
        place = result.model.location(each)
        is_ready = Path(place.path).parent == folder
        module = f"{folder.name}.{Path(place.path).stem}" if is_ready else ""
        found.append(FoundMap(overview(each), str(place.path), place.line, module))
    return found

"""View of interface packages, for their templates."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.metamodel.classes.system import System
    from jausml_generators.ros_interfaces.definitions import DefinitionFile


class InterfacesView:
    """An ament_cmake package of interfaces."""

    def __init__(
        self,
        system: System,
        name: str,
        description: str,
        files: Sequence[DefinitionFile],
        source: str,
    ) -> None:
        self.name = name
        self.description = description
        self.files = sorted(files, key=lambda file: file.place)
        self.source = source
        self.element_id = f"interfaces:{name}"
        self.version = system.version
        self.maintainer = system.maintainer
        self.maintainer_email = system.maintainerEmail
        self.license = system.license

    @property
    def dependencies(self) -> list[str]:
        """The packages whose types its definitions use, sorted."""
        found = {name for file in self.files for name in file.packages}
        if any(file.kind == "action" for file in self.files):
            found.add("action_msgs")
        return sorted(found)

"""View of the module of the light classes of a bridge."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from jausml.generation.errors import GenerationError
from jausml.generation.languages.python import Imports, Origin, offered
from jausml.language.cdr.layout import PRIMITIVES, CdrError, Sizes, fields_of, types_within
from jausml_generators.bridge.light.classes import LightClass
from jausml_generators.bridge.light.serializing import Runs
from jausml_generators.common import runtime
from jausml_generators.common.ros import local_names, ros_type
from jausml_generators.python.names import snake_case

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel.classes import ros
    from jausml_generators.bridge.ros_classes import RosClasses

_TAKEN = ("ClassVar", "Layout", "LightMessage")


class LightModule:
    """The module `ros_types` of a package."""

    def __init__(self, roots: Iterable[ros.MessageType]) -> None:
        self._roots = tuple(roots)
        self._runs = Runs()
        self._sizes = Sizes()

    @functools.cached_property
    def types(self) -> tuple[ros.MessageType, ...]:
        """The types with those of the messages inside them, the inner ones first.

        Raises:
            GenerationError: A message contains itself.
        """
        try:
            return tuple(types_within(self._roots))
        except CdrError as error:
            raise GenerationError(str(error)) from error

    @functools.cached_property
    def classes(self) -> tuple[LightClass, ...]:
        """The classes, the inner ones first."""
        return tuple(
            LightClass(self.name_of(each), each, self.name_of, self._runs, self._sizes)
            for each in self.types
        )

    def name_of(self, message: ros.MessageType) -> str:
        """Returns the name of the class of a type."""
        return self._names[message]

    @functools.cached_property
    def _names(self) -> dict[ros.MessageType, str]:
        names = local_names(map(ros_type, self.types), _TAKEN)
        return {each: names[ros_type(each)] for each in self.types}

    def origins(self, classes: RosClasses, module: str) -> dict[str, Origin]:
        """Returns where classes that another module names come from.

        Args:
            module: This module, as the other imports it.
        """
        own = {ros_type(each): self.name_of(each) for each in self.types}
        return {name: Origin(module, own[kind]) for kind, name in classes.names.items()}

    @functools.cached_property
    def bodies(self) -> tuple[tuple[LightClass, tuple[str, ...], tuple[str, ...]], ...]:
        """The classes with the bodies of the methods that read and write them."""
        return tuple((each, each.reading, each.writing) for each in self.classes)

    @property
    def runs(self) -> tuple[str, ...]:
        """Statements of the layouts of rows of numbers, which `bodies` use."""
        return self._runs.lines if self.bodies else ()

    @property
    def remarks(self) -> tuple[str, ...]:
        """Comments that tell linters what is meant."""
        lines = [line for _, *bodies in self.bodies for body in bodies for line in body]
        names = (str(field.name) for each in self.types for field in each.fields)
        found = []
        if any("._read" in line or "._write" in line for line in lines):
            found.append("# ruff: noqa: SLF001 - the classes read and write each other")
        if any(snake_case(name) != name for name in names):
            found.append("# ruff: noqa: A002 - the fields have the names of ROS")
        kinds = {
            field.primitive for each in self.types for field in fields_of(each) if field.is_single
        }
        if PRIMITIVES["bool"] in kinds:
            found.append("# ruff: noqa: FBT001, FBT002 - the fields have the types of ROS")
        return tuple(found)

    @property
    def imports(self) -> Imports:
        """What the module may import."""
        return Imports(
            {
                **offered("typing", "ClassVar"),
                **offered(runtime.LIGHT, "Layout", "LightMessage"),
                "cdr_": Origin(runtime.LIGHT, "cdr"),
            }
        )

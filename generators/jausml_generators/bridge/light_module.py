"""Views of the module of the light classes of a bridge, and of each class in it."""

from __future__ import annotations

import functools
import keyword
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from jausml.generation.errors import GenerationError
from jausml.generation.literals import clean, python_literal, python_string
from jausml.generation.python import Imports, Origin, offered
from jausml.language.cdr import (
    PRIMITIVES,
    CdrError,
    FieldLayout,
    Sizes,
    fields_of,
    nested,
    types_within,
)
from jausml.language.metamodel.classes import ros
from jausml_generators.bridge.light_serializing import Runs, reading_lines, writing_lines
from jausml_generators.common.ros import RosClasses, local_names, ros_type
from jausml_generators.python.names import snake_case
from jausml_generators.python.package import LIGHT
from jausml_generators.python.statements import call, tuple_of

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
            LightClass(self.name_of(kind), kind, self.name_of, self._runs, self._sizes)
            for kind in self.types
        )

    def name_of(self, message: ros.MessageType) -> str:
        """Returns the name of the class of a type."""
        return self._names[message]

    @functools.cached_property
    def _names(self) -> dict[ros.MessageType, str]:
        names = local_names(map(ros_type, self.types), _TAKEN)
        return {message_type: names[ros_type(message_type)] for message_type in self.types}

    def origins(self, classes: RosClasses, module: str) -> dict[str, Origin]:
        """Returns where classes that another module names come from.

        Args:
            module: This module, as the other imports it.
        """
        own = {ros_type(message_type): self.name_of(message_type) for message_type in self.types}
        return {name: Origin(module, own[kind]) for kind, name in classes.names.items()}

    @functools.cached_property
    def bodies(self) -> tuple[tuple[LightClass, tuple[str, ...], tuple[str, ...]], ...]:
        """The classes with the bodies of the methods that read and write them."""
        return tuple((light, light.reading, light.writing) for light in self.classes)

    @property
    def runs(self) -> tuple[str, ...]:
        """Statements of the layouts of rows of numbers, which `bodies` use."""
        return self._runs.lines if self.bodies else ()

    @property
    def remarks(self) -> tuple[str, ...]:
        """Comments that tell linters what is meant."""
        lines = [line for _, *bodies in self.bodies for body in bodies for line in body]
        names = (str(field.name) for message_type in self.types for field in message_type.fields)
        remarks = []
        if any("._read" in line or "._write" in line for line in lines):
            remarks.append("# ruff: noqa: SLF001 - the classes read and write each other")
        if any(snake_case(name) != name for name in names):
            remarks.append("# ruff: noqa: A002 - the fields have the names of ROS")
        kinds = {
            field.primitive for kind in self.types for field in fields_of(kind) if field.is_single
        }
        if PRIMITIVES["bool"] in kinds:
            remarks.append("# ruff: noqa: FBT001, FBT002 - the fields have the types of ROS")
        return tuple(remarks)

    @property
    def imports(self) -> Imports:
        """The names that the module may import."""
        return Imports(
            {
                **offered("typing", "ClassVar"),
                **offered(LIGHT, "Layout", "LightMessage"),
                "cdr_": Origin(LIGHT, "cdr"),
            }
        )


_OWN_CONSTANTS = frozenset({"LAYOUT", "LEAST", "NESTED", "TYPE"})


@dataclass(frozen=True)
class LightField:
    """A field of a light class.

    Attributes:
        parameter: The parameter of `__init__`, with type and default.
        value: What `__init__` stores, as Python text.
        idl: What rosidl calls its type, as a Python string.
    """

    name: str
    annotation: str
    parameter: str
    value: str
    idl: str


@dataclass(frozen=True)
class LightClass:
    """A ROS message type as a light class."""

    name: str
    message: ros.MessageType
    class_of: Callable[[ros.MessageType], str]
    runs: Runs
    sizes: Sizes

    @property
    def type_text(self) -> str:
        """The type as a Python string, e.g. `"nav_msgs/msg/Odometry"`."""
        return python_string(ros_type(self.message).full_name)

    @property
    def documentation(self) -> str:
        """The documentation of the type, or its name."""
        own = clean(self.message.documentation)
        return own or f"Message {ros_type(self.message).full_name}"

    @property
    def fields(self) -> tuple[LightField, ...]:
        """The fields in order."""
        return tuple(self._field(field) for field in fields_of(self.message))

    @property
    def constants(self) -> tuple[str, ...]:
        """The constants of the type, as statements of the body of the class."""
        constants: dict[str, str] = {}
        for constant in self.message.constants:
            name = str(constant.name)
            name = f"{name}_" if name in _OWN_CONSTANTS or keyword.iskeyword(name) else name
            constants.setdefault(name, _constant(constant))
        return tuple(f"{name}: {value}" for name, value in constants.items())

    @property
    def nested(self) -> str:
        """The classes of the messages inside it as a tuple."""
        return tuple_of(*map(self.class_of, nested(self.message)))

    @property
    def least(self) -> int:
        """Fewest bytes that it takes, without padding."""
        return self.sizes.fewest_bytes(self.message)

    @property
    def reading(self) -> tuple[str, ...]:
        """The body of the method that reads it."""
        return reading_lines(self.message, self.class_of, self.runs, self.sizes)

    @property
    def writing(self) -> tuple[str, ...]:
        """The body of the method that writes it."""
        return writing_lines(self.message, self.class_of, self.runs, self.sizes)

    def _field(self, field: FieldLayout) -> LightField:
        annotation = self._annotation(field)
        value = "self_" if field.name == "self" else field.name
        if field.is_single and field.message is None:
            parameter = f"{value}: {annotation} = {_single_default(field)}"
        else:
            parameter = f"{value}: {annotation} | None = None"
            value = f"{self._new(field)} if {value} is None else {value}"
        return LightField(field.name, annotation, parameter, value, python_string(field.idl))

    def _annotation(self, field: FieldLayout) -> str:
        if field.message is not None:
            element = self.class_of(field.message)
        else:
            element = field.primitive.python if field.primitive is not None else "str"
        if field.is_single:
            return element
        if field.primitive is None:
            return f"{'list' if field.message is None else 'cdr_.Messages'}[{element}]"
        return "cdr_.Truths" if element == "bool" else f"cdr_.{_VECTORS[element]}"

    def _new(self, field: FieldLayout) -> str:
        """Python text of the value of a field in a message as it is made."""
        if field.message is not None:
            name = self.class_of(field.message)
            if field.is_single:
                return f"{name}()"
            return call("cdr_.several", name, str(field.count)) if field.is_fixed else "[]"
        if field.primitive is None:
            if field.is_fixed and not field.default:
                return call("cdr_.several", "str", str(field.count))
            return _list(field.default or [])
        code = f'"{field.primitive.code}"'
        if field.default:
            return call("cdr_.filled", code, _list(field.default))
        return call("cdr_.zeros", code, str(field.count if field.is_fixed else 0))


_VECTORS = {"int": "Integers", "float": "Reals"}


def _list(values: list[Any]) -> str:
    return f"[{', '.join(map(python_literal, values))}]"


def _single_default(field: FieldLayout) -> str:
    if field.default is not None:
        return python_literal(field.default)
    return '""' if field.primitive is None else field.primitive.zero


def _constant(constant: ros.Constant) -> str:
    kind, text = constant.type.name, str(constant.value)
    if kind in {"string", "wstring"}:
        return f"ClassVar[str] = {python_string(text)}"
    if kind == "bool":
        return f"ClassVar[bool] = {text == 'true'}"
    if kind.startswith("float"):
        return f"ClassVar[float] = {python_literal(float(text))}"
    return f"ClassVar[int] = {int(text)}"

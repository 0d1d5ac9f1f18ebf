"""The flat form of one translation: a function from bytes to bytes."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml_generators.bridge.flat.cdr_reading import CdrReading
from jausml_generators.bridge.flat.cdr_writing import CdrWriting
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.expressions import Names
from jausml_generators.bridge.flat.jaus_reading import JausReading
from jausml_generators.bridge.flat.jaus_writing import JausWriting
from jausml_generators.bridge.flat.lowering import Lowering
from jausml_generators.bridge.flat.sources import JausValues, RosValues
from jausml_generators.bridge.translation.ros_fields import PathError, RosStart
from jausml_generators.python.names import Scope, names_in

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jausml.language.metamodel.classes import bridge, jaus
    from jausml_generators.bridge.flat.constants import Constants
    from jausml_generators.bridge.flat.expressions import SourceValues
    from jausml_generators.bridge.flat.protocols import Reading, Writing
    from jausml_generators.bridge.translation import Translated
    from jausml_generators.python.codec.messages import MessageView

_ATTRIBUTE = re.compile(r"\bself\.(\w+)")
# What the functions of the module use besides their own variables.
_TAKEN = names_in(
    """
    alike arithmetic bridge columns connection conversions count data each error limited math numpy
    octets offset order position rotations self size source stamps struct target transcode
    """
)


@dataclass(frozen=True)
class FlatForm:
    """A flat form, without the names of what differs from connection to connection.

    Attributes:
        lines: The statements of the function.
        limits: The limits of the connection that they ask.
        joins: Names of the joined messages.
        constants: Constants of the base's module that they use.
        is_shared: Whether several connections may use it with other attributes of the bridge.
    """

    lines: tuple[str, ...]
    limits: tuple[str, ...]
    joins: tuple[str, ...]
    constants: tuple[str, ...]
    is_shared: bool

    @property
    def branches(self) -> int:
        """Paths through what makes the function, as linters count them."""
        heads = ("if ", "elif ", "for ", "except ")
        return 2 + sum(line.lstrip().startswith(heads) for line in self.lines)


@dataclass(frozen=True)
class Readable:
    """A readable translation, and what is the same in those of other connections.

    Attributes:
        owner: Attribute of the bridge that is the connection.
        lines: The statements.
        attributes: Attributes of the bridge that they name, in order.
        text: The statements without these names.
    """

    owner: str
    lines: tuple[str, ...]
    attributes: tuple[str, ...]
    text: str


def readable(translated: Translated) -> Readable:
    """Returns the readable translation of a connection.

    Args:
        translated: Its methods.
    """
    attributes: dict[str, int] = {}

    def numbered(found: re.Match[str]) -> str:
        if found[1] == translated.name:
            return "connection"
        return f"self.{attributes.setdefault(found[1], len(attributes))}"

    text = _ATTRIBUTE.sub(numbered, "\n".join(translated.lines))
    return Readable(translated.name, translated.lines, tuple(attributes), text)


def flat_form(
    connection: bridge.Connection,
    translated: Translated,
    view_of: Callable[[jaus.MessageDef], MessageView],
    module: frozenset[str],
    constants: Constants,
) -> FlatForm:
    """Returns the flat form of a connection's translation.

    Args:
        connection: The connection.
        translated: Its methods.
        view_of: Returns the class of a JAUS message.
        module: Names of the constants of the base's module.
        constants: Constants of the module of flat forms.

    Raises:
        NotFlatError: It has none.
    """
    source = readable(translated)
    tree = ast.parse("\n".join(source.lines))
    locals_ = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    joins = tuple(each.name for each in translated.joins)
    scope = Scope(_TAKEN | locals_ | module | frozenset(joins))
    names = Names(source.owner, list(source.attributes), set(joins), module)
    try:
        reading, writing, values = _ends(connection, view_of, scope, constants)
        names.roots["source"] = values
        body = Lowering(names, writing, scope, "target", constants, has_columns=True).lower(
            tree.body
        )
    except PathError as error:
        raise NotFlatError(str(error)) from error
    lines = (*reading.lines(), *body, *writing.lines())
    keeps = any(isinstance(node, ast.Attribute) and _is_kept(node) for node in ast.walk(tree))
    return FlatForm(tuple(lines), tuple(names.limits), joins, tuple(names.constants), not keeps)


def _is_kept(node: ast.Attribute) -> bool:
    """Whether an attribute of the bridge is given a value."""
    is_stored = isinstance(node.ctx, ast.Store)
    return is_stored and isinstance(node.value, ast.Name) and node.value.id == "self"


def _ends(
    connection: bridge.Connection,
    view_of: Callable[[jaus.MessageDef], MessageView],
    scope: Scope,
    constants: Constants,
) -> tuple[Reading, Writing, SourceValues]:
    used, message = connection.map, view_of(connection.map.message)
    if connection.direction.name == "jausToRos":
        taken = JausReading(message, constants, scope)
        made = CdrWriting(used.type, constants, scope)
        return taken, made, JausValues(taken)
    reading = CdrReading(used.type, constants, scope)
    writing = JausWriting(message, constants, scope)
    return reading, writing, RosValues(used.type, RosStart("source", used.type), reading)


def assembled(form: FlatForm, attributes: Sequence[str]) -> list[str]:
    """Returns the lines of a form with the names of attributes of the bridge.

    Args:
        form: The form.
        attributes: What stands for each of them, as Python text.
    """
    found = re.compile(r"\battribute_([0-9]+)__")
    return [found.sub(lambda match: attributes[int(match[1])], line) for line in form.lines]

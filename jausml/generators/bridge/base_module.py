"""Module of a bridge's base class: what stands in it besides the connections."""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation import docstrings as docs
from jausml.generation.literals import printable, python_literal, python_string
from jausml.generators.bridge.connections import COMPLEX
from jausml.generators.bridge.translation.values import PYTHON_TYPES, QUATERNION, TIME
from jausml.generators.common import runtime
from jausml.generators.common.ros import import_lines
from jausml.generators.python.codec.jaus_fields import BITS
from jausml.generators.python.layout import Call, collection, signature, statement

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.generators.bridge.connections import ConnectionView
    from jausml.generators.bridge.ros_classes import RosClasses
    from jausml.generators.bridge.translation import Surroundings
    from jausml.generators.bridge.translation.surroundings import (
        Constant,
        NestedTranslation,
        QuantityView,
        UserMethod,
    )

VALUE_TYPES = {PYTHON_TYPES[kind] for kind in (QUATERNION, TIME, BITS)}
_WORD = re.compile(r"\w+")
_METHOD_COLUMN = 4


@dataclass(frozen=True)
class BaseModule:
    """What the translations of a bridge use of its class and module, as text.

    Args:
        around: What they use; complete.
        connections: The connections.
        ros_classes: Names of the ROS classes.
    """

    around: Surroundings
    connections: Sequence[ConnectionView]
    ros_classes: RosClasses

    # ------------------------------------------------------------------ imports

    @functools.cached_property
    def _running(self) -> frozenset[str]:
        """All words of what runs in the class, annotations left out."""
        texts = [line for view in self.connections for line in view.argument_lines]
        texts += [view.body.text for view in self.connections]
        texts += [view.safe_body.text for view in self.connections if view.has_safe_value]
        texts += [each.body.text for each in self.nested if each.body is not None]
        return frozenset(_WORD.findall("\n".join(texts)))

    @functools.cached_property
    def _annotations(self) -> frozenset[str]:
        """All words of the annotations."""
        texts = [each.annotation for each in self.around.constants.values()]
        texts += [each.annotation for each in self.around.memories]
        for nested in self.nested:
            texts += [nested.source_name, nested.target_name]
        texts += [join.type_name for view in self.connections for join in view.joins]
        if self.quantities:
            texts += ["RosSide", "Transport"]
        return self.method_words | frozenset(_WORD.findall("\n".join(texts)))

    @property
    def method_words(self) -> frozenset[str]:
        """All words of the types of the conversions that the user writes."""
        texts = [text for each in self.methods for text in (*each.inputs, each.output)]
        return frozenset(_WORD.findall("\n".join(texts)))

    @property
    def standard_lines(self) -> tuple[str, ...]:
        """Import statements of the standard library."""
        names = {name for name in ("Any",) if name in self._annotations}
        if self.typing_lines:
            names.add("TYPE_CHECKING")
        return import_lines(("typing", name) for name in names)

    def import_lines(self, runtime: Iterable[tuple[str, str]]) -> tuple[str, ...]:
        """Returns the import statements of ROS, of the runtime and of the messages.

        Args:
            runtime: Modules and names of the runtime that the connections use.
        """
        names = set(runtime)
        for nested in self.nested:
            if nested.body is not None:
                names |= nested.body.names
        ros = self.ros_classes
        names |= ros.imports(name for name in ros.names.values() if name in self._running)
        own = {(".messages", name) for name in self._message_names if name in self._running}
        return (*import_lines(names), "", *import_lines(own))

    @functools.cached_property
    def typing_lines(self) -> tuple[str, ...]:
        """Import statements that type checkers alone need."""
        only = self._annotations - self._running
        names = {(runtime.CONVERSIONS, name) for name in VALUE_TYPES & only}
        if self.quantities:
            names |= {(runtime.FACE, "RosSide"), (runtime.FACE, "Transport")}
        names |= self.ros_classes.imports(only)
        own = {(".messages", name) for name in self._message_names if name in only}
        lines = import_lines(names, 4)
        return (*lines, *[""][: len(own) and len(names)], *import_lines(own, 4))

    @property
    def _message_names(self) -> set[str]:
        known = {name for view in self.connections for name in view.message_names}
        ros = set(self.ros_classes.names.values())
        nested = {name for each in self.nested for name in (each.source_name, each.target_name)}
        return known | (nested - ros)

    # ------------------------------------------------------------------ what stands there

    @property
    def constants(self) -> tuple[str, ...]:
        """Statements of the constants of the module."""
        return tuple(map(_constant, self.around.constants.values()))

    @property
    def quantities(self) -> tuple[QuantityView, ...]:
        """The quantities that conversions use."""
        return tuple(self.around.quantities.values())

    @property
    def attributes(self) -> tuple[str, ...]:
        """Statements that give the attributes of the class their first values."""
        quantities = [
            f"self.{each.name} = {python_literal(each.value)}{_unit_comment(each.units)}"
            for each in self.quantities
        ]
        memories = [f"self.{each.name}: {each.annotation} = None" for each in self.around.memories]
        return (*quantities, *memories)

    @property
    def parameter_lines(self) -> tuple[str, ...]:
        """Statements that read the quantities from parameters of the node."""
        return tuple(
            statement(
                Call(
                    "ros.parameter",
                    (
                        python_string(each.name),
                        f"self.{each.name}",
                        python_string(_description(each)),
                    ),
                ),
                f"self.{each.name} = ",
                8,
            )
            for each in self.quantities
        )

    @property
    def nested(self) -> tuple[NestedTranslation, ...]:
        """The methods that translate messages inside messages."""
        return tuple(self.around.nested.values())

    @property
    def nested_signatures(self) -> tuple[str, ...]:
        """First lines of these methods."""
        return tuple(
            signature(
                f"def {each.name}",
                ["self", f"source: {each.source_name}"],
                each.target_name,
                _METHOD_COLUMN,
                COMPLEX if each.body is not None and each.body.is_complex else "",
            )
            for each in self.nested
        )

    @property
    def methods(self) -> tuple[UserMethod, ...]:
        """The conversions that the user writes."""
        return tuple(self.around.methods.values())

    @property
    def user_signatures(self) -> tuple[str, ...]:
        """First lines of these methods."""
        return tuple(map(user_signature, self.methods))

    @property
    def stubs(self) -> tuple[str, ...]:
        """The methods of the skeleton that the user completes."""
        return tuple(map(stub, self.methods))


def user_signature(method: UserMethod) -> str:
    """Returns the first line of a conversion that the user writes."""
    pairs = zip(names_of(method), method.inputs, strict=True)
    parameters = [f"{name}: {kind}" for name, kind in pairs]
    return signature(f"def {method.name}", ["self", *parameters], method.output, _METHOD_COLUMN)


def stub(method: UserMethod) -> str:
    """Returns the method of the skeleton that the user completes."""
    head = "\n".join(f"    {line}" for line in user_signature(method).split("\n"))
    about = docs.docstring(f"The conversion {printable(method.model_name)}.", 8)
    return f"{head}\n        {about}\n        raise NotImplementedError({_missing(method)})\n"


def _missing(method: UserMethod) -> str:
    return python_string(f"{method.name} is not written yet")


def names_of(method: UserMethod) -> tuple[str, ...]:
    """Returns the names of the parameters of a conversion that the user writes."""
    count = len(method.inputs)
    return ("value",) if count == 1 else tuple(f"value{i}" for i in range(1, count + 1))


def _constant(constant: Constant) -> str:
    opening, closing = constant.brackets[0], constant.brackets[1]
    before = f"{constant.name}: {constant.annotation} = "
    text = collection(before, opening, constant.items, closing)
    return f"# {' '.join(printable(constant.about).split())}\n{text}"


def _unit_comment(units: str) -> str:
    text = " ".join(printable(units).split())
    return f"  # {text}" if text else ""


def _description(quantity: QuantityView) -> str:
    words = " ".join(printable(quantity.documentation or f"{quantity.name}.").split())
    units = " ".join(printable(quantity.units).split())
    return f"{words.rstrip('.')} ({units})." if units else words

"""Scope of the classes of one message: their names, their constants, and the plain ones."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from jausml.generation import literals as docs
from jausml_generators.python import names
from jausml_generators.python.codec import scalars
from jausml_generators.python.codec.classes import BitFieldClass, Enumeration, SubField

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from jausml.language import wire
    from jausml_generators.python.codec.classes import NestedClass


class MessageScope:
    """The inside of one message class while it is built.

    Attributes:
        known: What was built already, by what makes it equal to another.
    """

    def __init__(self, class_name: str, message: str) -> None:
        self._class_name = class_name
        self._message = message
        reserved = names.RESERVED_INNER_CLASSES | {class_name}
        self._scope = names.Scope(reserved, separator="")
        self._enclosing = [class_name]
        self.classes: list[NestedClass] = []
        self.structs: dict[str, str] = {}
        self.known: dict[object, Any] = {}

    @contextmanager
    def inside(self, name: str) -> Iterator[None]:
        """Builds what a class encloses."""
        self._enclosing.append(name)
        yield
        self._enclosing.pop()

    def claim(self, name: str) -> str:
        """Returns the name of a class; where it is taken, with that of the enclosing class first.

        Of two fields State with different values, one of them in the record Wheel, the classes are
        called State and WheelState: the plain name is for the one that stands first.
        """
        return self._scope.claim(name, names.class_name(f"{self._enclosing[-1]}{name}"))

    def summary(self, field: wire.Field) -> str:
        """Returns the first line of the docstring of a field's class."""
        text = docs.clean(field.documentation)
        return docs.described(text or f"{field.name} of {self._message}")

    def path(self, name: str) -> str:
        """Returns the full name of a class."""
        return name if name == self._class_name else f"{self._class_name}.{name}"

    def use(self, struct_format: str) -> str:
        """Returns the name of the shared constant for one wire item, which the module then has."""
        name = scalars.struct_name(struct_format)
        self.structs[name] = f"<{struct_format}"
        return name

    def used(self, struct_format: str) -> str:
        """Returns the format of a wire item, for which the module then has a constant."""
        self.use(struct_format)
        return struct_format

    def bit_field(self, field: wire.Field, kind: wire.BitField) -> BitFieldClass:
        """Returns the class of a bit field; equal ones of one name (time stamps) share it."""
        scope = names.Scope(names.RESERVED_ATTRIBUTES | {"bits"})
        with self.inside(names.class_name(field.name)):
            subs = tuple(self._sub_field(each, scope) for each in kind.groups)
        key = (field.name, subs)
        if key not in self.known:
            name = self.claim(names.class_name(field.name))
            is_inherited = kind.is_published_time_stamp and name == "TimeStamp"
            self.known[key] = BitFieldClass(
                name, self.path(name), self.summary(field), subs, is_inherited
            )
            self.classes.append(self.known[key])
        found: BitFieldClass = self.known[key]
        return found

    def is_inherited(self, path: str) -> bool:
        """Returns whether the base of the message brings a class."""
        bit_fields = (each for each in self.classes if isinstance(each, BitFieldClass))
        return any(each.is_inherited and each.path == path for each in bit_fields)

    def _sub_field(self, bits: wire.Bits, scope: names.Scope) -> SubField:
        return SubField(
            jaus_name=bits.name,
            attribute=scope.claim(names.snake_case(bits.name)),
            low=bits.low,
            mask=bits.mask,
            value=scalars.legal_integer("", bits.legal),
            documentation=docs.clean(bits.documentation),
            enumeration=self.enumeration(bits.name, bits.legal.listed),
        )

    def enumeration(self, field: str, listed: Iterable[wire.Listed]) -> str:
        """Returns the name of the class of the listed values of a field, or nothing."""
        pairs = [(each.value, each.name) for each in listed]
        return self.listed(names.class_name(field), docs.clean(field), pairs)

    def listed(self, name: str, of: str, listed: Sequence[tuple[int, str]]) -> str:
        """Returns the name of the class of some values with names, or nothing without any."""
        if not listed:
            return ""
        scope = names.Scope()
        # Of several names of one value the first is kept, as an enumeration needs.
        first = dict(reversed(listed))
        constants = tuple((scope.claim(names.constant_name(first[v])), v) for v in dict(listed))
        key = (name, constants)
        if key not in self.known:
            self.known[key] = Enumeration(self.claim(name), of, constants)
            self.classes.append(self.known[key])
        enumeration: Enumeration = self.known[key]
        return enumeration.name

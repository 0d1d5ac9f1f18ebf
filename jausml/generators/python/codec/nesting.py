"""What the classes of one message share: their names, their constants, and the plain ones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from jausml.generation import docstrings as docs
from jausml.generation.errors import GenerationError
from jausml.generators.python import names
from jausml.generators.python.codec import fields
from jausml.generators.python.codec.nested import BitFieldClass, Enumeration, SubField

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.generators.python.codec.nested import (
        ContainerClass,
        VariableFieldClass,
        VariantAlias,
    )


@dataclass(frozen=True)
class Resolved:
    """A field of the model with its type references followed.

    Attributes:
        name: Its name, the outermost reference's.
        optional: Whether it is optional, as the outermost reference says.
        documentation: Clean text.
        type: The element that is no TypeReference.
    """

    name: str
    optional: bool
    documentation: str
    type: Any

    @property
    def kind(self) -> str:
        """Class of the type in the metamodel."""
        return str(self.type.eClass.name)


def resolve(element: Any) -> Resolved:
    """Follows the type references of a field.

    Args:
        element: A Field of the model.

    Raises:
        GenerationError: The references lead nowhere or in a circle.
    """
    target, seen = element, []
    while target is not None and target.eClass.name == "TypeReference":
        if target in seen:
            raise GenerationError(f"type reference '{element.name}' refers to itself")
        seen.append(target)
        target = target.target
    if target is None:
        raise GenerationError(f"type reference '{element.name}' has no target")
    text = docs.clean(element.documentation or target.documentation)
    return Resolved(str(element.name), bool(element.optional), text, target)


class Nest:
    """The inside of one message class while it is built.

    Attributes:
        scope: Names of the classes.
        classes: The classes in the order to write.
        structs: Formats of the module's constants by name.
        known: What was built already, by what makes it equal to another.
    """

    def __init__(self, class_name: str, message: str) -> None:
        self._class_name = class_name
        self._message = message
        self.scope = names.Scope(
            names.RESERVED_CLASSES | {class_name, "CODE", "NAME", "TAG"}, separator=""
        )
        self.classes: list[
            Enumeration | BitFieldClass | VariableFieldClass | ContainerClass | VariantAlias
        ] = []
        self.structs: dict[str, str] = {}
        self.known: dict[object, Any] = {}

    def summary(self, field: Resolved) -> str:
        """Returns the first line of the docstring of a field's class."""
        return docs.described(field.documentation or f"{field.name} of {self._message}")

    def path(self, name: str) -> str:
        """Returns the full name of a class."""
        return name if name == self._class_name else f"{self._class_name}.{name}"

    def use(self, struct_format: str) -> str:
        """Returns the name of the shared constant for one wire item, which the module then has."""
        name = fields.struct_name(struct_format)
        self.structs[name] = f"<{struct_format}"
        return name

    def used(self, struct_format: str) -> str:
        """Returns the format of a wire item, for which the module then has a constant."""
        self.use(struct_format)
        return struct_format

    def bit_field(self, field: Resolved) -> BitFieldClass:
        """Returns the class of a bit field; equal ones of one name (time stamps) share it."""
        scope = names.Scope(names.RESERVED_ATTRIBUTES | {"bits"})
        subs = tuple(self._sub_field(sub, scope) for sub in field.type.subFields)
        key = (field.name, subs)
        if key not in self.known:
            name = self.scope.claim(names.class_name(field.name))
            self.known[key] = BitFieldClass(name, self.path(name), self.summary(field), subs)
            self.classes.append(self.known[key])
        found: BitFieldClass = self.known[key]
        return found

    def _sub_field(self, element: Any, scope: names.Scope) -> SubField:
        low, mask = int(element.lowBit), 2 ** (int(element.highBit) - int(element.lowBit) + 1) - 1
        text = docs.clean(element.documentation)
        resolved = Resolved(str(element.name), optional=False, documentation=text, type=element)
        return SubField(
            jaus_name=resolved.name,
            attribute=scope.claim(names.snake_case(resolved.name)),
            low=low,
            mask=mask,
            value=replace(
                fields.integer("", fields.value_ranges(element.values, 0, mask)),
                listed=fields.listed_values(element.values),
            ),
            documentation=resolved.documentation,
            enumeration=self.enumeration(resolved, element.values),
        )

    def enumeration(self, field: Resolved, value_set: Any) -> str:
        """Returns the name of the class of the listed values of a field, or nothing."""
        listed = [(value, name) for name, value in fields.listed_values(value_set)]
        return self.listed(names.class_name(field.name), docs.clean(field.name), listed)

    def listed(self, name: str, of: str, listed: Sequence[tuple[int, str]]) -> str:
        """Returns the name of the class of some values with names, or nothing without any.

        Args:
            name: What the class should be called.
            of: What the values are of, clean text.
            listed: The values and their names.
        """
        if not listed:
            return ""
        scope = names.Scope()
        # Of several names of one value the first is kept, as an enumeration needs.
        first = dict(reversed(listed))
        constants = tuple((scope.claim(names.constant_name(first[v])), v) for v in dict(listed))
        key = (name, constants)
        if key not in self.known:
            self.known[key] = Enumeration(self.scope.claim(name), of, constants)
            self.classes.append(self.known[key])
        enumeration: Enumeration = self.known[key]
        return enumeration.name

"""Places in messages, and what must hold for something to stand there, in C++."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml_generators.bridge.translation import places
from jausml_generators.cpp.types import (
    Choice,
    Elements,
    Struct,
    Type,
    UnprintableError,
    cpp_name,
    find,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml_generators.bridge.translation.places import Condition, Local, Place


@dataclass(frozen=True)
class Found:
    """What stands at a place.

    Attributes:
        is_optional: Whether it may not be there; the text is then that of the optional.
        is_element: Whether it lies as on the wire, as the elements of lists do.
    """

    text: str
    type: Type
    is_optional: bool = False
    is_element: bool = False

    @property
    def value(self) -> str:
        """The value, where it is there."""
        return f"(*{self.text})" if self.is_optional else self.text


class Places:
    """What the places of one translation are called.

    Attributes:
        classes: Structs by the names of their classes in Python.
    """

    def __init__(
        self,
        classes: Mapping[str, Struct],
        roots: Mapping[str, Struct],
        joins: Mapping[str, Struct],
    ) -> None:
        """Knows the messages by the parameters of the method."""
        self.classes = classes
        self._roots = {name: Found(name, kind) for name, kind in roots.items()}
        for name, kind in joins.items():
            self._roots[name] = Found(cpp_name(name), kind, is_optional=True)
        self.locals: dict[Local, Found] = {}
        self.options: dict[Place, Struct] = {}
        self._names = {*map(cpp_name, self._roots), "live", "check"}

    def name(self, hint: str) -> str:
        """Returns a name that nothing has yet."""
        name, number_ = cpp_name(hint), 2
        while name in self._names:
            name, number_ = f"{hint}{number_}", number_ + 1
        self._names.add(name)
        return name

    def claim(self, local: Local, kind: Type) -> str:
        """Returns the name of a variable."""
        name = self.name(local.hint)
        self.locals[local] = Found(name, kind)
        return name

    def at(self, place: Place) -> Found:
        """Returns what stands at a place."""
        root = place.root
        found = self.root(root) if isinstance(root, str) else self.locals[root]
        for at, step in enumerate(place.steps):
            option = self.options.get(replace(place, steps=place.steps[:at]))
            if isinstance(found.type, Choice) and option is not None:
                found = Found(f"std::get<{option.cpp}>({found.value})", option)
            found = self._inner(found, step)
        return found

    def root(self, name: str) -> Found:
        """Returns a parameter of the method."""
        if name not in self._roots:
            raise UnprintableError(f"the constant {name}")
        return self._roots[name]

    @staticmethod
    def _inner(found: Found, step: str | int) -> Found:
        kind = found.type
        if isinstance(step, int):
            if not isinstance(kind, Elements):
                raise UnprintableError(f"an element of {kind.cpp}")
            # What is not there is no usual case: the library throws.
            inner = f"[{step}]" if step < kind.count else f".at({step})"
            return Found(f"{found.value}{inner}", kind.of, is_element=True)
        if not isinstance(kind, Struct) or step not in kind.members:
            raise UnprintableError(f"{step} of {kind.cpp}")
        member = kind.members[step]
        dot = "->" if found.is_optional else "."
        text = f"{found.text}{dot}{member.name}"
        return Found(text, member.type, member.is_optional, is_element=member.is_octet)

    def holds(self, condition: Condition) -> str:
        """Returns the test that a condition holds."""
        found = self.at(condition.place)
        match condition:
            case places.There():
                # What is no optional is always there: the item of a list, a struct in a struct.
                return f"{found.text}.has_value()" if found.is_optional else "true"
            case places.Longer(than=than):
                return f"{found.value}.size() > {than}"
            case places.Chosen(index=index):
                return f"{found.value}.index == {index}"
            case places.IsOption(class_name=name):
                option = find(self.classes, name)
                self.options[condition.place] = option
                return f"std::holds_alternative<{option.cpp}>({found.value})"
            case places.Equal(number=value):
                return f"{found.value} == {value}"
            case places.AsLongAs(names=names):
                return f"{found.value}.size() >= {self.root(names).text}.size()"
        raise UnprintableError(f"the condition {type(condition).__name__}")

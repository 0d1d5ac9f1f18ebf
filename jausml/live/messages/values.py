"""Values with a name, as messages give them."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping


class NamedValue(str):
    """An integer that a definition names: the name as text and in JSON, `int(value)` the number.

    It is equal to both. As a key, and in sets, it is its name.
    """

    __slots__ = ("_number",)

    _number: int

    def __new__(cls, name: str, number: int) -> NamedValue:
        """Makes a value."""
        made = super().__new__(cls, name)
        made._number = number
        return made

    def __getnewargs__(self) -> tuple[str, int]:  # type: ignore[override]
        return str(self), self._number

    def __eq__(self, other: object) -> bool:
        if isinstance(other, NamedValue):
            return self._number == other._number and str.__eq__(self, other)
        return str.__eq__(self, other) if isinstance(other, str) else self._number == other

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = str.__hash__

    def __bool__(self) -> bool:
        return bool(self._number)

    def __int__(self) -> int:
        return self._number

    __index__ = __int__


def named_values(names: Mapping[int, str]) -> dict[int, NamedValue]:
    """Returns the values of integers; a name that several have is none, as it does not tell."""
    count = Counter(names.values())
    return {number: NamedValue(name, number) for number, name in names.items() if count[name] == 1}


def as_numbers(value: Any) -> Any:
    """Returns fields with the numbers of their named values."""
    match value:
        case NamedValue():
            return int(value)
        case dict():
            return {name: as_numbers(each) for name, each in value.items()}
        case list():
            return [as_numbers(each) for each in value]
        case _:
            return value

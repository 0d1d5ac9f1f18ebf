"""Numbers that stand in a row in a message: constants of a module of light classes."""

from __future__ import annotations

from jausml_generators.python.statements import long_string


class Runs:
    """Names the layouts of rows of numbers; equal ones share a name.

    Attributes:
        names: Names by items, in the order in which they were asked for.
    """

    def __init__(self) -> None:
        self.names: dict[str, str] = {}

    def name_of(self, items: list[str]) -> str:
        """Returns the name of the layouts of a row.

        Args:
            items: Format characters of `struct`; with a number before it, one stands for the bytes
                of an array of that many.
        """
        return self.names.setdefault(" ".join(items), f"_RUN_{len(self.names) + 1}")

    @property
    def lines(self) -> tuple[str, ...]:
        """The statements that make the layouts."""
        return tuple(f"{name} = cdr_.run{_bracketed(items)}" for items, name in self.names.items())


def _bracketed(text: str) -> str:
    literal = long_string(text)
    return literal if literal.startswith("(") else f"({literal})"

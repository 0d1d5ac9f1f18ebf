"""Limits as comparisons: the limit of the connection is called for what is outside alone."""

from __future__ import annotations

import ast
from dataclasses import dataclass

from jausml_generators.bridge.flat.texts import limit_variable, text_of

FINITE = "-1.7976931348623157e308", "1.7976931348623157e308"
SINGLE = "-3.4028234663852886e38", "3.4028234663852886e38"
_METHODS = frozenset({"", "integer", "listed", "finite", "single", "text", "octets", "sized"})
_RANGES = frozenset({"", "integer", "finite", "single"})
POLICIES = frozenset({"clamp", "drop_field", "drop_message", "error"})
"""Attributes of connections that are limits."""


@dataclass(frozen=True)
class LimitCall:
    """A call of a limit of the connection.

    Attributes:
        policy: Attribute of the connection.
        method: Method of the limit; empty for the limit itself.
        field: The field, as Python text.
        value: The value that is limited.
        limits: The other arguments, as Python text.
    """

    policy: str
    method: str
    field: str
    value: ast.expr
    limits: tuple[str, ...]

    def test(self, name: str) -> str:
        """Returns the condition that holds for most values that fit; for others it may not.

        Args:
            name: Local variable that has the value.
        """
        match self.method:
            case "text":
                lower, upper = self.limits
                return f"{lower} <= len({name}) <= {upper} and {name}.isascii()"
            case "octets" | "sized":
                lower, upper = self.limits
                return f"{lower} <= len({name}) <= {upper}"
            case "listed":
                ranges = ast.literal_eval(self.limits[0])
                tests = (f"{a} <= {name} <= {b}" if a < b else f"{name} == {a}" for a, b in ranges)
                return " or ".join(tests)
        lower, upper = self.bounds
        return f"{lower} <= {name} <= {upper}"

    @property
    def bounds(self) -> tuple[str, str]:
        """Least and greatest of the values that fit, of a limit that is a range."""
        known = {"finite": FINITE, "single": SINGLE}.get(self.method)
        lower, upper = known or self.limits
        return lower, upper

    def fitting(self, name: str) -> str:
        """Returns the expression of a value for which the test holds."""
        return f"round({name})" if self.method in {"integer", "listed"} else name

    def outside(self, name: str) -> str:
        """Returns the call for all other values."""
        limit = limit_variable(self.policy)
        function = f"{limit}.{self.method}" if self.method else limit
        return f"{function}({', '.join((self.field, name, *self.limits))})"

    @property
    def is_range(self) -> bool:
        """Whether the test asks for the value once."""
        return self.method in _RANGES

    @property
    def can_be_none(self) -> bool:
        """Whether it answers None for what does not fit."""
        return self.policy == "drop_field"


def limit_call(node: ast.expr, owner: str) -> LimitCall | None:
    """Returns a call of a limit; None for other expressions.

    Args:
        node: An expression of a readable translation.
        owner: Attribute of the bridge that is the connection.
    """
    if not isinstance(node, ast.Call) or node.keywords or len(node.args) < 2:
        return None
    steps = ast.unparse(node.func).split(".")
    if steps[:2] != ["self", owner] or len(steps) not in {3, 4} or steps[2] not in POLICIES:
        return None
    method = steps[3] if len(steps) == 4 else ""
    if method not in _METHODS:
        return None
    field, value, *limits = node.args
    if not isinstance(field, ast.Constant) or not all(map(_is_constant, limits)):
        return None
    return LimitCall(steps[2], method, text_of(field), value, tuple(map(text_of, limits)))


def _is_constant(node: ast.expr) -> bool:
    try:
        ast.literal_eval(node)
    except ValueError:
        return False
    return True

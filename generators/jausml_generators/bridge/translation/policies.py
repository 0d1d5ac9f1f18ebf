"""Policies: what becomes of values that do not fit their target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from jausml.language.metamodel.classes import bridge
from jausml_generators.bridge.translation.expressions import Expression, Limit, number
from jausml_generators.python.names import snake_case


@dataclass(frozen=True)
class Policy:
    """The policy for values that do not fit their target.

    Attributes:
        owner: Attribute of the bridge that is the connection; empty for values that need no policy.
        name: `clamp`, `drop_field`, `drop_message` or `error`.
        identifiers: The policy of identifiers and counts; empty for the same one.
    """

    owner: str = ""
    name: str = ""
    identifiers: str = ""

    @property
    def of_identifiers(self) -> Policy:
        """The policy of integers that are no measures: a near number has another meaning."""
        return replace(self, name=self.identifiers) if self.identifiers else self

    def limit(self, how: str, value: Expression, path: str, bounds: Sequence[float] = ()) -> Limit:
        """Returns a value within limits.

        Args:
            how: What keeps it there; empty for two numbers.
        """
        constants = tuple(number(bound) for bound in bounds)
        return Limit(self.owner, self.name, how, path, value, constants)


NO_POLICY = Policy()
"""The policy of constants, and of values that are only asked whether they are there."""


@dataclass(frozen=True)
class Policies:
    """The policies of a connection.

    Attributes:
        owner: Attribute of the bridge that is the connection, e.g. `speed`.
        stated: Its out-of-range policy, as a literal of the metamodel, e.g. `dropField`.
    """

    owner: str
    stated: str

    def of(self, assignment: bridge.FieldAssignment, *, of_a_place: bool) -> Policy:
        """Returns the policy for a value of an assignment that does not fit its target.

        Args:
            of_a_place: Whether it is a coordinate: the nearest one is another place.
        """
        own = assignment.outOfRange.name
        if own != "asConnection":
            return self._named(own)
        if self.stated != "clamp":
            return self._named(self.stated)
        # The nearest latitude is a wrong place, not a rough one: better no message.
        if of_a_place:
            return self._named("dropMessage")
        # Cut off, a number of an entity would name another one.
        return replace(self._named(self.stated), identifiers="drop_message")

    @property
    def of_wholes(self) -> Policy:
        """The policy of lists, texts and octets, which cannot be left out of what needs them."""
        return self._named("dropMessage" if self.stated == "dropField" else self.stated)

    def _named(self, name: str) -> Policy:
        return Policy(self.owner, snake_case(name))

"""Translations that connections of one map share: made once without a name, and given each name."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING

from jausml_generators.bridge.translation.surroundings import Surroundings

if TYPE_CHECKING:
    from collections.abc import Callable

_NAME = "\1"
"""Stands for the name of a connection."""


@dataclass
class _Unnamed(Surroundings):
    """Surroundings of a connection without a name: what takes its name is claimed later.

    Attributes:
        claims: How each of it is claimed, from the surroundings and the name of a connection.
    """

    claims: list[Callable[[Surroundings, str], str]] = field(default_factory=list)

    def frame(self, connection: str, path: str, value: str) -> str:  # noqa: ARG002 - none yet
        """Returns what stands for the attribute of the name of a frame."""
        return self._later(lambda uses, name: uses.frame(name, path, value))

    def memory(self, name: str, annotation: str) -> str:
        """Returns what stands for the attribute that keeps a value."""
        return self._later(
            lambda uses, connection: uses.memory(name.replace(_NAME, connection), annotation)
        )

    def _later(self, claim: Callable[[Surroundings, str], str]) -> str:
        self.claims.append(claim)
        return _mark(len(self.claims) - 1)


class SharedTranslations:
    """The translations of one bridge by what makes them the same but for the name."""

    def __init__(self, uses: Surroundings) -> None:
        self._uses = uses
        self._once: set[object] = set()
        self._shared: dict[object, tuple[str, _Unnamed]] = {}

    def lines(
        self, key: object, name: str, make: Callable[[str, Surroundings], tuple[str, ...]]
    ) -> tuple[str, ...]:
        """Returns the lines of a translation."""
        if key not in self._once:
            # Most maps have one connection; all that is not named after it is claimed here.
            self._once.add(key)
            return make(name, self._uses)
        if key not in self._shared:
            known = {each.name: getattr(self._uses, each.name) for each in fields(self._uses)}
            around = _Unnamed(**known)
            self._shared[key] = "\n".join(make(_NAME, around)), around
        text, around = self._shared[key]
        for number, claim in enumerate(around.claims):
            text = text.replace(_mark(number), claim(self._uses, name))
        return tuple(text.replace(_NAME, name).split("\n"))


def _mark(number: int) -> str:
    return f"\2{number}\3"

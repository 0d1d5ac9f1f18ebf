"""What of the traffic is recorded."""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

from jausml.live.traffic.observing import ends_of

if TYPE_CHECKING:
    from jausml.live.traffic.frames import Datagram


@dataclass(frozen=True)
class Selection:
    """Patterns, in which `*` stands for anything; nothing selects all."""

    topics: tuple[str, ...] = ()
    excluded: tuple[str, ...] = ()
    components: tuple[str, ...] = ()

    def wants_topic(self, name: str) -> bool:
        """Whether a topic is recorded."""
        return _fits(name, self.topics or ("*",)) and not _fits(name, self.excluded)

    def wants(self, datagram: Datagram) -> bool:
        """Whether a datagram is recorded; one that cannot be read is."""
        if not self.components:
            return True
        ends = ends_of(datagram)
        return not ends or any(_fits(end, self.components) for end in ends)


def _fits(name: str, patterns: tuple[str, ...]) -> bool:
    return any(fnmatchcase(name, each) for each in patterns)

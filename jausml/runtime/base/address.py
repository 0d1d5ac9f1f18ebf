"""JAUS addresses: subsystem, node and component identifiers."""

from __future__ import annotations

import re
from functools import lru_cache

WILDCARD_SUBSYSTEM = 65535
WILDCARD_NODE = 255
WILDCARD_COMPONENT = 255

_DOTTED = re.compile(r"([0-9]{1,5})\.([0-9]{1,3})\.([0-9]{1,3})")


class JausAddress(int):
    """Address of a JAUS component, written ``subsystem.node.component`` (AS5669A, JAUS ID).

    A part may be 0 (reserved, names no component) or all ones (wildcard). The address is an `int`,
    its number on the wire with the subsystem in the upper half, so that dictionaries by address,
    which every datagram looks up, take this number as the key.

    Raises:
        ValueError: A part does not fit its width on the wire.
    """

    __slots__ = ()

    def __new__(cls, subsystem: int, node: int, component: int) -> JausAddress:
        """Packs the parts into one number.

        Args:
            subsystem: 1 to 65534; 65535 means every subsystem.
            node: 1 to 254; 255 means every node.
            component: 1 to 254; 255 means every component.
        """
        if not (
            0 <= subsystem <= WILDCARD_SUBSYSTEM
            and 0 <= node <= WILDCARD_NODE
            and 0 <= component <= WILDCARD_COMPONENT
        ):
            raise ValueError(
                f"JAUS address {subsystem}.{node}.{component} is out of range "
                "(subsystem 0..65535, node 0..255, component 0..255)"
            )
        return super().__new__(cls, subsystem << 16 | node << 8 | component)

    def __getnewargs__(self) -> tuple[int, int, int]:  # type: ignore[override]
        return self.subsystem, self.node, self.component

    def __bool__(self) -> bool:
        """Returns True, also for 0.0.0."""
        return True

    def __str__(self) -> str:
        return f"{self.subsystem}.{self.node}.{self.component}"

    def __repr__(self) -> str:
        return f"JausAddress({self.subsystem}, {self.node}, {self.component})"

    @property
    def subsystem(self) -> int:
        """The subsystem, 0 to 65535."""
        return self >> 16

    @property
    def node(self) -> int:
        """The node, 0 to 255."""
        return self >> 8 & 0xFF

    @property
    def component(self) -> int:
        """The component, 0 to 255."""
        return self & 0xFF

    @property
    def packed(self) -> int:
        """The address as one unsigned 32-bit number, subsystem in the upper half."""
        return int(self)

    @classmethod
    def parse(cls, text: str) -> JausAddress:
        """Reads the dotted form, e.g. ``100.1.2``; raises ValueError for any other text."""
        match = _DOTTED.fullmatch(text.strip())
        if match is None:
            raise ValueError(f"{text!r} is not a JAUS address; expected e.g. 100.1.2")
        return cls(int(match[1]), int(match[2]), int(match[3]))

    @property
    def is_wildcard(self) -> bool:
        """Whether any part means "all"."""
        return (
            self >> 16 == WILDCARD_SUBSYSTEM
            or self >> 8 & 0xFF == WILDCARD_NODE
            or self & 0xFF == WILDCARD_COMPONENT
        )

    @property
    def is_concrete(self) -> bool:
        """Whether the address names one component: no wildcard and no reserved zero."""
        return (
            0 < self >> 16 < WILDCARD_SUBSYSTEM
            and 0 < self >> 8 & 0xFF < WILDCARD_NODE
            and 0 < self & 0xFF < WILDCARD_COMPONENT
        )

    def matches(self, other: JausAddress) -> bool:
        """Returns whether a message to this address is meant for the component ``other``."""
        return (
            self.subsystem in (other.subsystem, WILDCARD_SUBSYSTEM)
            and self.node in (other.node, WILDCARD_NODE)
            and self.component in (other.component, WILDCARD_COMPONENT)
        )


@lru_cache(maxsize=1024)
def address_of(packed: int) -> JausAddress:
    """Returns the address of an unsigned 32-bit number; the few peers of a system are cached."""
    return JausAddress(packed >> 16 & 0xFFFF, packed >> 8 & 0xFF, packed & 0xFF)


# Every component of every node of every subsystem.
BROADCAST = JausAddress(WILDCARD_SUBSYSTEM, WILDCARD_NODE, WILDCARD_COMPONENT)

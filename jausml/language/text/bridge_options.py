"""What a user says of the bridge that carries all maps of a text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


@dataclass(frozen=True, slots=True)
class BridgeOfMaps:
    """What a bridge of all maps of a file is, besides the maps.

    Attributes:
        frequency: Messages each second of its events, None for the default of bridges.
    """

    path: Path
    address: str
    frequency: float | None = None

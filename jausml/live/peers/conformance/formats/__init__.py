"""Output formats of conformance reports: one module each, and one line in `RENDERERS`."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from jausml.live.peers.conformance.formats import json, junit, text

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from jausml.live.peers.conformance.check import ConformanceReport

RENDERERS: Mapping[str, Callable[[ConformanceReport], str]] = MappingProxyType(
    {"text": text.render, "json": json.render, "junit": junit.render}
)
"""What renders a report, by the name of the format."""

"""Formats of what was found: for people, for programs, and for code scanning."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.model_checking.formats import json, sarif, text

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from jausml.language.model import Model
    from jausml.model_checking.checking import Outcome

RENDERERS: Mapping[str, Callable[[Sequence[Outcome], Model], str]] = {
    "text": text.render,
    "json": json.render,
    "sarif": sarif.render,
}
"""What writes each format."""

summary = text.summary

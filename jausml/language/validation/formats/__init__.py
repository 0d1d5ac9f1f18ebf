"""Output formats of reports on models: one module each, and one line in `RENDERERS`."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from jausml.language.validation.formats import github, json, junit, sarif, text

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from jausml.language.validation.rule import Report

RENDERERS: Mapping[str, Callable[[Report], str]] = MappingProxyType(
    {
        "text": text.render,
        "json": json.render,
        "junit": junit.render,
        "sarif": sarif.render,
        "github": github.render,
    }
)
"""What renders a report, by the name of the format."""

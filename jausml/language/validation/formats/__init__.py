"""Output formats of reports on models: one module each, and one line in `RENDERERS`."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from jausml.language.validation.formats import github, json, junit, sarif, text
from jausml.language.validation.rule import Report

RENDERERS: Mapping[str, Callable[[Report], str]] = {
    "text": text.render,
    "json": json.render,
    "junit": junit.render,
    "sarif": sarif.render,
    "github": github.render,
}
"""The functions that render a report, by the name of the format."""

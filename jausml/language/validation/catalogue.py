"""Catalogue of all rules with their documentation, those of the reader included."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.language.model.rules import READER_RULES
from jausml.language.validation.allowances import ALLOWANCE_RULES
from jausml.language.validation.rules import all_rules

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.model.diagnostics import Severity
    from jausml.language.model.rules import RuleInfo

_WIDTH = 100


@dataclass(frozen=True, slots=True)
class CatalogueEntry:
    """A rule as lists and documentation show it."""

    id: str
    severity: Severity
    title: str
    documentation: str


def catalogue(*further: Mapping[str, RuleInfo]) -> list[CatalogueEntry]:
    """Returns all rules, ordered by id."""
    entries = [
        CatalogueEntry(id_, info.severity, info.title, textwrap.fill(info.explanation, _WIDTH))
        for rules in (READER_RULES, ALLOWANCE_RULES, *further)
        for id_, info in rules.items()
    ]
    entries += [
        CatalogueEntry(each.id, each.severity, each.title, each.documentation)
        for each in all_rules()
    ]
    return sorted(entries, key=lambda entry: entry.id)

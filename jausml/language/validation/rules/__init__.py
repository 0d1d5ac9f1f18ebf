"""All rules, found in the modules of this folder and those below, and their catalogue.

The rules of the reader, of allowances and of model checking are data.
"""

from __future__ import annotations

import pkgutil
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module

from jausml.language.model.diagnostics import READER_RULES, RuleInfo, Severity
from jausml.language.validation.rule import Rule


@cache
def all_rules() -> tuple[Rule, ...]:
    """Returns all rules, ordered by id."""
    modules = (
        import_module(package.name) for package in pkgutil.walk_packages(__path__, f"{__name__}.")
    )
    members = (member for module in modules for member in vars(module).values())
    return tuple(
        sorted((member for member in members if isinstance(member, Rule)), key=lambda rule: rule.id)
    )


_WIDTH = 100

ALLOWANCE_RULES: Mapping[str, RuleInfo] = {
    "JML801": RuleInfo(
        "allowance that cannot be read",
        "An @allow in the documentation of an element names one rule, the last day on which it "
        "holds, and a reason. It is about findings at the element and at what it owns. Bad: "
        "`@allow JML426`. Good: `@allow JML426 until 2027-06-30: the tablet is off at night`.",
        Severity.WARNING,
    ),
    "JML802": RuleInfo(
        "allowance that has expired",
        "The last day of an @allow has passed, so its findings count again. Fix them, or check the "
        "reason again and write a later day. Bad: `until 2020-01-31`. Good: a day in the future, "
        "on which somebody will check again.",
        Severity.WARNING,
    ),
    "JML803": RuleInfo(
        "allowance of nothing",
        "The element and what it owns no longer have a finding of the rule, or the findings are "
        "errors, which cannot be allowed: nothing is generated from a model with errors. An "
        "allowance that is left behind would hide the next finding. Good: remove it.",
        Severity.WARNING,
    ),
}
"""The rules of allowances by id."""


PRODUCT_RULES: Mapping[str, RuleInfo] = {
    "JML931": RuleInfo(
        "product: deadlock",
        "jausml model-check has found a way to a state in which nothing that was asked for can "
        "happen any more, whatever anybody does, or from which a machine never comes back to a "
        "state that it has left: a trap, out of which a Reset does not count as a way. States of "
        "Failure and Shutdown count as ends.",
    ),
    "JML932": RuleInfo(
        "product: livelock",
        "jausml model-check has found a way on which time goes on for ever and nothing that was "
        "asked for happens, though nobody hinders it: for example, a client that was lost keeps "
        "control that never lapses. Give the component a controlTimeout.",
        Severity.WARNING,
    ),
    "JML933": RuleInfo(
        "product: stop that does not come in time",
        "jausml model-check has found a way on which a command stands longer than it may after its "
        "source was lost. The time is that of --within, else the silenceTimeout of the connection, "
        "else the controlTimeout of who obeys. Bad: `silenceTimeout: 0` and `controlTimeout: 0`. "
        "Good: one of them is above 0.",
    ),
    "JML934": RuleInfo(
        "product: command outside of control",
        "jausml model-check has found a way on which a command takes effect, or stands, although "
        "its sender has no control, the component is not Ready, or an emergency is set.",
    ),
    "JML935": RuleInfo(
        "product: not searched to the end",
        "jausml model-check has met the bound of --states or --budget, or more conditions or "
        "pushes of a machine than it tries: what it has not seen may be wrong. Raise the bound, "
        "or make the machine smaller.",
        Severity.WARNING,
    ),
}
"""The rules of model checking, which looks at all parts of a system together, by id."""


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
        CatalogueEntry(rule.id, rule.severity, rule.title, rule.documentation)
        for rule in all_rules()
    ]
    return sorted(entries, key=lambda entry: entry.id)

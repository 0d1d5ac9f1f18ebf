"""Rules of model checking, which looks at all parts of a system together, as data."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from jausml.language.model.diagnostics import Severity
from jausml.language.model.rules import RuleInfo

if TYPE_CHECKING:
    from collections.abc import Mapping

_RULES = {
    "JML931": RuleInfo(
        "product: deadlock",
        "jausml model-check has found a way to a state in which nothing that was asked for can "
        "happen any more, whatever anybody does. States of Failure and Shutdown count as ends.",
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
        "jausml model-check has met the bound of --states or --budget: what it has not seen may "
        "be wrong. Raise the bound.",
        Severity.WARNING,
    ),
}

PRODUCT_RULES: Mapping[str, RuleInfo] = MappingProxyType(_RULES)
"""The rules of model checking by id."""

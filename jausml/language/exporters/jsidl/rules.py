"""Rules of the JSIDL exporter, as data for `jausml rules` and `jausml explain`."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from jausml.language.model.diagnostics import Diagnostic, Location, Severity
from jausml.language.model.rules import RuleInfo

if TYPE_CHECKING:
    from collections.abc import Mapping

_RULES = {
    "JML631": RuleInfo(
        "no place in JSIDL",
        "AS5684 has no element or attribute for it: axes of fields, commands that move nothing, "
        "what a set or a format says about itself. The bytes on the wire and the behaviour are the "
        "same without it; an import of the files does not bring it back.",
        Severity.INFO,
    ),
    "JML632": RuleInfo(
        "changed by JSIDL",
        "An import of the files makes something else of it than the model says. JSIDL sends by one "
        "action Send: the names of the methods that make the messages are lost, and a message that "
        "is sent on an internal event becomes a method that sends it.",
        Severity.WARNING,
    ),
    "JML633": RuleInfo(
        "no JSIDL",
        "What would be written is no JSIDL that an importer takes: two services of one URN and "
        "version, a character that XML cannot hold, a list that is always empty.",
    ),
}

JSIDL_EXPORT_RULES: Mapping[str, RuleInfo] = MappingProxyType(_RULES)
"""The rules of the JSIDL exporter by id. Ids are never used again for something else."""


def finding(rule: str, location: Location, message: str) -> Diagnostic:
    """Returns a finding of the export."""
    return Diagnostic(rule, JSIDL_EXPORT_RULES[rule].severity, location, message)

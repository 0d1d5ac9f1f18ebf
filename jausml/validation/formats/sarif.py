"""Reports for code scanning: SARIF 2.1.0 (OASIS)."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import PurePath
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from jausml import __version__
from jausml.model.diagnostics import Severity
from jausml.validation.catalogue import catalogue

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.model.diagnostics import Diagnostic, Location
    from jausml.validation.report import Report

SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
FINGERPRINT = "jausmlElement/v1"
"""Name of the fingerprint: of rule, file, element and message, so that a moved line is no news."""

_LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "note"}


def render(report: Report) -> str:
    """Returns a SARIF log of one run, with every rule of jausml.

    Paths are written as the user gave them: give them relative to the root of the repository.

    Args:
        report: The report.
    """
    rules = [
        {
            "id": each.id,
            "name": each.id,
            "shortDescription": {"text": each.title},
            "fullDescription": {"text": each.documentation},
            "help": {"text": each.documentation, "markdown": each.documentation},
            "defaultConfiguration": {"level": _LEVELS[each.severity]},
        }
        for each in catalogue()
    ]
    places = {str(rule["id"]): number for number, rule in enumerate(rules)}
    driver = {"name": "jausml", "semanticVersion": __version__, "rules": rules}
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "results": [_result(each, places) for each in report.diagnostics],
    }
    log = {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}
    return json.dumps(log, indent=2) + "\n"


def _result(each: Diagnostic, places: Mapping[str, int]) -> dict[str, Any]:
    location: dict[str, Any] = {"physicalLocation": _physical(each.location)}
    if each.element:
        location["logicalLocations"] = [{"fullyQualifiedName": each.element, "kind": "element"}]
    result: dict[str, Any] = {
        "ruleId": each.rule,
        "level": _LEVELS[each.severity],
        "message": {"text": f"{each.message} ({each.hint})" if each.hint else each.message},
        "locations": [location],
        "partialFingerprints": {FINGERPRINT: _fingerprint(each)},
    }
    if each.rule in places:
        result["ruleIndex"] = places[each.rule]
    if each.related:
        result["relatedLocations"] = [
            {
                "id": number,
                "physicalLocation": _physical(note.location),
                "message": {"text": note.message},
            }
            for number, note in enumerate(each.related, 1)
        ]
    return result


def _physical(location: Location) -> dict[str, Any]:
    return {
        "artifactLocation": {"uri": _uri(location.path)},
        "region": {"startLine": max(1, location.line), "startColumn": max(1, location.column)},
    }


def _uri(path: str) -> str:
    """Returns a path as a URI: relative with slashes, or of the scheme `file`."""
    pure = PurePath(path)
    if pure.is_absolute():
        return pure.as_uri()
    text = quote(os.fsencode(pure.as_posix()))
    # A colon in the first part would read as a scheme (RFC 3986, section 4.2).
    return text.replace(":", "%3A")


def _fingerprint(each: Diagnostic) -> str:
    identity = (each.rule, each.location.path, each.element or each.fragment, each.message)
    text = json.dumps(identity)
    return hashlib.sha256(text.encode("ascii")).hexdigest()

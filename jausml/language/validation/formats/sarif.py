"""Reports for code scanning: SARIF 2.1.0 (OASIS)."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import Any
from urllib.parse import quote

from jausml import __version__
from jausml.language.model.diagnostics import Diagnostic, Location, Severity
from jausml.language.text.notation import TEXT_RULES
from jausml.language.validation.rule import Report, SetAside
from jausml.language.validation.rules import CatalogueEntry, catalogue

SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
FINGERPRINT = "jausmlElement/v1"
"""Name of the fingerprint: of rule, file, element and message, so that a moved line is no news."""

_LEVELS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "note"}


def render(report: Report, help_uri: str | None = None) -> str:
    """Returns a SARIF log of one run, with every rule of jausml.

    Paths are written as the user gave them: give them relative to the root of the repository.
    """
    rules = [_rule(entry, help_uri) for entry in catalogue(TEXT_RULES, report.rules)]
    places = {str(rule["id"]): number for number, rule in enumerate(rules)}
    driver = {"name": "jausml", "semanticVersion": __version__, "rules": rules}
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "results": [_result(diagnostic, places) for diagnostic in report.diagnostics]
        + [_suppressed(suppression, places) for suppression in report.set_aside],
    }
    log = {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}
    return json.dumps(log, indent=2) + "\n"


def _rule(entry: CatalogueEntry, help_uri: str | None) -> dict[str, Any]:
    heading = f"**{entry.id}: {entry.title}**"
    rule: dict[str, Any] = {
        "id": entry.id,
        "name": entry.id,
        "shortDescription": {"text": entry.title},
        "fullDescription": {"text": entry.documentation},
        "help": {"text": entry.documentation, "markdown": f"{heading}\n\n{entry.documentation}"},
        "defaultConfiguration": {"level": _LEVELS[entry.severity]},
    }
    if help_uri is not None:
        rule["helpUri"] = f"{help_uri}#{_anchor(f'{entry.id} {entry.title}')}"
    return rule


def _anchor(heading: str) -> str:
    """Returns the name under which pages of Markdown have a heading, as GitHub and GitLab do."""
    return re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")


def _suppressed(aside: SetAside, places: Mapping[str, int]) -> dict[str, Any]:
    """Returns a result that does not count, and why (SARIF, section 3.35)."""
    suppression: dict[str, Any] = {
        "kind": "external" if aside.location is None else "inSource",
        "status": "accepted",
        "justification": aside.reason,
    }
    if aside.location is not None:
        suppression["location"] = {"physicalLocation": _physical(aside.location)}
    return {**_result(aside.diagnostic, places), "suppressions": [suppression]}


def _result(diagnostic: Diagnostic, places: Mapping[str, int]) -> dict[str, Any]:
    location: dict[str, Any] = {"physicalLocation": _physical(diagnostic.location)}
    if diagnostic.element:
        location["logicalLocations"] = [
            {"fullyQualifiedName": diagnostic.element, "kind": "element"}
        ]
    result: dict[str, Any] = {
        "ruleId": diagnostic.rule,
        "level": _LEVELS[diagnostic.severity],
        "message": {
            "text": f"{diagnostic.message} ({diagnostic.hint})"
            if diagnostic.hint
            else diagnostic.message
        },
        "locations": [location],
        "partialFingerprints": {FINGERPRINT: _fingerprint(diagnostic)},
    }
    if diagnostic.rule in places:
        result["ruleIndex"] = places[diagnostic.rule]
    if diagnostic.related:
        result["relatedLocations"] = [
            {
                "id": number,
                "physicalLocation": _physical(note.location),
                "message": {"text": note.message},
            }
            for number, note in enumerate(diagnostic.related, 1)
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
        return Path(path).as_uri()
    text = quote(os.fsencode(pure.as_posix()))
    # A colon in the first part would read as a scheme (RFC 3986, section 4.2).
    return text.replace(":", "%3A")


def _fingerprint(diagnostic: Diagnostic) -> str:
    identity = (
        diagnostic.rule,
        diagnostic.location.path,
        diagnostic.element or diagnostic.fragment,
        diagnostic.message,
    )
    text = json.dumps(identity)
    return hashlib.sha256(text.encode("ascii")).hexdigest()

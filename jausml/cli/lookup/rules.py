"""The rules of all parts of the product, as JSON objects."""

from __future__ import annotations

from typing import Any

from jausml.authoring.merging.planning import MERGE_RULES
from jausml.generation.contract.finding import CODE_RULES
from jausml.language.exporters.jsidl import JSIDL_EXPORT_RULES
from jausml.language.importers.jsidl.building import JSIDL_RULES
from jausml.language.importers.ros.definitions import ROS_RULES
from jausml.language.text.notation import TEXT_RULES
from jausml.language.validation.rules import PRODUCT_RULES, catalogue
from jausml.proving.results import PROOF_RULES
from jausml.safety_case.rules import CASE_RULES


def all_entries() -> list[dict[str, Any]]:
    """Returns all rules, ordered by id."""
    return [
        {
            "rule": entry.id,
            "severity": entry.severity.value,
            "title": entry.title,
            "documentation": entry.documentation,
        }
        for entry in catalogue(
            JSIDL_RULES,
            JSIDL_EXPORT_RULES,
            ROS_RULES,
            TEXT_RULES,
            MERGE_RULES,
            CODE_RULES,
            PROOF_RULES,
            PRODUCT_RULES,
            CASE_RULES,
        )
    ]

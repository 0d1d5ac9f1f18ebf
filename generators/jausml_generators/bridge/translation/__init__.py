"""Attribute maps as straight-line Python statements.

Text of the model enters the statements only as literals and as names that were found in the model's
types.
"""

from __future__ import annotations

from jausml_generators.bridge.translation.surroundings import Surroundings
from jausml_generators.bridge.translation.translating import (
    Translated,
    TranslatedCall,
    Translations,
    translate,
)
from jausml_generators.bridge.translation.values import AssignmentError, ros_constant, ros_kind

__all__ = [
    "AssignmentError",
    "Surroundings",
    "Translated",
    "TranslatedCall",
    "Translations",
    "ros_constant",
    "ros_kind",
    "translate",
]

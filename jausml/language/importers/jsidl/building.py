"""Shared parts of all builders: how elements are made, and the rules of the importer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import assign, make
from jausml.language.model.diagnostics import RuleInfo, Severity
from jausml.language.model.model import Model
from jausml.language.model.reading.problems import NodePlace

JSIDL_RULES: Mapping[str, RuleInfo] = {
    "JML601": RuleInfo(
        "not a JSIDL document",
        "The root element is none of service_def, service_set, declared_type_set and "
        "declared_const_set of the namespace urn:jaus:jsidl:1.0 (AS5684).",
    ),
    "JML602": RuleInfo(
        "unknown JSIDL element",
        "AS5684 has no such element, or not at this place. Elements of the editors' namespace "
        "urn:jaus:jsidl:plus are skipped.",
    ),
    "JML603": RuleInfo("unknown JSIDL attribute", "The element has no such attribute in AS5684."),
    "JML604": RuleInfo(
        "missing in JSIDL", "An attribute or a child element that AS5684 requires is missing."
    ),
    "JML605": RuleInfo(
        "wrong value in JSIDL",
        "The text is not a value of the attribute. Values are type names, numbers, expressions of "
        "numbers and constants with the four operations and parentheses, hexadecimal message "
        "codes, true and false.",
    ),
    "JML606": RuleInfo(
        "declared twice",
        "Two services or sets of the same id and version, or two declarations of one name in a "
        "set. Give the importer one of them.",
    ),
    "JML607": RuleInfo(
        "set not found",
        "A declared_type_set_ref or declared_const_set_ref names a set that none of the files "
        "declares. Give the importer the file or the folder that holds it as well.",
    ),
    "JML608": RuleInfo(
        "declaration not found",
        "A dotted path of declared_type_ref, or a constant of an expression, leads to nothing: "
        "each name before the last is the name of a reference to a set, the last one is declared "
        "in that set.",
    ),
    "JML609": RuleInfo(
        "reference to another kind",
        "A declared_record takes a record, a declared_message_def a message_def, and so on.",
    ),
    "JML610": RuleInfo(
        "declaration contains itself",
        "A type that holds itself has no end on the wire, and a constant that needs itself no "
        "value.",
    ),
    "JML611": RuleInfo(
        "inherited service not found",
        "inherits_from names a service that neither the files nor the shipped library has.",
    ),
    "JML612": RuleInfo(
        "too much",
        "The declarations unfold into more elements, or nest deeper, than any message needs.",
    ),
    "JML613": RuleInfo(
        "wire format that cannot be expressed",
        "The file requires bytes on the wire that a model cannot express: a header or footer with "
        "its own fields, a tag that does not count from 0, or fields that are always empty.",
    ),
    "JML614": RuleInfo("no service", "The files declare types or constants, but no service."),
    "JML620": RuleInfo(
        "another version taken",
        "A reference to a set or service names a version that is missing; another one was used.",
        Severity.WARNING,
    ),
    "JML621": RuleInfo(
        "value assumed",
        "AS5684 requires the attribute, but existing files leave it out; a default was used.",
        Severity.WARNING,
    ),
    "JML622": RuleInfo(
        "transition left out",
        "The trigger or the target of a transition is unknown, so it could never be taken as "
        "intended. A service of the shipped library has messages, but neither internal events nor "
        "states.",
        Severity.WARNING,
    ),
    "JML623": RuleInfo(
        "guard kept as text",
        "The condition is not made of names, calls, &&, ||, ! and parentheses. It is kept in the "
        "documentation of the transition, which has one condition with a generated name instead.",
        Severity.WARNING,
    ),
    "JML624": RuleInfo(
        "behaviour simplified",
        "A part of a transition or of a state machine has no counterpart in the model. The message "
        "says what is kept and what is lost.",
        Severity.WARNING,
    ),
    "JML625": RuleInfo(
        "initial state assumed",
        "A group of states names none that is entered first; the first one was taken.",
        Severity.WARNING,
    ),
    "JML626": RuleInfo(
        "left out",
        "A part of the file has no place in a model and does not change the messages: a declared "
        "type that no message uses, the clients of a service.",
        Severity.INFO,
    ),
    "JML629": RuleInfo(
        "transition that stays",
        "A simple transition without an end state only acts here, as in the code of the JAUS Tool "
        "Set; AS5684 calls it a self transition, which runs the exit and entry actions of the "
        "state. Give it the state as its end state where they shall run.",
        Severity.INFO,
    ),
    "JML627": RuleInfo(
        "file passed over",
        "A file in a given folder is not JSIDL. A file that is named itself has to be.",
        Severity.INFO,
    ),
    "JML628": RuleInfo(
        "header not found",
        "The header of a message refers to a declaration that is not there. The header of every "
        "message is its code alone (AS5669A), so the message is imported as if it stated that.",
        Severity.WARNING,
    ),
}
"""The rules of the JSIDL importer by id. Ids are never used again for something else."""


ElementT = TypeVar("ElementT", bound="EObject")

MOST_ELEMENTS = 50_000
DEEPEST = 50


class TooMuchError(Exception):
    """The declarations unfold into more elements than any message needs."""


class Builder:
    """Makes elements of the jaus metamodel."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self._count = 0

    def new(self, kind: type[ElementT], place: NodePlace, /, **features: Any) -> ElementT:
        """Makes an element.

        Args:
            features: Its features: values, names of literals, elements, or lists of these. None
                leaves a feature alone.
        """
        self._count += 1
        if self._count > MOST_ELEMENTS:
            raise TooMuchError
        obj = make(self.model.metamodels, kind, **features)
        place.node.obj = obj
        self.model.adopt(place.document, place.node)
        return obj

    def set(self, obj: EObject, name: str, value: Any) -> None:
        """Sets a feature of an element, or adds to one with many values."""
        assign(obj, self.model.metamodels.class_of(obj).features[name], value)

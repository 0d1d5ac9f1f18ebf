"""What the named conversions take and yield, as their literals in bridge.ecore state it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from jausml.metamodel import annotation

CONVERSION_SOURCE = "http://www.jausml.org/bridge/conversion"


@dataclass(frozen=True, slots=True)
class ConversionSignature:
    """The signature of a conversion.

    Attributes:
        inputs: Kinds of the values that it takes.
        output: Kind of the value that it yields.
        arguments: Names of its arguments.
    """

    inputs: tuple[str, ...]
    output: str
    arguments: tuple[str, ...]


def conversion_signature(kind: Any) -> ConversionSignature:
    """Returns the signature of a literal of `bridge.ConversionKind`."""
    details = annotation(kind, CONVERSION_SOURCE)
    return ConversionSignature(
        tuple(details["inputs"].split()), details["output"], tuple(details["arguments"].split())
    )


def conversions_between(metamodels: Any, inputs: list[str], output: str) -> list[str]:
    """Returns the names of the conversions that lead from some kinds to another.

    Args:
        metamodels: The metamodels that declare the conversions.
        inputs: Kinds of the values at hand.
        output: The kind that is wanted.
    """
    literals = metamodels.package_named("bridge").enumerations["ConversionKind"].literals
    found = []
    for name, literal in literals.items():
        signature = conversion_signature(literal)
        if signature.inputs == tuple(inputs) and signature.output == output:
            found.append(name)
    return found

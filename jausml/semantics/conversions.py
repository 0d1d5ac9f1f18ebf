"""Conversions by name: what they take and yield, as their literals in bridge.ecore state it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from jausml.metamodel import annotation

CONVERSION_SOURCE = "http://www.jausml.org/bridge/conversion"

_INSTANCES = {"value": ("number", "bool", "text"), "numbers": ("list",), "number": ("value",)}


@dataclass(frozen=True, slots=True)
class ConversionSignature:
    """The signature of a conversion.

    Attributes:
        inputs: Kinds of the values that it takes; a `+` behind one stands for one or more.
        outputs: Kinds of the values that it yields.
        arguments: Names of its arguments.
        units: What becomes of units: `same`, `any`, `square`, `root`, `stated`, or the units that
            it takes and yields.
        frames: Frames that it takes and yields, empty when it has nothing to do with frames.
        turns: Whether the result has the opposite sign.
    """

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    arguments: tuple[str, ...]
    units: str = ""
    frames: tuple[str, ...] = ()
    turns: bool = False

    @property
    def output(self) -> str:
        """Kinds of the values that it yields, as one text."""
        return ", ".join(self.outputs)

    def takes(self, kinds: list[str]) -> bool:
        """Tells whether values of some kinds are what it takes."""
        if len(self.inputs) == 1 and self.inputs[0].endswith("+"):
            # The truth of a bool counts as 1 in expressions.
            known = ["number" if kind == "bool" else kind for kind in kinds]
            return bool(kinds) and all(_matches(kind, self.inputs[0][:-1]) for kind in known)
        return len(kinds) == len(self.inputs) and all(map(_matches, kinds, self.inputs))


def conversion_signature(kind: Any) -> ConversionSignature:
    """Returns the signature of a literal of `bridge.ConversionKind`."""
    return _signature(kind)


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
        if signature.inputs == tuple(inputs) and signature.outputs == (output,):
            found.append(name)
    return found


def _matches(kind: str, wanted: str) -> bool:
    return wanted == "any" or kind == wanted or kind in _INSTANCES.get(wanted, ())


@lru_cache(maxsize=256)
def _signature(kind: Any) -> ConversionSignature:
    details = annotation(kind, CONVERSION_SOURCE)
    return ConversionSignature(
        inputs=tuple(details["inputs"].split()),
        outputs=tuple(details["output"].split()),
        arguments=tuple(details["arguments"].split()),
        units=details.get("units", ""),
        frames=tuple(details.get("frames", "").split()),
        turns=details.get("sign") == "-1",
    )

"""Conversions by meaning, one class for each literal of `bridge.ConversionKind`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.conversions import authored, numbers, octets, orientations, times
from jausml.language.semantics.conversions.conversion import ANY as ANY
from jausml.language.semantics.conversions.conversion import VALUE as VALUE
from jausml.language.semantics.conversions.conversion import Argument as Argument
from jausml.language.semantics.conversions.conversion import ArgumentKind as ArgumentKind
from jausml.language.semantics.conversions.conversion import Conversion as Conversion
from jausml.language.semantics.conversions.conversion import Effect as Effect
from jausml.language.semantics.conversions.conversion import NoValueError as NoValueError
from jausml.language.semantics.conversions.conversion import UnitEffect as UnitEffect

_MODULES = (numbers, orientations, times, octets, authored)
CONVERSIONS: Mapping[str, Conversion] = {
    conversion_class.name: conversion_class()
    for module in _MODULES
    for conversion_class in vars(module).values()
    if isinstance(conversion_class, type)
    and issubclass(conversion_class, Conversion)
    and "name" in vars(conversion_class)
}
"""All conversions by name."""

NEGATION = next(
    conversion for conversion in CONVERSIONS.values() if conversion.effect is Effect.NEGATED
)
"""The conversion of a number to one of the other sign."""


def conversion_of(element: bridge.Conversion) -> Conversion:
    """Returns the meaning of a conversion of a model."""
    return CONVERSIONS[element.kind.name]


def conversions_between(inputs: Sequence[str], output: str) -> list[str]:
    """Returns the names of the conversions that lead from some kinds to another."""
    return [
        conversion.name
        for conversion in CONVERSIONS.values()
        if conversion.inputs == tuple(inputs) and conversion.outputs == (output,)
    ]

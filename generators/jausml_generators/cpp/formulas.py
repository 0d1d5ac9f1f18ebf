"""Expressions of the language of models, and definitions of conversions, in C++.

Each operation gives the bits that Python's gives: the file is compiled without contractions
(`-ffp-contract=off`), and what the C library decides is called in both languages.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.attributes.expressions import (
    COMPARISONS,
    Call,
    Conditional,
    Number,
    Operation,
    Variable,
)
from jausml.language.semantics.conversions.definition import PARTS, QUATERNION, Definition
from jausml.language.semantics.paths.attributes import TIME, TIME_STAMP
from jausml_generators.cpp.types import UnprintableError, cpp_name, cpp_number

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jausml.language.attributes.expressions import Expression
    from jausml.language.semantics.conversions.conversion import Conversion

_TOTAL = {
    "atan": "std::atan",
    "atan2": "std::atan2",
    "abs": "std::fabs",
    "floor": "jausml::round_down",
    "ceil": "jausml::round_up",
    "round": "jausml::round_off",
    "sign": "jausml::sign",
}
"""Functions that have a value everywhere."""

_PARTIAL = {
    name: f"std::{name}"
    for name in ("sin", "cos", "tan", "asin", "acos", "sqrt", "fmod", "remainder")
}
"""Functions that have none somewhere: what is then no finite number is left to Python."""

_FOLDED = {"min": "jausml::least", "max": "jausml::greatest"}
_LOGICAL = {"and": "&&", "or": "||"}
_TRUTHS = COMPARISONS | {"and", "or", "not"}

STRUCTS = {
    QUATERNION: "jausml::Quaternion",
    TIME: "jausml::Time",
    TIME_STAMP: "jausml::TimeStamp",
}
"""Structs of the values that are no single number."""


def number(expression: Expression, names: Mapping[str, str]) -> str:
    """Returns C++ that computes an expression as a `double`.

    Args:
        names: C++ for each variable.

    Raises:
        UnprintableError: An operation has no counterpart of the same bits.
    """
    match expression:
        case Number(value=value):
            text = cpp_number(float(value))
            return f"({text})" if text.startswith("-") else text
        case Variable(name=name):
            return names[name]
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            branches = f"{number(then, names)} : {number(otherwise, names)}"
            return f"({truth(condition, names)} ? {branches})"
        case Call(function="isfinite") | Operation(sign="<" | "<=" | ">" | ">=" | "==" | "!="):
            return f"static_cast<double>({truth(expression, names)})"
        case Call(function=function, arguments=arguments):
            return _call(function, [number(each, names) for each in arguments])
        case Operation(sign="and" | "or" | "not"):
            return f"static_cast<double>({truth(expression, names)})"
        case Operation(sign="/", operands=operands):
            dividend, divisor = (number(each, names) for each in operands)
            if isinstance(operands[1], Number) and operands[1].value:
                return f"({dividend} / {divisor})"
            return f"check.divide({dividend}, {divisor})"
        case Operation(sign="^", operands=operands):
            base, exponent = (number(each, names) for each in operands)
            return f"check.valued(std::pow({base}, {exponent}))"
        case Operation(sign=sign, operands=(only,)):
            return f"({sign}{number(only, names)})"
        case Operation(sign=sign, operands=(left, right)):
            return f"({number(left, names)} {sign} {number(right, names)})"
    raise UnprintableError(f"the expression {expression}")


def truth(expression: Expression, names: Mapping[str, str]) -> str:
    """Returns C++ that tells whether an expression differs from 0.

    Args:
        names: C++ for each variable.
    """
    match expression:
        case Call(function="isfinite", arguments=(only,)):
            return f"std::isfinite({number(only, names)})"
        case Operation(sign="not", operands=(only,)):
            return f"!{_bracketed(truth(only, names))}"
        case Operation(sign="and" | "or" as sign, operands=operands):
            left, right = (_bracketed(truth(each, names)) for each in operands)
            return f"{left} {_LOGICAL[sign]} {right}"
        case Operation(sign=sign, operands=(left, right)) if sign in COMPARISONS:
            return f"{number(left, names)} {sign} {number(right, names)}"
    return f"{number(expression, names)} != 0.0"


def _bracketed(text: str) -> str:
    return f"({text})" if " " in text else text


def _call(function: str, arguments: Sequence[str]) -> str:
    if function in _TOTAL:
        return f"{_TOTAL[function]}({', '.join(arguments)})"
    if function in _PARTIAL:
        return f"check.valued({_PARTIAL[function]}({', '.join(arguments)}))"
    if function in _FOLDED:
        made = arguments[0]
        for each in arguments[1:]:
            made = f"{_FOLDED[function]}({made}, {each})"
        return made
    # CPython computes the length of a vector by an algorithm of its own.
    raise UnprintableError(f"the function {function}")


def conversion_lines(conversion: Conversion) -> list[str]:
    """Returns the function of a conversion, whose arguments are those of its definition.

    Raises:
        UnprintableError: It has no arithmetic of its own.
    """
    definition = conversion.definition
    if not isinstance(definition, Definition):
        raise UnprintableError(f"the conversion {conversion.name}")
    parameters, lines, types = _parameters(conversion, definition)
    names = {each: cpp_name(each) for each in (*definition.parameters, *definition.steps)}
    if definition.refusal is not None:
        lines.append(f"check.require(!({truth(definition.refusal, names)}));")
    for name, value in definition.steps.items():
        lines.append(f"const double {names[name]} = {number(value, names)};")
    results = [number(each, names) for each in definition.results]
    kind, made = _result(conversion, results)
    text = "\n".join([*lines, made])
    check = "jausml::Check& check" if "check." in text else "jausml::Check&"
    template = [f"template <{', '.join(f'class {each}' for each in types)}>"] if types else []
    return [
        *template,
        f"inline {kind} {conversion.name}({', '.join([check, *parameters])}) {{",
        *(f"    {line}" for line in lines),
        f"    return {made};",
        "}",
    ]


def _parameters(
    conversion: Conversion, definition: Definition
) -> tuple[list[str], list[str], list[str]]:
    """Parameters, the lines that take them apart, and the names of their types."""
    rest = list(definition.parameters)
    parameters: list[str] = []
    lines: list[str] = []
    types: list[str] = []
    kinds = [*conversion.inputs, *([TIME] if conversion.needs_clock else [])]
    given = len(conversion.arguments)
    for at, kind in enumerate(kinds):
        is_near = conversion.needs_clock and at == len(kinds) - 1
        if is_near:
            numbers, rest = rest[:given], rest[given:]
            parameters += [f"double {cpp_name(each)}" for each in numbers]
            given = 0
        if kind not in PARTS:
            parameters.append(f"double {cpp_name(rest.pop(0))}")
            continue
        name = f"given{at + 1}" if not is_near else "near"
        types.append(f"Given{at + 1}")
        parameters.append(f"const Given{at + 1}& {name}")
        for part in PARTS[kind]:
            local = cpp_name(rest.pop(0))
            value = f"static_cast<double>({name}.{part})"
            lines.append(f"const double {local} = {value};")
    parameters += [f"double {cpp_name(each)}" for each in rest]
    used = " ".join(map(str, [definition.text, definition.refused]))
    kept = [line for line in lines if line.split()[2].rstrip("_") in used]
    return parameters, kept, types


def _result(conversion: Conversion, results: Sequence[str]) -> tuple[str, str]:
    outputs = conversion.outputs
    if len(outputs) > 1:
        return f"std::array<double, {len(outputs)}>", f"{{{', '.join(results)}}}"
    (kind,) = outputs
    if kind == QUATERNION:
        return STRUCTS[kind], f"{{{', '.join(results)}}}"
    if kind in STRUCTS:
        whole = (f"jausml::to_integer({each})" for each in results)
        return STRUCTS[kind], f"{{{', '.join(whole)}}}"
    return "double", results[0]

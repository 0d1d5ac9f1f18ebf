"""Expressions of the language of models, and definitions of conversions, in C++.

Each operation gives the bits that Python's gives: the file is compiled without contractions
(`-ffp-contract=off`), and what the C library decides is called in both languages.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence

from jausml.language.attributes.expressions import (
    COMPARISONS,
    Call,
    Conditional,
    Expression,
    Number,
    Operation,
    Variable,
)
from jausml.language.semantics.conversions.conversion import Conversion
from jausml.language.semantics.conversions.definition import PARTS, QUATERNION, Definition
from jausml.language.semantics.paths.attributes import TIME, TIME_STAMP
from jausml_generators.cpp.types import UnprintableError, cpp_name, cpp_number, laid_out

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
# How tightly an operator binds what stands beside it.
_ATOM, _SIGNED, _PRODUCT, _SUM, _COMPARISON, _OR, _CHOICE = range(7)

STRUCTS = {QUATERNION: "jausml::Quaternion", TIME: "jausml::Time", TIME_STAMP: "jausml::TimeStamp"}
"""Structs of the values that are no single number."""


def number(expression: Expression, names: Mapping[str, str], binding: int = _CHOICE) -> str:
    """Returns C++ that computes an expression as a `double`.

    Args:
        names: C++ for each variable.
        binding: How tightly what stands around it binds; what binds less is put in parentheses.
    """
    match expression:
        case Number(value=value):
            text = cpp_number(float(value))
            return _within(text, _SIGNED if text.startswith("-") else _ATOM, binding)
        case Variable(name=name):
            return names[name]
        # The right branch may be a choice itself, without parentheses.
        case Conditional(condition=condition, then=then, otherwise=otherwise):
            branches = f"{number(then, names, _OR)} : {number(otherwise, names)}"
            return _within(f"{truth(condition, names, _OR)} ? {branches}", _CHOICE, binding)
        case Call(function=function, arguments=arguments) if function != "isfinite":
            return _call(function, [number(argument, names) for argument in arguments])
        # Python refuses a division by 0; C++ would give an infinity.
        case Operation(sign="/", operands=(dividend, divisor)) if not _is_divisor(divisor):
            return f"check.divide({number(dividend, names)}, {number(divisor, names)})"
        case Operation(sign="^", operands=(base, exponent)):
            power = f"std::pow({number(base, names)}, {number(exponent, names)})"
            return f"check.valued({power})"
        case Operation(sign="-", operands=(only,)):
            return _within(f"-{number(only, names, _ATOM)}", _SIGNED, binding)
        case Operation(sign="+" | "-" | "*" | "/" as sign, operands=(left, right)):
            own = _PRODUCT if sign in "*/" else _SUM
            # Operators bind from the left: the same one on the right needs parentheses.
            text = f"{number(left, names, own)} {sign} {number(right, names, own - 1)}"
            return _within(text, own, binding)
    return f"static_cast<double>({truth(expression, names)})"


def truth(expression: Expression, names: Mapping[str, str], binding: int = _CHOICE) -> str:
    """Returns C++ that tells whether an expression differs from 0.

    Args:
        names: C++ for each variable.
        binding: How tightly what stands around it binds.
    """
    match expression:
        case Call(function="isfinite", arguments=(only,)):
            return f"std::isfinite({number(only, names)})"
        case Operation(sign="not", operands=(only,)):
            return f"!{truth(only, names, _ATOM)}"
        case Operation(sign="and" | "or" as sign, operands=operands):
            # Compilers warn where one of them stands within the other without parentheses.
            bindings = [_OR if _is_of(operand, sign) else _COMPARISON for operand in operands]
            left, right = (
                truth(operand, names, inner)
                for operand, inner in zip(operands, bindings, strict=True)
            )
            return _within(f"{left} {_LOGICAL[sign]} {right}", _OR, binding)
        case Operation(sign=sign, operands=(left, right)) if sign in COMPARISONS:
            text = f"{number(left, names, _SUM)} {sign} {number(right, names, _SUM)}"
            return _within(text, _COMPARISON, binding)
    return _within(f"{number(expression, names, _SUM)} != 0.0", _COMPARISON, binding)


def joined_truth(expression: Expression, names: Mapping[str, str]) -> str:
    """Returns the same for a condition beside others, which `&&` joins."""
    return truth(expression, names, _COMPARISON)


def _is_of(expression: Expression, sign: str) -> bool:
    return isinstance(expression, Operation) and expression.sign == sign


def _is_divisor(expression: Expression) -> bool:
    """Tells whether it may be a divisor: a number other than 0."""
    return isinstance(expression, Number) and expression.value != 0


def _within(text: str, own: int, binding: int) -> str:
    return f"({text})" if own > binding else text


def _call(function: str, arguments: Sequence[str]) -> str:
    if function in _TOTAL:
        return f"{_TOTAL[function]}({', '.join(arguments)})"
    if function in _PARTIAL:
        return f"check.valued({_PARTIAL[function]}({', '.join(arguments)}))"
    if function in _FOLDED:
        text = arguments[0]
        for argument in arguments[1:]:
            text = f"{_FOLDED[function]}({text}, {argument})"
        return text
    # CPython computes the length of a vector by an algorithm of its own.
    raise UnprintableError(f"the function {function}")


@functools.cache
def conversion_lines(conversion: Conversion) -> tuple[str, ...]:
    """Returns the function of a conversion, with the arguments of its definition."""
    definition = conversion.definition
    if not isinstance(definition, Definition):
        raise UnprintableError(f"the conversion {conversion.name}")
    parameters, lines, types = _parameters(conversion, definition)
    names = {
        parameter: cpp_name(parameter) for parameter in (*definition.parameters, *definition.steps)
    }
    if definition.refusal is not None:
        lines.append(f"check.require({_opposite(definition.refusal, names)});")
    for name, value in definition.steps.items():
        lines.append(f"const double {names[name]} = {number(value, names)};")
    results = [number(result, names) for result in definition.results]
    kind, return_lines = _result(conversion, results)
    text = "\n".join([*lines, *return_lines])
    # Unused parameters stay without a name, or compilers warn.
    check = "jausml::Check& check" if "check." in text else "jausml::Check&"
    template = (
        [f"template <{', '.join(f'class {type_name}' for type_name in types)}>"] if types else []
    )
    lines = [
        *template,
        f"inline {kind} {conversion.name}({', '.join([check, *parameters])}) {{",
        *(f"    {line}" for line in lines),
        *(f"    {line}" for line in return_lines),
        "}",
    ]
    return tuple(laid_out(lines))


def _opposite(condition: Expression, names: Mapping[str, str]) -> str:
    match condition:
        case Operation(sign="not", operands=(only,)):
            return truth(only, names)
    return f"!{truth(condition, names, _ATOM)}"


def _parameters(
    conversion: Conversion, definition: Definition
) -> tuple[list[str], list[str], list[str]]:
    """Parameters, the lines that take them apart, and the names of their types."""
    rest = list(definition.parameters)
    parameters: list[str] = []
    lines: list[str] = []
    types: list[str] = []
    kinds = [*conversion.inputs, *([TIME] if conversion.needs_clock else [])]
    argument_count = len(conversion.arguments)
    for at, kind in enumerate(kinds):
        is_near = conversion.needs_clock and at == len(kinds) - 1
        if is_near:
            # Arguments stand before the instant, as in the signature of Python.
            numbers, rest = rest[:argument_count], rest[argument_count:]
            parameters += [f"double {cpp_name(parameter)}" for parameter in numbers]
            argument_count = 0
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
    parameters += [f"double {cpp_name(parameter)}" for parameter in rest]
    used = " ".join(map(str, [definition.text, definition.refused]))
    # What the definition does not ask for would be an unused variable.
    kept = [line for line in lines if line.split()[2].rstrip("_") in used]
    return parameters, kept, types


def _result(conversion: Conversion, results: Sequence[str]) -> tuple[str, list[str]]:
    """Returns the type of the result of a conversion, and the statement that returns it."""
    (kind, *more) = conversion.outputs
    if kind not in STRUCTS and not more:
        return "double", [f"return {results[0]};"]
    # Parts of times are integers in the structs.
    if kind in {TIME, TIME_STAMP}:
        results = [f"jausml::to_integer({result})" for result in results]
    result_type = STRUCTS.get(kind, f"std::array<double, {len(conversion.outputs)}>")
    return result_type, ["return {", *(f"    {result}," for result in results), "};"]

"""Sweeps over the values of one number, without the rest of its message.

Of a translation and its opposite only the steps are printed that the number goes through, by the
printer that prints them all, so that billions of values take seconds. Numbers that go through lists
or conditions, or that come back as more than themselves, have no such sweep: whole messages do.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace

from jausml.generation import native
from jausml.language.cdr import FieldLayout, fields_of
from jausml.language.metamodel.classes import ros
from jausml_generators.bridge.translation.places import Local, Place, There
from jausml_generators.bridge.translation.steps import Choose, Let, Require, Step, Write
from jausml_generators.cpp.core import Compiled, Core
from jausml_generators.cpp.jaus_numbers import NUMBERS, read_number, write_number
from jausml_generators.cpp.types import (
    Places,
    Plain,
    Struct,
    UnprintableError,
    cpp_number,
    laid_out,
)
from jausml_generators.python.codec.members import Member as View
from jausml_generators.python.codec.scalars import Bits, Fixed

PROOF = "proof.hpp"
"""The header of sweeps."""

_INDENT = "    "
_SIZE = 4  # bytes of numbers of which all values can be tried, but hardly in whole messages


class _NoSweepError(Exception):
    """A number goes a way of which steps alone do not tell enough."""


def proof_program(
    core: Core,
    functions: Mapping[bool, Compiled],
    settings: Mapping[str, float | str],
    now: tuple[int, int],
) -> tuple[str, list[str]]:
    """Returns a program that puts values through translations, beside the core that has these.

    Args:
        functions: The translations, by whether they make messages of ROS.
        settings: The values of the attributes of the bridge.
        now: The time that translations are told.

    Returns:
        The program, and the paths of the numbers that it sweeps without the rest of the message.
    """
    sweeps = _sweeps(core, functions) if len(functions) == 2 else {}
    runs = ["jausml::proof::in_messages", *(f"sweep_{at}" for at in range(len(sweeps)))]
    lines = [
        f'#include "{native.SOURCE.name}"',
        f'#include "{PROOF}"',
        *(line for sweep in sweeps.values() for line in ("", *sweep)),
        "",
        *(line for function in functions.values() for line in _live(function, settings, now)),
        "int main() {",
        f"{_INDENT}const jausml::proof::Way ways[2] = {{",
        *(f"{2 * _INDENT}{_way(functions.get(direction))}," for direction in (True, False)),
        f"{_INDENT}}};",
        f"{_INDENT}return jausml::proof::serve(ways, {{{', '.join(runs)}}});",
        "}",
        "",
    ]
    return "\n".join(lines), list(sweeps)


def _way(compiled: Compiled | None) -> str:
    if compiled is None:
        return "{}"
    return f"{{{compiled.function}, &live_{compiled.function}, {len(compiled.joins)}}}"


def _live(
    compiled: Compiled, settings: Mapping[str, float | str], now: tuple[int, int]
) -> Iterator[str]:
    """Yields the values that a translation is given; joined messages are those of a sweep."""
    lists = (
        (
            "double",
            "quantities",
            [cpp_number(float(settings[quantity])) for quantity in compiled.quantities],
        ),
        ("jausml::Bytes", "texts", [_bytes(str(settings[text])) for text in compiled.texts]),
    )
    names = []
    for kind, what, items in lists:
        names.append(f"{what}_{compiled.function}")
        # An array has an element at least.
        yield f"const {kind} {names[-1]}[] = {{{', '.join([*items, '{}'])}}};"
    parts = ", ".join([*names, "nullptr", *map(str, now)])
    yield f"const jausml::Live live_{compiled.function} = {{{parts}}};"


def _bytes(text: str) -> str:
    # Text of the model: no character of it means anything in C++.
    literal = "".join(f"\\{byte:03o}" for byte in text.encode())
    return f'{{reinterpret_cast<const std::uint8_t*>("{literal}"), sizeof "{literal}" - 1}}'


def _sweeps(core: Core, functions: Mapping[bool, Compiled]) -> dict[str, tuple[str, ...]]:
    """The functions that sweep numbers of the JAUS message alone, by their paths."""
    sweeps: dict[str, tuple[str, ...]] = {}
    to_ros, to_jaus = functions[True].function, functions[False].function
    for path, member in core.inputs[to_ros][1].message.body.by_jaus_name.items():
        value = member.value
        if not isinstance(value, Fixed) or isinstance(value, Bits) or value.size != _SIZE:
            continue
        try:
            lines = _lines(core, f"sweep_{len(sweeps)}", to_ros, to_jaus, member)
            sweeps[path] = tuple(laid_out(lines))
        except (_NoSweepError, UnprintableError):
            continue
    return sweeps


def _lines(core: Core, name: str, to_ros: str, to_jaus: str, view: View) -> list[str]:
    value, place = view.value, Place("source", (view.attribute,))
    if not isinstance(value, Fixed) or value.python_type == "str":
        raise _NoSweepError
    there, between = _slice(core.inputs[to_ros][0], {place})
    sources = {replace(intermediate, root="source") for intermediate in between}
    back, reached = _slice(core.inputs[to_jaus][0], sources)
    # The number must come back at its own place, and at no other.
    if reached != {replace(place, root="target")}:
        raise _NoSweepError
    message, type_ = core.structs_of(to_ros)
    member = message.members[str(place.steps[0])]
    read, written = (
        f"(*{root}.{member.name})" if member.is_optional else f"{root}.{member.name}"
        for root in ("source", "returned")
    )
    guard = (
        [f"if (!returned.{member.name}.has_value()) return false;"] if member.is_optional else []
    )
    if _needs_joins(core, to_ros, there) or _needs_joins(core, to_jaus, back):
        raise _NoSweepError
    steps = core.printed_of(to_ros, there), core.printed_of(to_jaus, back)
    return [
        f"void {name}(const jausml::proof::Sweep& sweep, std::uint64_t from, std::uint64_t to,",
        f"{_INDENT}std::size_t most, jausml::proof::Tally& tally) {{",
        f"{_INDENT}using Jaus = {message.cpp};",
        f"{_INDENT}using Ros = {type_.cpp};",
        f"{_INDENT}jausml::proof::alone<Jaus, Ros>(sweep, from, to, most, tally,",
        *_lambda("jausml::JausInput& in, Jaus& source", [read_number(value, read)]),
        # What a step does not use must not be a warning.
        *_lambda(
            "const Jaus& source, Ros& target, const jausml::Live* live, jausml::Check& check",
            ["(void)source, (void)live, (void)check;", *steps[0]],
        ),
        *_lambda(
            "jausml::proof::Cell cell, Ros& target",
            list(_passed(core, to_ros, type_, sorted(between, key=str))),
        ),
        *_lambda(
            "const Ros& source, Jaus& target, const jausml::Live* live, jausml::Check& check",
            ["(void)source, (void)live, (void)check;", *steps[1]],
        ),
        *_lambda(
            "jausml::JausOutput& out, const Jaus& returned",
            [*guard, write_number(value, written, Plain(member.type.cpp)), "return true;"],
            end=");",
        ),
        "}",
    ]


def _needs_joins(core: Core, function: str, steps: Iterable[Step]) -> bool:
    joins = core.inputs[function][1].joins
    return any(place.root in joins for step in steps for place in _places(step))


def _lambda(parameters: str, body: Iterable[str], end: str = ",") -> list[str]:
    inner = (f"{3 * _INDENT}{line}" for line in body)
    return [f"{2 * _INDENT}[&]({parameters}) {{", *inner, f"{2 * _INDENT}}}{end}"]


# -- slices --------------------------------------------------------------------------------------


def _slice(steps: Iterable[Step], tainted: set[Place]) -> tuple[list[Step], set[Place]]:
    """Returns the steps that values of places go through, and the places that they reach."""
    known: set[Place | Local] = set(tainted)
    reached: set[Place] = set()
    kept = _kept(tuple(steps), known, reached)
    return _with_needed(tuple(steps), kept), reached


def _kept(
    steps: tuple[Step, ...], known: set[Place | Local], reached: set[Place]
) -> dict[int, Step]:
    """The steps that depend on what is known to be swept, by their number."""
    kept_steps: dict[int, Step] = {}
    for at, step in enumerate(steps):
        match step:
            case Let(locals=locals_, value=value) if _depends(value, known):
                known.update(locals_)
                kept_steps[at] = step
            case Write(place=place, value=value) if _depends(value, known):
                known.add(place)
                reached.add(place)
                kept_steps[at] = step
            case Choose(conditions=alternatives, steps=inner):
                kept = _kept(inner, known, reached)
                tests = [test for alternative in alternatives for test in alternative]
                # With a condition on the value, one value would not tell for the others.
                if any(_decides(test, known) for test in tests):
                    raise _NoSweepError
                if kept:
                    kept_steps[at] = replace(step, steps=tuple(_with_needed(inner, kept)))
            case Require(condition=condition) if _decides(condition, known):
                raise _NoSweepError
            case Let() | Write() | Require():
                continue
            case _ if _depends(step, known):
                raise _NoSweepError
    return kept_steps


def _with_needed(steps: tuple[Step, ...], kept: dict[int, Step]) -> list[Step]:
    """Adds the variables that kept steps use."""
    needed_steps = dict(kept)
    # From the last to the first, since a variable may need another one before it.
    for at in range(len(steps) - 1, -1, -1):
        step = steps[at]
        used = {variable for needed in needed_steps.values() for variable in _locals(needed)}
        if at not in needed_steps and isinstance(step, Let) and used & set(step.locals):
            needed_steps[at] = step
    return [needed_steps[at] for at in sorted(needed_steps)]


def _decides(condition: object, known: set[Place | Local]) -> bool:
    """Whether a condition asks for the value that is swept, and not only if it is there."""
    return not isinstance(condition, There) and _depends(condition, known)


def _depends(value: object, known: set[Place | Local]) -> bool:
    for place in _places(value):
        if place.root in known:
            return True
        if any(
            isinstance(known_place, Place)
            and (place.is_within(known_place) or known_place.is_within(place))
            for known_place in known
        ):
            return True
    return False


def _places(value: object) -> Iterator[Place]:
    if isinstance(value, Place):
        yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from _places(part)
    elif is_dataclass(value) and not isinstance(value, Local):
        for field in fields(value):
            yield from _places(getattr(value, field.name))


def _locals(step: Step) -> Iterator[Local]:
    yield from (place.root for place in _places(step) if isinstance(place.root, Local))


# -- between both ways ---------------------------------------------------------------------------


def _passed(core: Core, to_ros: str, struct: Struct, places: Iterable[Place]) -> Iterator[str]:
    """Yields the statements that take numbers to the bytes of ROS and back."""
    type_ = core.inputs[to_ros][1].type
    names = Places({}, {"target": struct}, {})
    for place in places:
        slot = names.at(place)
        if slot.is_element:
            continue  # it lies as on the wire
        layout = _layout(type_, place)
        if layout.message is not None:
            inner = (
                replace(place, steps=(*place.steps, field.name))
                for field in fields_of(layout.message)
            )
            yield from _passed(core, to_ros, struct, inner)
        elif layout.primitive is None or layout.primitive.code == "?" or not layout.is_single:
            raise _NoSweepError
        else:
            how = "real" if layout.primitive.code in "fd" else "integer"
            number = NUMBERS[layout.primitive.code]
            yield f"{slot.text} = cell.{how}<{number}>({slot.text});"


def _layout(type_: ros.MessageType, place: Place) -> FieldLayout:
    layout: FieldLayout | None = None
    for step in place.steps:
        if isinstance(step, int):
            continue
        inside = type_ if layout is None else layout.message
        if inside is None:
            raise _NoSweepError
        layout = next((field for field in fields_of(inside) if field.name == step), None)
        if layout is None:
            raise _NoSweepError
    if layout is None:
        raise _NoSweepError
    return layout

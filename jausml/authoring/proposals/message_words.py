"""Messages in words, as people say them on a command line.

    ReportDepth: Depth m 0..100, State off|on|auto, Name? text
    command SetDepth 0xD101: Depth m 0..100 uint32 scaled

In front of the colon stand the kind, where the name does not tell it, the name, and the code.
Behind it stand the fields, with commas between them. A field has a name, with a question mark when
it is optional, and in any order a unit, a range, listed values and a wire type.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from jausml.authoring.editing.commands import Child
from jausml.authoring.proposals.elements import AnswerError
from jausml.language.attributes.units import UnitError, nearest_units, parse_unit
from jausml.language.model.values import suggest
from jausml.language.semantics.names import is_identifier
from jausml.language.wire.kinds import TIME_STAMP

COMMAND, QUERY, REPORT = KINDS = "command", "query", "report"
_PREFIXES = {"Query": QUERY, "Report": REPORT, "Confirm": REPORT, "Reject": REPORT}

_CODE = re.compile(r"(?:0[xX])?(?P<digits>[0-9a-fA-F]{4})")
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_RANGE = re.compile(rf"(?P<lower>{_NUMBER})\.\.(?P<upper>{_NUMBER})")
_BITS = {"uint8": 8, "uint16": 16, "uint32": 32, "uint64": 64}
_FLOATS = ("float32", "float64")
_INTEGERS = (*_BITS, "int8", "int16", "int32", "int64")
_TYPES = (*_INTEGERS, *_FLOATS)
_TEXT, _TIME, _SCALED = "text", "TimeStamp", "scaled"
_USUAL, _USUAL_SCALED = "float32", "uint16"


@dataclass(frozen=True)
class MessageWish:
    """A message that is to be.

    `code`: its code, None for one that is free. `documentation`: what it is for, empty where nobody
    says it.
    """

    name: str
    kind: str
    code: int | None = None
    fields: tuple[Child, ...] = ()
    documentation: str = ""

    @property
    def subject(self) -> str:
        """What it is about: the name without what tells the kind."""
        for prefix in (*_PREFIXES, "Set"):
            rest = self.name.removeprefix(prefix)
            if rest and rest != self.name:
                return rest
        return self.name

    def child(self, code: int) -> Child:
        """Returns what adds it with a code."""
        values = {"name": (self.name,), "code": (f"0x{code:04X}",)}
        if self.kind == COMMAND:
            values["isCommand"] = ("true",)
        if self.documentation:
            values["documentation"] = (self.documentation,)
        body = (self._body(),) if self.fields else ()
        feature = "outputs" if self.kind == REPORT else "inputs"
        return Child(feature, "jaus.MessageDef", values, body)

    def _body(self) -> Child:
        values = {"name": (f"{self.subject}Rec",)}
        optional = sum("optional" in each.values for each in self.fields)
        if optional:
            values["presenceVector"] = (_narrowest(optional),)
        return Child("body", "jaus.Record", values, self.fields)


def message_of_words(text: str) -> MessageWish:
    """Returns the message that words describe."""
    head, _, fields = text.partition(":")
    words = head.split()
    kind = words.pop(0).lower() if words and words[0].lower() in KINDS and words[1:] else ""
    if not words:
        raise AnswerError(f"{text!a}: a message has a name, such as ReportDepth")
    name, *rest = words
    if not is_identifier(name):
        raise AnswerError(f"{text!a}: {name!a} is no name: letters, digits and single _")
    code = _CODE.fullmatch(rest[0]) if rest else None
    if rest[1:] or (rest and code is None):
        wrong = rest[1] if code else rest[0]
        raise AnswerError(f"{text!a}: {wrong!a} is no code such as 0xD101; fields follow a colon")
    prefix = next((each for each in _PREFIXES if name.startswith(each)), "")
    made = [_field(each, text) for each in fields.split(",")] if fields.strip() else []
    names = [each.values["name"][0] for each in made]
    twice = next((each for each in names if names.count(each) > 1), None)
    if twice is not None:
        raise AnswerError(f"{text!a}: two fields are named {twice}")
    number = int(code["digits"], 16) if code else None
    return MessageWish(name, kind or _PREFIXES.get(prefix, COMMAND), number, tuple(made))


@dataclass
class _Words:
    """What the words of a field say."""

    type: str = ""
    range: tuple[float, float] | None = None
    listed: tuple[str, ...] = ()
    units: str = ""
    is_scaled: bool = False


def _field(text: str, whole: str) -> Child:
    name, *words = text.split() or [""]
    values: dict[str, tuple[str, ...]] = {"name": (name.removesuffix("?"),)}
    if not is_identifier(values["name"][0]):
        raise AnswerError(f"{whole!a}: {name!a} is no name of a field")
    if name.endswith("?"):
        values["optional"] = ("true",)
    try:
        said = _said(words)
        return _made(values, said)
    except AnswerError as error:
        raise AnswerError(f"{whole!a}, field {values['name'][0]}: {error}") from None


def _said(words: Sequence[str]) -> _Words:
    said, units = _Words(), []
    for word in words:
        if word in (*_TYPES, _TEXT, _TIME):
            said.type = word
        elif word == _SCALED:
            said.is_scaled = True
        elif limits := _RANGE.fullmatch(word):
            said.range = _finite(limits["lower"]), _finite(limits["upper"])
        elif "|" in word:
            said.listed = tuple(word.split("|"))
        elif ".." in word:
            raise AnswerError(f"{word!a} is no range such as 0..100")
        else:
            units.append(word)
    said.units = " ".join(units)
    if said.units:
        _check_unit(said.units)
    return said


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise AnswerError(f"{text} is no number that a model can hold")
    return number


def _check_unit(text: str) -> None:
    try:
        parse_unit(text)
    except UnitError as error:
        near = nearest_units(text)
        hint = f"did you mean '{near[0]}'?" if near else suggest(text, _TYPES)
        raise AnswerError(
            f"{text!a} is no unit and no type{f'; {hint}' if hint else ''}"
        ) from error


def _made(values: dict[str, tuple[str, ...]], said: _Words) -> Child:
    if said.type in (_TEXT, _TIME):
        if said.range or said.listed or said.units or said.is_scaled:
            raise AnswerError(f"a {said.type} has no unit, range or values")
        if said.type == _TEXT:
            return Child("fields", "jaus.VariableLengthString", values)
        parts = tuple(_time_part(*each) for each in TIME_STAMP)
        return Child("fields", "jaus.BitField", {**values, "type": ("uint32",)}, parts)
    if said.units:
        values["units"] = (said.units,)
    if said.listed:
        return _listed(values, said)
    if said.range is None:
        if said.is_scaled:
            raise AnswerError("what is scaled needs a range such as 0..100")
        return Child("fields", "jaus.FixedField", {**values, "type": (said.type or _USUAL,)})
    return _ranged(values, said, said.range)


def _listed(values: dict[str, tuple[str, ...]], said: _Words) -> Child:
    if said.range or said.units or said.is_scaled or not all(said.listed):
        raise AnswerError(f"{'|'.join(said.listed)!a} lists values: no unit, no range, none empty")
    if len(set(said.listed)) < len(said.listed):
        raise AnswerError(f"{'|'.join(said.listed)!a} lists a value twice")
    if said.type in _FLOATS:
        raise AnswerError(f"listed values are integers, and no {said.type}")
    listed = tuple(
        Child("values", "jaus.EnumeratedValue", {"name": (name,), "value": (str(number),)})
        for number, name in enumerate(said.listed)
    )
    values["type"] = (said.type or "uint8",)
    return Child(
        "fields", "jaus.FixedField", values, (Child("values", "jaus.ValueSet", {}, listed),)
    )


def _ranged(values: dict[str, tuple[str, ...]], said: _Words, limits: tuple[float, float]) -> Child:
    """Returns a number with a range: scaled, or a count, which is whole and has no unit."""
    lower, upper = limits
    if not lower < upper:
        raise AnswerError(f"the range {lower:g}..{upper:g} begins above its end")
    if said.type in _FLOATS:
        raise AnswerError(f"a {said.type} has no range; an unsigned integer is scaled to one")
    is_whole = lower.is_integer() and upper.is_integer()
    is_count = not said.is_scaled and not said.units and is_whole
    bounds = {"lower": (repr(lower),), "upper": (repr(upper),)}
    if is_count:
        kind = said.type or _type_for(lower, upper)
        if not _holds(kind, lower, upper):
            raise AnswerError(f"{kind} does not hold {lower:g}..{upper:g}")
        whole = Child("values", "jaus.ValueRange", bounds)
        inner = Child("values", "jaus.ValueSet", {}, (whole,))
    else:
        kind = said.type or _USUAL_SCALED
        if kind not in _BITS:
            raise AnswerError(
                f"a scaled field is an unsigned integer such as uint16, and no {kind}"
            )
        inner = Child("scale", "jaus.ScaleRange", bounds)
    return Child("fields", "jaus.FixedField", {**values, "type": (kind,)}, (inner,))


def _type_for(lower: float, upper: float) -> str:
    """Returns the narrowest integer type for a range."""
    found = next((each for each in _INTEGERS if _holds(each, lower, upper)), None)
    if found is None:
        raise AnswerError(f"no integer type holds {lower:g}..{upper:g}")
    return found


def _holds(kind: str, lower: float, upper: float) -> bool:
    """Tells whether an integer type has the numbers of a range."""
    bits = int(kind.removeprefix("u").removeprefix("int"))
    first, last = (0, 1 << bits) if kind.startswith("u") else (-1 << bits - 1, 1 << bits - 1)
    return first <= lower and upper < last


def _narrowest(count: int) -> str:
    """Returns the type of a presence vector with so many bits."""
    found = next((name for name, bits in _BITS.items() if count <= bits), None)
    if found is None:
        raise AnswerError(f"a message has at most 64 optional fields, not {count}")
    return found


def _time_part(name: str, low: int, high: int, least: int, most: int) -> Child:
    limits = {"lower": (str(float(least)),), "upper": (str(float(most)),)}
    values = Child("values", "jaus.ValueSet", {}, (Child("values", "jaus.ValueRange", limits),))
    bits = {"name": (name,), "lowBit": (str(low),), "highBit": (str(high),)}
    return Child("subFields", "jaus.SubField", bits, (values,))

"""Whatever a map says: both forms of its translations make what its assignments mean."""

import importlib
import math
import os
import struct
from array import array
from datetime import datetime, timezone
from fractions import Fraction
from itertools import combinations, count
from random import Random
from typing import Any, NamedTuple

import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from jausml.generation.native import compiler
from jausml.language.validation.engine import check_project
from tests.generators.assignment_support import generated
from tests.models.mappings.by_chance import FORMATS, Outcome, by_bytes, outcome

EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "4")) // 2
NUMBER = count()
NOW = (1_700_000_000, 250_000_000)
NUMBERS = [name for name in sorted(FORMATS) if name[-1].isdigit()]
LARGEST = {"float32": 3.4028234663852886e38, "float64": 1.7976931348623157e308}
ODD = (0.0, -0.0, 1.5, -2.5, math.nan, math.inf, -math.inf, 1e300, 1e-45, 2.0**53)
GEARS = {1: 2, 2: 1, 0: 7, 7: 0}  # either way the same
CHAINS: dict[str, Any] = {
    "negate": lambda value: -value,
    "linear(2, -0.5)": lambda value: value * 2.0 - 0.5,
    "clamp(-3, 30)": lambda value: -3 if value < -3 else 30 if value > 30 else value,
    "square": lambda value: float(value) * value,
    "value_to_percent(5)": lambda value: value / 5.0 * 100.0,
    "look_up(gear)": lambda value: GEARS[value],
    'expression("if(3 < value and not value == 7, 1 - value, -2)")': (
        lambda value: 1.0 - value if value > 3 and value != 7 else -2.0
    ),
}
PAIRS: dict[str, Any] = {
    'expression("value1 - 2 * value2")': lambda one, two: float(one) - 2.0 * two,
    'expression("if(value1 < value2, value2, 0)")': (
        lambda one, two: float(two) if float(one) < float(two) else 0.0
    ),
}
STAMP = [
    *(("Milliseconds", 0, 9), ("Seconds", 10, 15), ("Minutes", 16, 21)),
    *(("Hour", 22, 26), ("Day", 27, 31)),
]
ROS_NAMES = [f"r{number}" for number in range(9)]
MODEL = """
service_set any_set {{ service Any {{ urn: "urn:example:Any"  inputs: new message_def SetAny {{
  code: 0xD301  body: new record AnyRec {{ presenceVector: uint32
    fixed_field unused {{ type: uint8  optional: true }}
{}
}} }} }} }}
any {{
  JAUS SetAny  ROS any_msgs/Any ( {} )
  table gear ( 1 <-> 2  2 <-> 1  0 <-> 7  7 <-> 0 )
  JAUS->ROS (
{}
  )
  ROS->JAUS (
{}
  )
}}
bridge {} {{ address: 1.1.2
  connection up {{ map: any  topic a }}
  connection down {{ map: any  direction: rosToJaus  topic a }} }}
"""


class DroppedError(Exception):
    """A message goes nowhere."""


class Field(NamedTuple):
    """A member of an end: a number, several, or a time; only JAUS has scales and absent ones.

    An array has three numbers, a list as many as there are; in JAUS, its elements are records.
    """

    name: str
    shape: str
    type: str
    scale: tuple[float, float] | None
    is_optional: bool

    def __str__(self) -> str:
        if self.name in ROS_NAMES:
            bound = "" if self.most == 4 else f"<={self.most}"
            kind = {
                "time": "builtin_interfaces/Time",
                "array": f"{self.type} [3]",
                "list": f"{self.type} [{bound}]",
            }
            return f"{kind.get(self.shape, self.type)} {self.name}"
        scale = "scale: {{ lower: {} upper: {} }}".format(*self.scale) if self.scale else ""
        number = f"type: {self.type}  {scale}"
        bits = (
            f"sub_field {name} {{ lowBit: {low} highBit: {high} }}" for name, low, high in STAMP
        )
        start = {
            "one": f"fixed_field {self.name} {{ {number}",
            "array": f"array {self.name} {{ dimensions: 3  element: new fixed_field e {{{number}}}",
            "list": f"list {self.name} {{ maximumCount: {self.most}  "
            f"element: new record {self.name}rec {{ fixed_field value {{ {number} }} }}",
            "time": f"bit_field {self.name} {{ type: uint32  {' '.join(bits)}",
        }[self.shape]
        return f"{start}  optional: {str(self.is_optional).lower()} }}"

    @property
    def most(self) -> int:
        """The most elements of a list; 4 for one without a bound."""
        return 3 if self.name not in ROS_NAMES else 2 if self.name[-1] in "13579" else 4

    @property
    def limits(self) -> Any:
        if self.type in LARGEST:
            return -LARGEST[self.type], LARGEST[self.type]
        bits = 8 * struct.calcsize(FORMATS[self.type]) - (self.type[0] != "u")
        return 0 if self.type[0] == "u" else -(2**bits), 2**bits - 1

    def drawn(self, chance: Random) -> Any:
        """Returns a value by chance, None for none."""
        if self.is_optional and chance.random() < 0.2:
            return None
        if self.shape == "time":
            return NOW[0] + chance.randint(-800_000, 800_000), chance.randrange(1000) * 10**6
        length = chance.randint(0, self.most) if self.shape == "list" else 3
        values = [self._number(chance) for _ in range(length)]
        return values[0] if self.shape == "one" else values

    def _number(self, chance: Random) -> Any:
        low, high = self.limits
        if self.type not in LARGEST:
            whole = chance.choice([low, high, 0, 1, 2, 7, chance.randint(low, high)])
            scale = self.scale or (0, high)
            return scale[0] + whole * ((scale[1] - scale[0]) / high) if self.scale else whole
        odd = [value for value in ODD if math.isfinite(value) or self.name in ROS_NAMES]
        value = chance.choice([*odd, *(chance.uniform(-50, 50) for _ in odd)])
        cut = value if math.isinf(value) else min(max(value, low), high)
        return struct.unpack(FORMATS[self.type], struct.pack(FORMATS[self.type], cut))[0]

    def fitted(self, value: Any, policy: str) -> Any:
        """Returns what the field carries for a number, None where it is left out."""
        if self.type == "float64" and self.name in ROS_NAMES:
            return float(value)
        low, high = self.scale or self.limits
        is_real = self.type in LARGEST
        slack = 0 if is_real else 1e-9 if self.scale else Fraction(499_999_999, 10**9)
        exact = Fraction(value) if math.isfinite(value) else value
        if not low - slack <= exact <= high + slack:
            if policy == "dropField":
                return None
            if policy != "clamp" or math.isnan(value) or (is_real and math.isinf(value)):
                raise DroppedError
        nearest = min(max(value, low), high)
        return float(nearest) if is_real or self.scale else round(nearest)


class Line(NamedTuple):
    """An assignment; one without sources is of a constant or of the clock."""

    target: Field
    sources: tuple[Field, ...]
    chain: tuple[str, ...]
    policy: str
    absent: str

    def __str__(self) -> str:
        names = ", ".join(source.name for source in self.sources)
        shape, is_up = self.target.shape, self.target.name in ROS_NAMES
        ends = f"{names or ('clock' if shape == 'time' else 3)} -> {self.target.name}"
        absent = f"whenAbsent: {self.absent}" if is_up and self.sources else ""
        if shape == "time" or not self.sources:
            kind = "timestamp_to_time" if is_up else "time_to_timestamp"
            return ends + (f" : {kind} {{ {absent} }}" if self.sources else "")
        inner = f"{': ' if self.chain else ''}{', '.join(self.chain)} {{ outOfRange: {self.policy}"
        if shape == "one":
            return f"{ends} {inner} {absent} }}"
        index = ", index" if PAIRS.keys() & self.chain else ""
        element, filled = ("value", ".") if is_up else (".", "value")
        element, filled = (element, filled) if shape == "list" else (".", ".")
        return f"{ends} {{ {element}{index} -> {filled} {inner} }} {absent} }}"

    def result(self, values: dict[Field, Any]) -> Any:
        """Returns what becomes of the target."""
        found, shape = [values[source] for source in self.sources], self.target.shape
        if None in found and self.absent == "dropMessage":
            raise DroppedError
        if None in found:
            return {"one": 0, "array": [0] * 3, "list": [], "time": (0, 0)}[shape]
        if shape == "time":
            return found[0] if found else NOW
        if shape == "one":
            return self._number(*found) if found else 3
        if shape == "list" and len(found[0]) > self.target.most:
            raise DroppedError
        return [self._number(*entry) for entry in zip(found[0], count(), strict=False)]

    def _number(self, *values: Any) -> Any:
        value = values[0]
        for name in self.chain:
            value = PAIRS[name](*values) if name in PAIRS else CHAINS[name](value)
        return self.target.fitted(value, self.policy)


@st.composite
def maps(draw: st.DrawFn) -> tuple[list[Field], list[Field], list[Line]]:
    """Returns the members of JAUS and of ROS, and assignments to either."""

    def choice(things: Any) -> Any:
        return draw(st.sampled_from(things))

    def fields(names: Any, types: list[str], scales: Any) -> list[Field]:
        drawn = []
        for name in names:
            shape, kind = choice(["one", "one", "array", "list", "time"]), choice(types)
            scale = choice(scales) if kind[0] == "u" and kind != "uint64" else None
            is_optional = name[0] == "j" and (shape == "time" or draw(st.booleans()))
            drawn.append(Field(name, shape, kind, scale, is_optional))
        return drawn

    def line(target: Field, sources: list[Field]) -> Line:
        fitting = [source for source in sources if source.shape == target.shape]
        is_one = target.shape == "one"
        constants = [()] if target.shape == "time" or is_one else []
        pairs = combinations(fitting, 2) if is_one else ()
        chosen = choice([*((source,) for source in fitting), *pairs, *constants] or [None])
        chain = draw(st.lists(st.sampled_from(sorted(CHAINS)), max_size=2))
        if chosen and (len(chosen) > 1 or (not is_one and draw(st.booleans()))):
            chain.insert(0, choice(sorted(PAIRS)))
        policies = ["clamp", "dropMessage", *["dropField"] * (target.is_optional and is_one)]
        return Line(
            target, chosen, tuple(chain), choice(policies), choice(["dropMessage", "leave"])
        )

    jaus_names = [f"j{number}" for number in range(draw(st.integers(2, 9)))]
    jaus = fields(jaus_names, NUMBERS, [None, (-10.0, 10.0), (0.0, 100.0), (1.0, 3.5)])
    ros = fields(ROS_NAMES[: draw(st.integers(2, 9))], NUMBERS, [None])
    lines = [line(target, jaus) for target in ros] + [line(target, ros) for target in jaus]
    return jaus, ros, [drawn for drawn in lines if drawn.sources is not None]


@pytest.mark.slow
@pytest.mark.timeout(400)
@settings(max_examples=EXAMPLES, phases=[Phase.generate], suppress_health_check=list(HealthCheck))
@given(drawn=maps(), chance=st.randoms(use_true_random=False))
def test_both_forms_make_what_a_map_means(tmp_path_factory, drawn, chance):
    jaus, ros, lines = drawn
    folder, name = tmp_path_factory.mktemp("any_map"), f"any_map_{next(NUMBER)}"
    model, refused = folder / "model.ros2jaus", {None}
    while refused:
        lines = [line for line in lines if line not in refused]
        ways = [[line for line in lines if line.target in ends] for ends in (ros, jaus)]
        text = MODEL.format(*("\n".join(map(str, part)) for part in (jaus, ros, *ways)), name)
        model.write_text(text, encoding="utf-8")
        faults = check_project([model]).diagnostics
        rows = [fault.location.line - 1 for fault in faults if fault.severity.name == "ERROR"]
        bad = {text.splitlines()[row] for row in rows}
        is_by_table = any(row.startswith("  table") for row in bad)
        refused = {
            line
            for line in lines
            if str(line) in bad or (is_by_table and "look_up(gear)" in line.chain)
        }
    made = generated(text, folder, name)
    if all(any(line.sources for line in way) for way in ways):
        made.check_text()
    if compiler() and f"{name}/core/core.cpp" in made.artifacts:
        made.build()
    for _ in range(40):
        for sources, way in ((jaus, "up"), (ros, "down")):
            values = {source: source.drawn(chance) for source in sources}
            check(made, way, values, [line for line in lines if line.target not in sources])


def rounded(field: Field, values: list[Any]) -> list[Any]:
    return list(array(FORMATS[field.type], values))


def check(made: Any, way: str, values: dict[Field, Any], lines: list[Line]) -> None:
    """Compares what becomes of values, by the method and by the core, with what it should be."""
    connection, method = getattr(made.bridge, way), getattr(made.bridge, f"translate_{way}")
    types = importlib.import_module(f"{made.package}.ros_types")
    now = importlib.import_module("jausml_runtime.conversions").Time(*NOW)
    made.bridge.now = lambda: now

    def stored(field: Field, value: Any) -> Any:
        """Returns a value as the messages have it."""
        if value is None or field.shape in ("one", "array"):
            return value
        if field.shape == "list":
            record = getattr(made.messages.SetAny, f"{field.name.capitalize()}rec", None)
            # ROS has lists of numbers in their own precision.
            return [record(number) for number in value] if record else rounded(field, value)
        if field.name in ROS_NAMES:
            return types.Time(*value)
        utc = datetime.fromtimestamp(value[0], tz=timezone.utc)
        parts = (value[1] // 10**6, utc.second, utc.minute, utc.hour, utc.day)
        return getattr(made.messages.SetAny, field.name.capitalize())(*parts)

    kind = made.messages.SetAny if way == "up" else types.Any
    source = kind(**{field.name: stored(field, value) for field, value in values.items()})
    readable = outcome(connection, method, source)
    try:
        results = {line.target: line.result(values) for line in lines}
    except (DroppedError, KeyError):
        assert issubclass(readable.result, made.error("JausError"))
    else:
        for field, value in results.items():
            found = getattr(readable.result, field.name)
            plain = list(found) if isinstance(value, list) else found
            if field.shape == "list" and field.name in ROS_NAMES:
                plain = rounded(field, plain)
            assert plain == stored(field, value), (field, values)
    if compiler() and hasattr(method, "compiled"):
        data = source.encode() if way == "up" else source.to_cdr()
        by_method = outcome(connection, by_bytes(made.bridge, way), data)
        by_core = outcome(connection, made.compiled(way), data)
        assert by_core in (by_method, Outcome(None, {})), values

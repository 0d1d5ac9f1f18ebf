"""The module of the generated tests of a bridge.

Where both directions of a map are used, values of JAUS are also tested to come back from ROS.
"""

from __future__ import annotations

import functools
import math
from collections import defaultdict
from collections.abc import Container, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from jausml.generation.literals import python_literal
from jausml.generation.python import Imports, Origin, offered
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.conversions.definition import QUATERNION
from jausml_generators.bridge.checks.absences import absences
from jausml_generators.bridge.checks.check import NAME, Chain, Check, frame_stand_in, store, tidy
from jausml_generators.bridge.checks.connection_checks import examples, forms, safe_values, times
from jausml_generators.bridge.checks.ends import Ends
from jausml_generators.bridge.checks.filling import (
    Code,
    JausMessage,
    Place,
    RosMessage,
    is_there,
    short_name,
)
from jausml_generators.bridge.checks.samples import Sample, chain_gain, limits, sample_of
from jausml_generators.bridge.checks.vectors import vectors
from jausml_generators.bridge.connections import ConnectionView
from jausml_generators.bridge.translation.expressions import INTEGER, REAL
from jausml_generators.bridge.translation.places import PathError
from jausml_generators.bridge.translation.ros_fields import ros_field
from jausml_generators.bridge.translation.translation import frames_of
from jausml_generators.bridge.translation.values import AssignmentError
from jausml_generators.bridge.views import BridgeView
from jausml_generators.common.ros import RosClasses
from jausml_generators.python.names import Scope
from jausml_generators.python.package import runtime_names
from jausml_generators.python.statements import call


@dataclass(frozen=True)
class TestModule:
    """The view for the template of the generated tests."""

    __test__ = False  # pytest takes classes named Test... for tests
    bridge: BridgeView

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return self.bridge.element_id

    @property
    def source(self) -> str:
        """Model file."""
        return self.bridge.source

    @functools.cached_property
    def checks(self) -> tuple[Check, ...]:
        """The tests in the order of the connections, under names of their own."""
        names = Scope()
        checks = list(self._checks()) or [self._connections()]
        return tuple(replace(check, name=names.claim(check.name)) for check in checks)

    @property
    def dependencies(self) -> tuple[str, ...]:
        """Packages that the tests need, sorted."""
        packages = ["python3-pytest"]
        # A translation that cannot be written is reported by the template that it stands in.
        with suppress(AssignmentError, PathError):
            if any(check.decorators for check in self.checks):
                packages.insert(0, "python3-hypothesis")
        return tuple(packages)

    @property
    def uses_fixture(self) -> bool:
        """Whether some test takes the bridge as a fixture."""
        return not all(check.parameters for check in self.checks)

    def parameters(self, check: Check) -> tuple[str, ...]:
        """Returns the parameters of a test with their types."""
        return check.parameters or (f"bridge: {self.bridge.class_name}",)

    @property
    def imports(self) -> Imports:
        """The names that the module may import."""
        messages = (view.class_name for view in self.bridge.messages)
        return Imports(
            {
                **runtime_names(),
                **self.bridge.light.origins(self._ros_classes, f"{self.bridge.package}.ros_types"),
                **offered("hypothesis", "given", "settings"),
                "st": Origin("hypothesis", "strategies"),
                **offered(f"{self.bridge.package}.{self.bridge.package}", self.bridge.class_name),
                **offered(f"{self.bridge.package}.messages", *messages),
            },
            own=self.bridge.package,
        )

    @functools.cached_property
    def _ros_classes(self) -> RosClasses:
        """Names of the ROS classes, also of those that only tests make."""
        return self.bridge.translations.ros_classes.copy()

    def _checks(self) -> Iterator[Check]:
        sampled: list[tuple[Ends, Sample]] = []
        known: dict[object, tuple[Sample | None, list[Check]]] = {}
        for view in self.bridge.connections:
            ends = self._ends(view, view.name)
            frames = frames_of(view.connection.map)
            if view.alike not in known:
                stand_ins = {
                    path: Code(frame_stand_in(number)) for number, path in enumerate(frames)
                }
                shared = self._ends(view.unnamed(), NAME)
                known[view.alike] = self._shared(replace(shared, frames=stand_ins))
            sample, checks = known[view.alike]
            names = view.name, view.message_name, frames.values()
            yield from (check.of(*names) for check in checks)
            if sample is not None:
                sampled.append((ends, sample))
            yield from safe_values(ends)
        yield from round_trips(sampled, self.bridge.class_name)
        yield from times(self.bridge.connections)
        for call_view in self.bridge.calls:
            for half in call_view.halves.values():
                yield from self._translation(self._ends(half, half.name))[1]

    def _ends(self, view: ConnectionView, name: str) -> Ends:
        return Ends(view, name, self._ros_classes.name_of, self.bridge.translations.uses)

    def _shared(self, ends: Ends) -> tuple[Sample | None, list[Check]]:
        """Returns a source message, if one is known to pass, and the checks without safe values."""
        sample, checks = self._translation(ends)
        checks.append(forms(ends, sample))
        return sample, checks

    @staticmethod
    def _translation(ends: Ends) -> tuple[Sample | None, list[Check]]:
        """Returns a source message, if one is known to pass, and the checks of its values."""
        checks = list(vectors(ends))
        sample = sample_of(ends)
        if sample is not None:
            checks += examples(ends, sample)
            checks += absences(ends, sample)
            checks += limits(ends, sample)
        return sample, checks

    def _connections(self) -> Check:
        """Checks that the bridge can be made, where there is nothing else to check."""
        about = "The bridge has its connections."
        count = len(self.bridge.connections) + len(self.bridge.calls)
        return Check("connections", about, (f"assert len(bridge.connections) == {count}",))


_EXAMPLES = 50
# Near the vertical, roll and yaw turn about the same axis and cannot be told apart.
_STEEPEST, _UPWARD = 1.5, "y"
_SINGLE_PRECISION = 2.0**-23
_LARGEST_EXACT = 2.0**53
_NOTHING = {"self", "bridge", "source", "there", "back", "math", "pytest", "st"}


@dataclass(frozen=True)
class _Returning:
    """A value that returns.

    Attributes:
        tolerance: How far off it may return.
    """

    place: Place
    low: float
    high: float
    tolerance: float
    is_angle: bool = False


def round_trips(sampled: Sequence[tuple[Ends, Sample]], class_name: str) -> Iterator[Check]:
    """Yields a check for each two connections that carry a message there and back by one map."""
    homeward: dict[bridge.AttributeMap, list[Ends]] = defaultdict(list)
    for ends, _ in sampled:
        if not ends.to_ros:
            homeward[ends.map].append(ends)
    for there, sample in sampled:
        for back in homeward[there.map] if there.to_ros else ():
            returning = _returning(there, back, sample)
            if returning and _is_taken(there, back, sample):
                yield _check(there, back, sample, returning, class_name)


def _is_taken(there: Ends, back: Ends, sample: Sample) -> bool:
    """Whether no marker has the message dropped on the way back, whatever returns."""
    varied = {path for chain in there.chains for path in chain.targets}
    lacking = back.lacking(sample.expected)
    return not any(
        chain.assignment.whenAbsent.name == "dropMessage"
        and (chain in lacking or _is_asked(back, chain, varied))
        and not set(chain.sources) & set(sample.changed)
        for chain in back.chains
    )


def _is_asked(back: Ends, chain: Chain, paths: Container[str]) -> bool:
    """Whether markers of the sources of a chain ask what stands at some paths."""
    source = back.source
    if not isinstance(source, RosMessage):
        return False
    markers = [marker for path in chain.sources for marker in source.markers(path)]
    return any(place.path in paths for marker in markers for place in marker.places.values())


def _returning(there: Ends, back: Ends, sample: Sample) -> list[_Returning]:
    returns_by_path: dict[str, _Returning] = {}
    lacking = back.lacking(sample.expected)
    homewards: defaultdict[object, list[Chain]] = defaultdict(list)
    for homeward in back.chains:
        homewards[tuple(homeward.targets), tuple(homeward.sources)].append(homeward)
    for outward in there.chains:
        for homeward in homewards[tuple(outward.sources), tuple(outward.targets)]:
            if homeward in lacking or _is_asked(back, homeward, outward.targets):
                continue
            for angle in (*_number(there, outward, homeward), *_angles(there, outward, homeward)):
                if angle.place.path in sample.values:
                    returns_by_path.setdefault(angle.place.path, angle)
    return list(returns_by_path.values())


def _number(there: Ends, outward: Chain, homeward: Chain) -> Iterator[_Returning]:
    both = [step.conversion for step in (*outward.steps, *homeward.steps)]
    is_angle = any(conversion.is_of_turns for conversion in both)
    if is_angle and not all(
        conversion.is_of_turns or conversion.changes_nothing for conversion in both
    ):
        return
    if not is_angle and not (outward.leads_back and homeward.leads_back):
        return
    place, middle = there.source.place(outward.sources[0]), there.target.place(outward.targets[0])
    low, high = _range(place)
    if place.kind == REAL and middle.kind == REAL and math.isfinite(high - low):
        tolerance = _tolerance(there, outward, place, is_angle=is_angle)
        yield _Returning(place, low, high, tolerance, is_angle)
    elif place.kind == INTEGER and middle.kind == INTEGER and not both:
        least, greatest = max(low, middle.limits[0]), min(high, middle.limits[1])
        if least < greatest:
            yield _Returning(place, least, greatest, 0.0)


def _range(place: Place) -> tuple[float, float]:
    """The limits of a field, or its widest legal range."""
    if not place.ranges:
        return place.limits
    return max(place.ranges, key=lambda ends: ends[1] - ends[0])


def _tolerance(there: Ends, outward: Chain, place: Place, *, is_angle: bool) -> float:
    """A step of the field, and what the ROS type on the way rounds off."""
    largest = max(map(abs, place.limits))
    field = ros_field(there.map.type, outward.targets[0])
    relative = _SINGLE_PRECISION if field.type == "float32" else 2 / _LARGEST_EXACT
    gain = 1.0 if is_angle else abs(chain_gain(outward))
    offset = 0.0 if is_angle else abs((outward.forward([0.0]) or 0.0) / gain)
    return place.step + (largest + offset) * relative


def _angles(there: Ends, outward: Chain, homeward: Chain) -> Iterator[_Returning]:
    """Roll, pitch and yaw by an orientation."""
    if len(outward.steps) != 1:
        return
    conversion = outward.steps[0].conversion
    is_undone = conversion.inverse in [step.name for step in homeward.steps]
    if conversion.outputs != (QUATERNION,) or not is_undone:
        return
    for path, axis in zip(outward.sources, conversion.takes_axes, strict=True):
        steepest = _STEEPEST if axis == _UPWARD else math.pi
        place = there.source.place(path)
        low, high = max(place.limits[0], -steepest), min(place.limits[1], steepest)
        # The steps of all three angles change each of the three.
        tolerance = 4 * place.step if steepest == _STEEPEST else 40 * place.step
        yield _Returning(place, low, high, max(tolerance, 1e-9), is_angle=True)


def _check(
    there: Ends, back: Ends, sample: Sample, returning: Sequence[_Returning], class_name: str
) -> Check:
    source = JausMessage(there.map.message, there.view.message, "source")
    scope = Scope(frozenset(_NOTHING))
    names = [scope.claim(short_name(value.place.path)) for value in returning]
    jaus = there.view.source_name
    varied = {value.place.path: Code(name) for name, value in zip(names, returning, strict=True)}
    lines = [f"bridge = {class_name}()", *source.fill({**sample.values, **varied})]
    lines += [
        f"source = {jaus}.decode(source.encode())",
        store("there", there.call("source")),
        f"assert isinstance(there, {there.view.target_name})",
        *back.joined(),
        store("back", back.call("there")),
        f"assert isinstance(back, {jaus})",
        f"back = {jaus}.decode(back.encode())",
    ]
    for name, returned_value in zip(names, returning, strict=True):
        place = back.message("back", is_ros=False).place(returned_value.place.path)
        lines += [*is_there(place), _returned(place.code, name, returned_value)]
    strategies = tuple(_strategy(name, value) for name, value in zip(names, returning, strict=True))
    decorators = (
        f"@settings(deadline=None, derandomize=True, database=None, max_examples={_EXAMPLES})",
        f"@{call('given', *strategies)}",
    )
    parameters = tuple(
        f"{name}: {'int' if value.place.kind == INTEGER else 'float'}"
        for name, value in zip(names, returning, strict=True)
    )
    about = f"What {there.name} gives to ROS comes back by {back.name}, within a step."
    return Check(f"{there.name}_and_back", about, tidy(lines), decorators, parameters)


def _strategy(name: str, returned: _Returning) -> str:
    if returned.place.kind == INTEGER:
        return call(f"{name}=st.integers", str(int(returned.low)), str(int(returned.high)))
    ends = (python_literal(float(end)) for end in (returned.low, returned.high))
    return call(f"{name}=st.floats", *ends)


def _returned(code: str, name: str, value: _Returning) -> str:
    if value.place.kind == INTEGER:
        return f"assert {code} == {name}"
    tolerance = python_literal(float(value.tolerance))
    if value.is_angle:
        return f"assert abs(math.remainder({code} - {name}, math.tau)) <= {tolerance}"
    approx = call("pytest.approx", name, "rel=0.0", f"abs={tolerance}")
    return f"assert {code} == {approx}"

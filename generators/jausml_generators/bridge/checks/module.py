"""The module of the generated tests of a bridge."""

from __future__ import annotations

import functools
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.generation.languages.python import Imports, Origin, offered
from jausml_generators.bridge.checks.check import NAME, Check
from jausml_generators.bridge.checks.connection_checks import (
    absences,
    examples,
    forms,
    safe_values,
    vectors,
)
from jausml_generators.bridge.checks.ends import Ends
from jausml_generators.bridge.checks.limits import limits
from jausml_generators.bridge.checks.round_trips import round_trips
from jausml_generators.bridge.checks.samples import sample_of
from jausml_generators.bridge.translation import AssignmentError
from jausml_generators.bridge.translation.ros_fields import PathError
from jausml_generators.common import runtime
from jausml_generators.python.names import Scope

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml_generators.bridge.checks.samples import Sample
    from jausml_generators.bridge.connections import ConnectionView
    from jausml_generators.bridge.ros_classes import RosClasses
    from jausml_generators.bridge.views import BridgeView


@dataclass(frozen=True)
class TestModule:
    """What the template of the generated tests asks."""

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

    @property
    def name(self) -> str:
        """Name of the bridge."""
        return self.bridge.name

    @property
    def package(self) -> str:
        """Package of the bridge."""
        return self.bridge.package

    @property
    def class_name(self) -> str:
        """Class of the user's skeleton."""
        return self.bridge.class_name

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
            if any(each.decorators for each in self.checks):
                packages.insert(0, "python3-hypothesis")
        return tuple(packages)

    @property
    def uses_fixture(self) -> bool:
        """Whether some test takes the bridge as a fixture."""
        return not all(check.parameters for check in self.checks)

    def parameters(self, check: Check) -> tuple[str, ...]:
        """Returns the parameters of a test with their types."""
        return check.parameters or (f"bridge: {self.class_name}",)

    @property
    def imports(self) -> Imports:
        """What the module may import."""
        messages = (view.class_name for view in self.bridge.messages)
        return Imports(
            {
                **runtime.names(),
                **self.bridge.light.origins(self._ros_classes, f"{self.package}.ros_types"),
                **offered("hypothesis", "given", "settings"),
                "st": Origin("hypothesis", "strategies"),
                **offered(f"{self.package}.{self.package}", self.class_name),
                **offered(f"{self.package}.messages", *messages),
            },
            own=self.package,
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
            if view.alike not in known:
                known[view.alike] = self._shared(self._ends(view, NAME))
            sample, checks = known[view.alike]
            yield from (check.of(view.name) for check in checks)
            if sample is not None:
                sampled.append((ends, sample))
            yield from safe_values(ends)
        yield from round_trips(sampled, self.class_name)
        for call in self.bridge.calls:
            for half in call.halves.values():
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
        """Returns a source message, if one is known to pass, and what is said of the values."""
        checks = list(vectors(ends))
        sample = sample_of(ends)
        if sample is not None:
            checks += examples(ends, sample)
            checks += absences(ends, sample)
            checks += limits(ends, sample)
        return sample, checks

    def _connections(self) -> Check:
        """Shows that the bridge can be made, where there is nothing else to show."""
        about = "The bridge has its connections."
        count = len(self.bridge.connections) + len(self.bridge.calls)
        return Check(
            "connections",
            about,
            (f"assert len(bridge.connections) == {count}",),
        )

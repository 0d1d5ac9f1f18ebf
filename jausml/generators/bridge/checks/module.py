"""The module of the generated tests of a bridge."""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from jausml.generators.bridge.checks.absences import absences
from jausml.generators.bridge.checks.check import Check
from jausml.generators.bridge.checks.ends import Ends
from jausml.generators.bridge.checks.examples import examples
from jausml.generators.bridge.checks.limits import limits
from jausml.generators.bridge.checks.round_trips import round_trips
from jausml.generators.bridge.checks.safe_values import safe_values
from jausml.generators.bridge.checks.samples import sample_of
from jausml.generators.bridge.checks.vectors import vectors
from jausml.generators.common import runtime
from jausml.generators.common.ros import import_lines
from jausml.generators.python.layout import signature
from jausml.generators.python.names import Scope

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.generators.bridge.views import BridgeView

_WORD = re.compile(r"[A-Za-z_]\w*")
_ERRORS = ("AbsentFieldError", "OutOfRangeError")


@dataclass(frozen=True)
class TestModule:
    """What the template of the generated tests asks.

    Args:
        bridge: The bridge.
    """

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
        hypothesis = ("python3-hypothesis",) if "given" in self._words else ()
        return (*hypothesis, "python3-pytest")

    @property
    def uses_fixture(self) -> bool:
        """Whether some test takes the bridge as a fixture."""
        return not all(check.parameters for check in self.checks)

    def signature(self, check: Check) -> str:
        """Returns the first line of the function of a test."""
        parameters = check.parameters or (f"bridge: {self.class_name}",)
        return signature(f"def test_{check.name}", parameters, "None")

    @property
    def standard_lines(self) -> tuple[str, ...]:
        """Import lines of the standard library."""
        return ("import math",) if "math" in self._words else ()

    @property
    def import_lines(self) -> tuple[str, ...]:
        """The other import lines."""
        words = self._words
        third = set(self.bridge.ros_classes.imports(words))
        third |= {(runtime.FACE, name) for name in _ERRORS if name in words}
        if "given" in words:
            third |= {("hypothesis", "given"), ("hypothesis", "settings")}
            third.add(("hypothesis", "strategies as st"))
        package = self.package
        own = {(f"{package}.{package}", self.class_name)}
        own |= {
            (f"{package}.messages", view.class_name)
            for view in self.bridge.messages
            if view.class_name in words
        }
        return ("import pytest", *import_lines(third), "", *import_lines(own))

    @functools.cached_property
    def _words(self) -> frozenset[str]:
        return frozenset(word for check in self.checks for word in _WORD.findall(check.text))

    def _checks(self) -> Iterator[Check]:
        sampled: list[tuple[Ends, Any]] = []
        for view in self.bridge.connections:
            ends = Ends(view, self.bridge.ros_classes.name_of)
            yield from vectors(ends)
            sample = sample_of(ends)
            if sample is not None:
                sampled.append((ends, sample))
                yield from examples(ends, sample)
                yield from absences(ends, sample)
                yield from limits(ends, sample)
            yield from safe_values(ends)
        yield from round_trips(sampled, self.class_name)

    def _connections(self) -> Check:
        """Shows that the bridge can be made, where there is nothing else to show."""
        about = "The bridge has its connections."
        return Check(
            "connections",
            about,
            (f"assert len(bridge.connections) == {len(self.bridge.connections)}",),
        )

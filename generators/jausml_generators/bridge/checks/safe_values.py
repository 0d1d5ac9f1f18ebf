"""Checks of the values that are sent when a source is lost: the stops of commands."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.connections.stops import stop_assignments
from jausml.language.semantics.paths.scopes import target_paths
from jausml_generators.bridge.checks.check import Check, equals, store
from jausml_generators.bridge.checks.filling import Code, ValueTextError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml_generators.bridge.checks.ends import Ends
    from jausml_generators.bridge.checks.filling import Place, Scalar


def safe_values(ends: Ends) -> Iterator[Check]:
    """Yields the check that a connection sends what the model says when its source is lost.

    The whole message is compared: what the model leaves out stays as it is made.

    Args:
        ends: The connection.
    """
    view = ends.view
    if not view.has_safe_value:
        return
    expected = ends.message("expected", is_ros=ends.to_ros)
    whole = "" if ends.to_ros else ".encode()"
    yield Check(
        f"{ends.name}_safe_value",
        "What is sent when the source is lost is what the model says.",
        (
            store("target", f"bridge.safe_{ends.name}()"),
            f"assert isinstance(target, {view.target_name})",
            *expected.fill(_values(ends)),
            equals(f"target{whole}", f"expected{whole}"),
        ),
    )


def _values(ends: Ends) -> dict[str, Scalar]:
    return {
        path: _value(assignment, ends.target.place(path))
        for assignment in stop_assignments(ends.view.connection)
        for path in target_paths(assignment)
    }


def _value(assignment: bridge.Assignment, place: Place) -> Scalar:
    """The constant; what the clock says, or what no text stands for, is taken as it is."""
    taken = Code(place.code)
    if not isinstance(assignment, bridge.ConstantAssignment):
        return taken
    try:
        return place.parse(str(assignment.value))
    except ValueTextError:
        return taken

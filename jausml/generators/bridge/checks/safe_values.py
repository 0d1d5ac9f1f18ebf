"""Checks of the values that are sent when a source is lost."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generators.bridge.checks.check import Check

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.generators.bridge.checks.ends import Ends


def safe_values(ends: Ends) -> Iterator[Check]:
    """Yields the check that the safe value of a connection can be sent, if it is of JAUS.

    Args:
        ends: The connection.
    """
    view = ends.view
    if not view.has_safe_value or view.to_ros:
        return
    lines = (
        f"safe = bridge.safe_{view.name}()",
        f"assert {view.target_name}.decode(safe.encode()).CODE == {view.target_name}.CODE",
    )
    yield Check(f"{view.name}_has_a_safe_value", "The safe value can be sent.", lines)

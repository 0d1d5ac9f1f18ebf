"""Checks that the forms of a translation make the same of a message, byte by byte."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml_generators.bridge.checks.check import Check, equals
from jausml_generators.python.statements import call

if TYPE_CHECKING:
    from jausml_generators.bridge.checks.ends import Ends
    from jausml_generators.bridge.checks.samples import Sample


def forms(ends: Ends, sample: Sample | None) -> Check:
    """Returns the check of a connection, for a message as it is made and for a sample.

    Args:
        sample: A source message that passes, if one is known.
    """
    compared = equals(
        call(
            "differing_forms",
            "bridge",
            f"bridge.translate_{ends.name}",
            f"bridge.{ends.name}",
            "source",
            *ends.join_arguments(),
        ),
        "[]",
    )
    lines = [*ends.joined(), *ends.source.fill({}), compared]
    if sample is not None and sample.values:
        lines += [*ends.source.fill(sample.values), compared]
    about = "Readable and flat translation, light classes and rclpy make the same bytes."
    return Check(f"{ends.name}_has_the_same_bytes_in_each_form", about, tuple(lines))

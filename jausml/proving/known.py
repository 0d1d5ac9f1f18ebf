"""What was proved before, in the cache of the user: of the same code, by the same program."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError
from typing import TYPE_CHECKING

from jausml.generation.again import digest, tool
from jausml.language.model.cache import keep, kept
from jausml.proving.assignments import field_assignments
from jausml.proving.inputs import inputs
from jausml.proving.results import map_result

if TYPE_CHECKING:
    from jausml.proving.proof_bridge import ProofCode
    from jausml.proving.results import MapResult
    from jausml.proving.round_trips import RoundTrip


class Known:
    """The place of the result of a map."""

    def __init__(self, code: ProofCode, trip: RoundTrip) -> None:
        self._name = (
            f"proof-{digest([trip.name, code.core, code.program, code.python.digest])[:24]}"
        )
        try:
            self._state = digest(
                [
                    *tool(),
                    *(repr(each.layout(None)) for each in inputs(trip).values()),
                    repr([each.precision for each in field_assignments(trip.to_jaus.toJaus)]),
                ]
            )
        except (OSError, PackageNotFoundError, ValueError):
            self._state = ""  # nobody knows what proves

    def load(self) -> MapResult | None:
        """Returns what was found; None where nothing is known."""
        found = kept(self._name, self._state) if self._state else None
        return None if found is None else map_result(found)

    def store(self, result: MapResult) -> None:
        """Keeps what was found."""
        if self._state:
            keep(self._name, self._state, result.to_json())

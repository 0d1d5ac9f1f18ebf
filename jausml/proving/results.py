"""What a proof has found: of each number of a map, and of the map."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping


@dataclass(frozen=True)
class Extreme:
    """The value with the largest error (`between`: the values of the other message, by path)."""

    error: float
    raw: int
    value: float
    between: Mapping[str, float]
    back: float


@dataclass(frozen=True)
class Mixed:
    """What becomes of values while the numbers that they share a member with are random."""

    tried: int
    unchanged: int
    changed: int
    left: int
    error: float
    value: float
    back: float


@dataclass(frozen=True)
class Reached:
    """A number of the other message that depends on the values.

    Attributes:
        distinct: How many different values it takes, where it goes in one direction.
    """

    path: str
    least: float
    greatest: float
    is_monotonic: bool
    distinct: int


@dataclass
class FieldResult:
    """What becomes of the values of a number.

    Attributes:
        total: How many values the wire can bring.
        step: Difference between neighbouring values; 0 for floating point.
        drifting: How many are changed again by a second trip.
        largest_drift: The largest change by a second trip, and the value at which it is.
        others: With how many values something else in the message has changed.
        is_constant: Whether always the same comes back, though an assignment of its own gives it.
        limited: How many values were cut off, as the Python form tells.
        computed: How many of those that are left to Python come back as others do.
        faults: Errors that no bridge expects, with how many values have them.
        reasons: Why values are limited, left out or refused, with how many.
        sampled: Of how many values all that the Python form tells is; 0 for all of them.
        bins: The largest error in each part of the range.
        precision: The largest error that the model allows; 0 where it states none.
        needs: Seconds that all values would take, where they can be tried and were not.
        tolerance: The largest change by a second trip that rounding explains; 0 where nobody knows.
        mixed: The same with random values of others; None where it shares no member with them.
    """

    side: str
    path: str
    units: str
    bits: int
    step: float
    ends: tuple[float, float]
    total: int
    tried: int = 0
    has_way_back: bool = False
    unchanged: int = 0
    changed: int = 0
    largest: Extreme | None = None
    drifting: int = 0
    largest_drift: tuple[float, float] = (0.0, 0.0)
    others: int = 0
    is_monotonic: bool = True
    is_constant: bool = False
    reached: list[Reached] = field(default_factory=list)
    limited: int = 0
    left_out: int = 0
    refused: int = 0
    computed: int = 0
    faults: dict[str, int] = field(default_factory=dict)
    reasons: dict[str, int] = field(default_factory=dict)
    left: int = 0
    sampled: int = 0
    compared: int = 0
    differing: int = 0
    bins: list[float] = field(default_factory=list)
    precision: float = 0.0

    needs: float = 0.0
    tolerance: float = 0.0
    mixed: Mixed | None = None

    @property
    def is_complete(self) -> bool:
        """Whether all values were tried."""
        return self.tried == self.total


@dataclass
class MapResult:
    """What becomes of the values of a map.

    Attributes:
        error: Why it could not be proved, which is no fault of the map; empty where it was.
    """

    name: str
    message: str
    type: str
    fields: list[FieldResult] = field(default_factory=list)
    not_carried: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    seconds: float = 0.0
    error: str = ""

    def would_gain(self, seconds: float) -> bool:
        """Tells whether all values of some number more can be tried in a time."""
        return any(0 < each.needs <= seconds for each in self.fields)

    def find(self, side: str, path: str) -> FieldResult | None:
        """Returns what becomes of a number; None where nothing is known."""
        fields = self.fields
        return next((each for each in fields if (each.side, each.path) == (side, path)), None)

    def to_json(self) -> dict[str, Any]:
        """Returns it as JSON."""
        return asdict(self)


def map_result(raw: dict[str, Any]) -> MapResult:
    """Returns what `to_json` has written."""
    fields = [_field(each) for each in raw["fields"]]
    return MapResult(**raw | {"fields": fields})


def _field(raw: dict[str, Any]) -> FieldResult:
    largest = None if raw["largest"] is None else Extreme(**raw["largest"])
    mixed = None if raw["mixed"] is None else Mixed(**raw["mixed"])
    reached = [Reached(**each) for each in raw["reached"]]
    pairs = {name: tuple(raw[name]) for name in ("largest_drift", "ends")}
    return FieldResult(**raw | {"largest": largest, "reached": reached, "mixed": mixed} | pairs)

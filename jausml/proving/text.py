"""Results of proofs as text for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.proving.results import FieldResult, MapResult, Mixed


_SHOWN = 8


def render(results: Iterable[MapResult]) -> str:
    """Returns a paragraph for each map and a line for each number."""
    return "\n".join(line for each in results for line in lines(each))


def lines(result: MapResult) -> Iterator[str]:
    """Yields the lines of a map."""
    yield f"{result.name}: {result.message} <-> {result.type}"
    for each in result.fields:
        yield f"  {each.side} {each.path}: {told(each)}"
    if result.not_carried:
        shown = ", ".join(result.not_carried[:_SHOWN])
        more = len(result.not_carried) - _SHOWN
        yield f"  not carried: {shown}" + (f", and {more} more" if more > 0 else "")
    for remark in result.remarks:
        yield f"  {remark}"


def told(each: FieldResult) -> str:
    """Returns what became of the values of a number."""
    return "; ".join([_values(each), *_parts(each)])


def _values(each: FieldResult) -> str:
    if each.is_complete:
        return f"all {each.total:,} values"
    return f"{each.tried:,} directed values of 2^{each.bits}"


def _parts(each: FieldResult) -> Iterator[str]:
    unit = unit_of(each)
    if not each.has_way_back:
        yield "one way"
        yield from _ways(each)
    elif each.is_constant:
        yield "always the same comes back"
    elif each.unchanged == each.tried:
        yield "unchanged"
    elif each.changed:
        yield f"{each.changed:,} change"
    if each.largest is not None:
        worst = each.largest
        between = "".join(f", {path} {value:.9g}" for path, value in worst.between.items())
        values = f"{worst.value:.9g}{unit}{between}, back {worst.back:.9g}{unit}"
        raw = f"raw {worst.raw}: " if each.step else ""
        yield f"largest error {worst.error:.6g}{unit} ({raw}{values})"
    if each.has_way_back and not each.is_constant and not each.is_monotonic:
        yield "not monotonic"
    yield from _treated(each)
    if each.drifting:
        drift, at = each.largest_drift
        text = f"{each.drifting:,} change again in a second trip"
        yield f"{text}, by up to {drift:.6g}{unit} (at {at:.9g}{unit})"
    if each.mixed is not None:
        yield _mixed(each.mixed, unit)
    if each.others:
        yield f"with {each.others:,} something else changes too"


def _mixed(mixed: Mixed, unit: str) -> str:
    text = f"with others at random {mixed.changed:,} of {mixed.tried:,} change"
    if mixed.changed:
        text += f", by up to {mixed.error:.6g}{unit} ({mixed.value:.9g}, back {mixed.back:.9g})"
    return f"{text}, {mixed.left:,} left to Python" if mixed.left else text


def _ways(each: FieldResult) -> Iterator[str]:
    for one in each.reached:
        way = f"{one.path} {one.least:.9g} .. {one.greatest:.9g}"
        if not one.is_monotonic:
            yield f"{way}, not monotonic"
        elif one.distinct < each.unchanged:
            yield f"{way}, {one.distinct:,} different values"
        else:
            yield way


def _treated(each: FieldResult) -> Iterator[str]:
    """What the Python form tells of the values that are left to it."""
    sampled = f" of {each.sampled} tried of {each.left:,}" if each.sampled else ""
    for count, what in (
        (each.limited, "limited"),
        (each.left_out, "left out"),
        (each.refused, "refused"),
        (sum(each.faults.values()), "fail"),
    ):
        if count:
            yield f"{count:,} {what}{sampled}"


def unit_of(each: FieldResult) -> str:
    """Returns the unit behind a blank; nothing where there is none."""
    return f" {each.units}" if each.units not in {"", "one", "1"} else ""

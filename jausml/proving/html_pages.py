"""Pages of proofs in HTML, with pictures of errors over the values of numbers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from jausml.proving.results import FieldResult, MapResult, outcome_text, unit_of
from jausml.views.pages import page

_LONGEST = 100  # characters of the name of a file, whatever a map is called
_WIDTH, _HEIGHT, _TOP = 720, 150, 18  # of a picture, in its units, and where it begins


def pages(
    results: Sequence[MapResult], faults: Mapping[str, Sequence[str]]
) -> Iterator[tuple[str, str]]:
    """Yields the name and text of the page of each map, and of the index last.

    Args:
        faults: Findings of maps in words, by the names of maps.
    """
    files = dict.fromkeys(["index.html"])
    rows = []
    for result in results:
        file = _file(result.name, files)
        findings = faults.get(result.name, ())
        rows.append({"file": file, "map": result, "findings": len(findings)})
        pictures = [(field, outcome_text(field), _picture(field)) for field in result.fields]
        yield file, _page(result.name, map=result, findings=findings, fields=pictures)
    yield "index.html", _page("Proofs", rows=rows)


def _page(title: str, **known: object) -> str:
    sizes = {"wide": _WIDTH, "top": _TOP, "bottom": _TOP + _HEIGHT}
    return page("jausml.proving", "proofs", title, {**sizes, **known})


def _file(name: str, taken: dict[str, None]) -> str:
    """Returns the name of the file for a page, whatever maps are called."""
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)[:_LONGEST] or "map"
    file, count = f"{plain}.html", 2
    while file.lower() in taken:
        file, count = f"{plain}_{count}.html", count + 1
    taken[file.lower()] = None
    return file


@dataclass(frozen=True)
class _Picture:
    """The errors over the values, in their order, as bars: x, y, width and height of each."""

    bars: list[tuple[str, ...]]
    limit: str
    title: str
    ends: tuple[str, ...]


def _picture(result: FieldResult) -> _Picture | None:
    """Returns the picture of a number; None for one without errors."""
    if not any(result.bins):
        return None
    most = max((value for value in result.bins if value != math.inf), default=0.0)
    bins = result.bins[: min(len(result.bins), result.total)]
    # Errors without end are as high as the picture, also where there are no others.
    wide, shown, bottom = _WIDTH / len(bins), max(most, result.precision) or 1.0, _TOP + _HEIGHT
    bars = []
    for at, value in enumerate(bins):
        if high := min(value / shown, 1.0) * _HEIGHT:
            sizes = (at * wide, bottom - high, max(wide, 1), high)
            bars.append(tuple(f"{size:.2f}" for size in sizes))
    limit = f"{bottom - _HEIGHT * result.precision / shown:.2f}" if result.precision else ""
    order = "" if result.step else ", in the order of the values that the type has"
    ends = (f"{end:.6g}{unit_of(result)}" for end in result.ends)
    title = f"error up to {shown if most else math.inf:.3g}{unit_of(result)}{order}"
    return _Picture(bars, limit, title, tuple(ends))

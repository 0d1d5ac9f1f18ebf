"""The plots of the page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from names import ALL_WAYS, BRIDGES, FORMS, KINDS, VARIANTS, WAY_NAMES, WAYS
from plots import Panel, bars
from tables import by_kind
from targets import JUDGED_RATE

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence


def pictures(sections: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yields the plots, name and text of each file."""
    if sections.get("latency"):
        panels = [
            Panel(
                WAY_NAMES[way],
                {
                    KINDS[kind][1]: {
                        each: rates[JUDGED_RATE][way].get(each, {}).get("ratio") for each in BRIDGES
                    }
                    for kind, rates in by_kind(sections["latency"])
                },
            )
            for way in WAYS
        ]
        title = f"Latency against the floor, {JUDGED_RATE} messages a second"
        shown = _shown(BRIDGES, panels)
        yield "performance-latency.svg", bars(title, "times the floor", shown, panels, mark=1.0)
    if sections.get("throughput"):
        rows = {
            WAY_NAMES[way]: {each: each_found["rate"] or None for each, each_found in found.items()}
            for way in ALL_WAYS
            if (found := sections["throughput"].get(way))
        }
        title = "Messages a second without loss"
        panels = [Panel("stamped points", rows)]
        shown = _shown(VARIANTS, panels)
        yield "performance-throughput.svg", bars(title, "a second", shown, panels, mark=10_000)
    if sections.get("translations"):
        panels = [
            Panel(
                WAY_NAMES[way],
                {
                    KINDS[kind][1]: {form: ways[way].get(form, {}).get("median") for form in FORMS}
                    for kind, ways in by_kind(sections["translations"])
                },
            )
            for way in WAYS
        ]
        title = "Processor time of a translation, bytes to bytes"
        shown = _shown(FORMS, panels)
        yield "performance-translations.svg", bars(title, "microseconds", shown, panels)


def _shown(order: Iterable[str], panels: Sequence[Panel]) -> list[str]:
    """Returns the series that have a bar."""
    rows = [row for panel in panels for row in panel.bars.values()]
    return [each for each in order if any(row.get(each) is not None for row in rows)]

"""What the toolchain takes: reading, judging and generating models from nothing.

All figures are seconds of processor time, those of verbs with their start. Where another
environment is named (`--before`), its jausml does the same work by turns, and the ratio to it is
told.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import growth
from figures import rounded

from jausml.language.model.uris import LIBRARY_URI

if TYPE_CHECKING:
    from scale import Scale

ROOT = Path(__file__).resolve().parent.parent
BEFORE = "JAUSML_BEFORE"
"""Variable with the Python of another environment, whose jausml is measured too."""

VEHICLE = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
LARGE, GROWTH = 3000, (50, 1500)
"""Connections, each with a map and frames of its own."""

ELEMENTS = (3_000, 10_000)
_ELEMENTS_EACH = 8
_RUNS = 5
_RULES = """
import sys, time
from jausml.language.validation.engine import check_project
check_project([sys.argv[1]])
began = time.process_time()
assert not check_project([sys.argv[2]]).has_errors
print(time.process_time() - began)
"""
_GENERATE = ("generate", "-q", "-o", "out")
_VALIDATE = ("validate", "-q")


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures all.

    Args:
        scale: How much; the least one has small models.

    Returns:
        By work `seconds`, and with another environment the `ratio` to what it took; `growth` of
        `generate` and `validate` as exponents.
    """
    share = LARGE if scale.factor else 10
    large = _connections(LARGE * share // LARGE)
    works: dict[str, tuple[str, tuple[str, ...]]] = {
        "generate": (large, _GENERATE),
        "validate": (large, _VALIDATE),
        "vehicle": (VEHICLE.read_text("utf-8").replace("../library/", LIBRARY_URI), _GENERATE),
    }
    runs = scale.count(_RUNS, 1)
    found: dict[str, Any] = {}
    for name, (text, verb) in works.items():
        found[name] = _work(text, verb, runs)
        print(f"  {name}: {found[name]}", flush=True)
    for element in ELEMENTS:
        text = _connections(element * share // LARGE // _ELEMENTS_EACH)
        seconds = min(_rules(text, folder) for _ in range(runs))
        found[f"rules {element}"] = {"seconds": rounded(seconds)}
    found["growth"] = {}
    sizes = [max(size * share // LARGE, number) for number, size in enumerate(GROWTH, 1)]
    for verb in (_GENERATE, _VALIDATE):
        found["growth"][verb[0]] = _exponent(verb, sizes, runs)
    print(f"  growth: {found['growth']}", flush=True)
    return found


def _rules(text: str, folder: Path) -> float:
    """Returns what reading a model and all rules take in a process that has read the library."""
    models = folder / "small.xmi", folder / "judged.xmi"
    for path, model_text in zip(models, (_connections(1), text), strict=True):
        path.write_text(model_text, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", _RULES, *models], check=True, capture_output=True, text=True
    )
    return float(done.stdout)


def _connections(count: int) -> str:
    return growth.connections(max(count, 1), own_maps=True, own_frames=True)


def _work(text: str, verb: tuple[str, ...], runs: int) -> dict[str, float]:
    """Returns the least of some runs, in this environment and by turns in the other one."""
    pythons = [sys.executable, *filter(None, [os.environ.get(BEFORE)])]
    found: list[list[float]] = [[] for _ in pythons]
    for _ in range(runs):
        for python, seconds in zip(pythons, found, strict=True):
            seconds.append(growth.processor_seconds(text, *verb, python=python))
    now, *before = map(min, found)
    return {"seconds": rounded(now), **({"ratio": round(now / before[0], 2)} if before else {})}


def _exponent(verb: tuple[str, ...], sizes: list[int], runs: int) -> float:
    """Returns the exponent of the time above that of one connection, from a size to another."""
    nothing, few, many = (
        min(growth.processor_seconds(_connections(size), *verb) for _ in range(runs))
        for size in (1, *sizes)
    )
    ratio = max(many - nothing, 0.01) / max(few - nothing, 0.01)
    return round(math.log(ratio) / math.log(sizes[1] / sizes[0]), 2)

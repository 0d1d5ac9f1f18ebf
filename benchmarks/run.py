"""Runs the benchmarks, and writes what they found: one data file, and the page made of it.

Usage: run.py [--quick | --tiny] [--only NAME...] [--before PYTHON] [--data FILE] [--page FILE]

A full run takes about twelve minutes and writes performance.json and performance.md in
build/results; any other writes them into build/benchmarks unless it is told where. With --only, the
other figures of the data file stay, and the page says of each part what kind of run it is of. Each
section runs in a process of its own with a time limit; one that fails is told, and the others run.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import json
import os
import platform
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import page
from scale import FULL, QUICK, SCALES, TINY, Scale
from toolchain import BEFORE

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
FORMAT = 4
"""Version of the data; figures of another one are not kept."""

RESULTS = ROOT / "build" / "results"
"""Where full runs go; a release takes them along."""

LOOKS = ROOT / "build" / "benchmarks"
"""Where runs go that are not full."""


@dataclass(frozen=True)
class Section:
    """A part of the run.

    Attributes:
        name: Name in the data and on the command line.
        module: Module with the function.
        function: Takes a scale and a folder, returns what is kept.
        limit: Seconds after which it is ended.
    """

    name: str
    module: str
    function: str = "measure"
    limit: float = 240.0


SECTIONS = (
    Section("latency", "latency", limit=480),
    Section("footprint", "footprint", limit=300),
    Section("components", "components"),
    Section("toolchain", "toolchain", limit=1200),
    Section("studio", "studio"),
)
NAMES = tuple(section.name for section in SECTIONS)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs sections; returns how many failed."""
    options = _options(arguments)
    scale = TINY if options.tiny else QUICK if options.quick else FULL
    if options.section:
        return _one(options.section, scale, Path(options.data))
    folder = RESULTS if scale is FULL else LOOKS
    data_file = Path(options.data or folder / "performance.json")
    page_file = Path(options.page or folder / "performance.md")
    if options.before:
        os.environ[BEFORE] = options.before
    data = _measured(options.only or NAMES, scale, data_file)
    page_file.parent.mkdir(parents=True, exist_ok=True)
    page_file.write_text(page.page(page.stored(data_file)), encoding="utf-8")
    print(f"wrote {data_file} and {page_file}")
    for name, why in data["failed"].items():
        print(f"failed: {name}: {why}")
    return len(data["failed"])


def _options(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a look, in a few minutes")
    parser.add_argument("--tiny", action="store_true", help="only whether it works")
    parser.add_argument("--only", nargs="+", choices=NAMES, metavar="NAME", help=" ".join(NAMES))
    parser.add_argument("--data", help="data file")
    parser.add_argument("--page", help="page")
    parser.add_argument(
        "--before", metavar="PYTHON", help="of another environment, whose jausml is measured too"
    )
    parser.add_argument("--section", choices=NAMES, help=argparse.SUPPRESS)
    return parser.parse_args(arguments)


def _measured(names: Sequence[str], scale: Scale, data_file: Path) -> dict[str, Any]:
    """Runs sections one after the other; the data is stored after each."""
    data: dict[str, Any] = {"format": FORMAT, "sections": {}, "runs": {}, "failed": {}}
    if len(names) < len(NAMES) and data_file.exists():
        stored = json.loads(data_file.read_text(encoding="utf-8"))
        data = stored if stored.get("format") == FORMAT else data
    data["machine"] = machine()
    data_file.parent.mkdir(parents=True, exist_ok=True)
    for section in (candidate for candidate in SECTIONS if candidate.name in names):
        print(f"== {section.name}", flush=True)
        started = time.monotonic()
        run = {"scale": scale.name, "load": machine()["load"]}
        figures, why = _in_a_process(section, scale)
        data["failed"].pop(section.name, None)
        if figures is None:
            data["failed"][section.name] = why
        else:
            data["sections"][section.name] = figures
            data["runs"][section.name] = run
        print(f"   {time.monotonic() - started:.0f} s {why}", flush=True)
        text = json.dumps(data, indent=1, sort_keys=True)
        data_file.write_text(f"{text}\n", encoding="utf-8")
    return data


def machine() -> dict[str, Any]:
    """Returns what the figures depend on, without the name of the computer."""
    return {
        "processors": os.cpu_count(),
        "architecture": platform.machine(),
        "python": platform.python_version(),
        "system": platform.system(),
        "load": round(os.getloadavg()[0], 1),
    }


def _in_a_process(section: Section, scale: Scale) -> tuple[Any, str]:
    """Returns what a section found, or None and why there is nothing."""
    environment = {
        **os.environ,
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DOMAIN_ID": os.environ.get("ROS_DOMAIN_ID", str(10 + os.getpid() % 90)),
    }
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "found.json"
        how = [] if scale is FULL else [f"--{scale.name}"]
        line = [sys.executable, __file__, "--section", section.name, "--data", str(out), *how]
        # A group of its own, so that nothing of it is left behind.
        process = subprocess.Popen(line, env=environment, start_new_session=True)
        try:
            code = process.wait(section.limit)
        except subprocess.TimeoutExpired:
            return None, f"not done after {section.limit:.0f} s"
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        if code != 0 or not out.exists():
            return None, f"exit code {code}"
        return json.loads(out.read_text(encoding="utf-8")), ""


def _one(name: str, scale: Scale, out: Path) -> int:
    """Runs one section here."""
    section = next(candidate for candidate in SECTIONS if candidate.name == name)
    with tempfile.TemporaryDirectory() as folder:
        try:
            figures = getattr(importlib.import_module(section.module), section.function)(
                SCALES[scale.name], Path(folder)
            )
        except Exception:
            log = Path(folder) / "processes.log"
            if log.exists():
                print(log.read_text(encoding="utf-8", errors="replace")[-4000:], file=sys.stderr)
            raise
    out.write_text(json.dumps(figures), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""What a bridge takes before anything passes: start, memory, idle processor time, generated code.

A generated bridge is ready when its JAUS side answers, since its topics are there before. The first
message is through later: that DDS finds the topic takes between some milliseconds and three
seconds, whatever the program is. So the processor time until then is told too.
"""

from __future__ import annotations

import os
import random
import socket
import statistics
import time
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Any

from ends import QUERY_STATUS, REPORT_STATUS, JausEnd, Numbers, RosEnd
from figures import rounded
from names import FLOOR, VARIANTS
from processes import Child, Children
from samples import Sample, sample
from scale import Scale
from systems import Measured, System, generate
from variants import Loop, reached

CONNECTIONS = (20, 300)
_EMPTY = """
import sys, rclpy
rclpy.init()
node = rclpy.create_node("empty")
print(flush=True)
sys.stdin.read()
"""
_RUNS = 3
_IDLE = 1.0


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures bridges with connections, half of them each way.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        Of an empty node of rclpy `memory_mib`, under 0. By number of connections and variant:
        medians of `ready_s` (bridges that were generated), `through_s`, `processor_s`, `memory_mib`
        and `idle` (share of a processor); `span_s` of `ready_s`; `code` with `lines` and `bytes` of
        what was generated, and `build_s`, in which it was compiled.
    """
    figures: dict[str, Any] = {"0": {"empty node": _empty(folder)}}
    with closing(RosEnd("meter")) as ros:
        for count in scale.cases(CONNECTIONS, 1):
            # Systems of their own, since bridges of one system share a package of messages.
            own = folder / str(count)
            own.mkdir()
            name = f"has_{count}"
            system = generate(own, {name: Measured(("point",), count - 1, ways=("up",))})
            message = sample(system.model, "point")
            lines, size = system.lines(name)
            code = {"lines": lines, "bytes": size, "build_s": rounded(system.compile())}
            figures[str(count)] = {**_of(scale, folder, system, name, message, ros), "code": code}
            print(f"  {count} connections: {figures[str(count)]}", flush=True)
    return figures


def _empty(folder: Path) -> dict[str, float]:
    """Returns what a node of rclpy takes that does nothing."""
    with Children(os.environ, folder / "processes.log") as children:
        child = children.start("-c", _EMPTY)
        assert child.process.stdout is not None
        child.process.stdout.readline()
        return {"memory_mib": rounded(child.memory())}


def _of(
    scale: Scale, folder: Path, system: System, name: str, message: Sample, ros: RosEnd
) -> dict[str, Any]:
    variants = list(VARIANTS)
    samples: dict[str, list[dict[str, float]]] = {variant_name: [] for variant_name in variants}
    for number in range(scale.count(_RUNS, 1)):
        random.shuffle(variants)
        for variant in (
            variants
            if number == 0
            else [variant_name for variant_name in VARIANTS if variant_name != FLOOR]
        ):
            loop = Loop(variant, ros, system, name, message)
            with Children(system.environment(), folder / "processes.log") as children:
                loop.start(children, folder)
                into = partial(_add_start, samples[variant], system.address(name))
                for route in reached([loop], into):
                    route.close()
    return {variant: _summary(series) for variant, series in samples.items() if series}


def _add_start(samples: list[dict[str, float]], address: Numbers, loop: Loop) -> None:
    samples.append(_started(loop, address))


def _started(loop: Loop, address: Numbers) -> dict[str, float]:
    child = loop.processes[0]
    figures = {}
    if loop.variant != FLOOR:
        query = loop.end.outgoing(QUERY_STATUS, address)
        loop.until(lambda: _answers(loop.end, query))
        figures["ready_s"] = time.monotonic() - child.started
    loop.until(lambda: loop.up(0.002) is not None)
    figures["through_s"] = time.monotonic() - child.started
    return {**figures, **_at_rest(child)}


def _answers(end: JausEnd, query: list[bytes]) -> bool:
    end.send(query)
    time.sleep(0.002)
    return end.receive(REPORT_STATUS, socket.MSG_DONTWAIT)


def _at_rest(child: Child) -> dict[str, float]:
    """Returns the figures of a process that has just answered."""
    started = child.processor_time()
    time.sleep(0.3)
    before = child.processor_time()
    time.sleep(_IDLE)
    used = child.processor_time() - before
    return {"processor_s": started, "memory_mib": child.memory(), "idle": used / _IDLE}


def _summary(samples: list[dict[str, float]]) -> dict[str, Any]:
    figures: dict[str, Any] = {
        name: rounded(statistics.median(measurement[name] for measurement in samples))
        for name in samples[0]
    }
    if "ready_s" in figures:
        times = [measurement["ready_s"] for measurement in samples]
        figures["span_s"] = [rounded(min(times)), rounded(max(times))]
    return figures

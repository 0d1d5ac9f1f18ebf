"""What a bridge takes before anything passes: start, memory, idle processor time, generated code.

A generated bridge is ready when its JAUS side answers, since its topics are there before. The first
message is through later: that DDS finds the topic takes between some milliseconds and three
seconds, whatever the program is. So the processor time until then is told too.
"""

from __future__ import annotations

import random
import socket
import statistics
import time
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ends import QUERY_STATUS, REPORT_STATUS, JausEnd, RosEnd, free_port, wait_until
from figures import rounded
from names import COMPILED, FLOOR, GENERATED, GENERIC, JUDGED
from processes import Children
from samples import sample
from systems import Measured, generate
from variants import PATIENCE, Loop, UnreachableError, reached

if TYPE_CHECKING:
    from ends import Numbers
    from processes import Child
    from samples import Sample
    from scale import Scale
    from systems import System

HERE = Path(__file__).resolve().parent
CONNECTIONS = (1, 20, 100, 300)
COMPONENTS = (1, 10, 100)
_RUNS = 3
_IDLE = 1.0


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures bridges with connections, half of them each way.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        By number of connections and variant: medians of `ready_s` (bridges that were generated),
        `through_s`, `processor_s`, `memory_mib` and `idle` (share of a processor); `span_s` of
        `ready_s`; `code` with `lines` and `bytes` of what was generated, and `build_s`, in which
        it was compiled.
    """
    found: dict[str, Any] = {}
    with closing(RosEnd("meter")) as ros:
        for count in scale.cases(CONNECTIONS, 2):
            # Systems of their own, since bridges of one system share a package of messages.
            own = folder / str(count)
            own.mkdir()
            name = f"has_{count}"
            system = generate(own, {name: Measured(("point",), count - 1, ways=("up",))})
            message = sample(system.model, "point")
            lines, size = system.lines(name)
            code = {"lines": lines, "bytes": size, "build_s": rounded(system.compile())}
            found[str(count)] = {
                **_of(scale, folder, system, name, message, ros),
                "code": code,
            }
            print(f"  {count} connections: {found[str(count)]}", flush=True)
    return found


def _of(
    scale: Scale, folder: Path, system: System, name: str, message: Sample, ros: RosEnd
) -> dict[str, Any]:
    variants = scale.cases((COMPILED, FLOOR, GENERATED, GENERIC), 4)
    samples: dict[str, list[dict[str, float]]] = {each: [] for each in variants}
    for number in range(scale.count(_RUNS, 1)):
        random.shuffle(variants)
        for variant in variants if number == 0 else list(JUDGED):
            loop = Loop(variant, ros, system, name, message)
            with Children(system.environment(), folder / "processes.log") as children:
                loop.start(children, folder)
                into = partial(_add_start, samples[variant], system.address(name))
                for each in reached([loop], into):
                    each.close()
    return {variant: _summary(each) for variant, each in samples.items() if each}


def _add_start(samples: list[dict[str, float]], address: Numbers, loop: Loop) -> None:
    samples.append(_started(loop, address))


def _started(loop: Loop, address: Numbers) -> dict[str, float]:
    child = loop.processes[0]
    found = {}
    if loop.variant in JUDGED:
        query = loop.end.outgoing(QUERY_STATUS, address)
        loop.until(lambda: _answers(loop.end, query))
        found["ready_s"] = time.monotonic() - child.started
    loop.until(lambda: loop.up(0.002) is not None)
    found["through_s"] = time.monotonic() - child.started
    return {**found, **_at_rest(child)}


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
    found: dict[str, Any] = {
        name: rounded(statistics.median(each[name] for each in samples)) for name in samples[0]
    }
    if "ready_s" in found:
        times = [each["ready_s"] for each in samples]
        found["span_s"] = [rounded(min(times)), rounded(max(times))]
    return found


def measure_components(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures a process with JAUS components: until the last one answers, and what it takes then.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        The same figures by number of components, without `through_s`.
    """
    system = generate(folder, {"one": Measured(("point",))})
    found: dict[str, Any] = {}
    for count in scale.cases(COMPONENTS, 2):
        samples = []
        for _ in range(scale.count(_RUNS, 1)):
            with Children(system.environment(), folder / "processes.log") as children:
                samples.append(_answering(children, count))
        found[str(count)] = _summary(samples)
        print(f"  {count} components: {found[str(count)]}", flush=True)
    return found


def _answering(children: Children, count: int) -> dict[str, float]:
    port = free_port()
    child = children.start(HERE / "hosts.py", "components", str(port), str(count))
    with closing(JausEnd((1, 1, 1), port)) as end:
        query = end.outgoing(QUERY_STATUS, (1, 2, count))
        if not wait_until(lambda: _answers(end, query), PATIENCE):
            raise UnreachableError(f"component {count} does not answer")
    ready = time.monotonic() - child.started
    return {"ready_s": ready, **_at_rest(child)}

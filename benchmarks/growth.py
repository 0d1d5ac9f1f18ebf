"""How `jausml generate` grows with the model: `python benchmarks/growth.py [SIZES...]`.

For each shape and size it prints the processor time of a whole run in a fresh process, and what of
it a run over nothing would not take, against that of the smallest size.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

_LIBRARY = "http://www.jausml.org/library"
_HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<xmi:XMI xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xmlns:jaus="http://www.jausml.org/jaus/1.0"
 xmlns:bridge="http://www.jausml.org/bridge/1.0" xmlns:system="http://www.jausml.org/system/1.0">
"""
_MAP = """<maps xmi:id="map_{n}" name="map_{n}">
 <message href="{library}/jaus/mobility.xmi#VelocityStateSensor.ReportVelocityState"/>
 <type href="{library}/ros/geometry_msgs.xmi#TwistStamped"/>
 <toRos xsi:type="bridge:ClockAssignment" target="header.stamp"/>
 <toRos xsi:type="bridge:ConstantAssignment" target="header.frame_id" value="{frame}"/>
 <toRos xsi:type="bridge:FieldAssignment" target="twist.linear.x" source="Velocity_X"
  whenAbsent="dropMessage"/>
 <toRos xsi:type="bridge:FieldAssignment" target="twist.angular.z" source="YawRate">
  <conversions/>
 </toRos>
</maps>
"""
_CONNECTION = """<bridgeConnections name="c{n}" map="map_{map}" exchange="periodicEvent"
 peers="sensor" rate="10.0"><topics name="c{n}"/></bridgeConnections>
"""


def connections(count: int, *, own_maps: bool, own_frames: bool = False) -> str:
    """Returns a model of a bridge with connections.

    Args:
        count: Number of connections.
        own_maps: Whether each has a map of its own; else all share one.
        own_frames: Whether each map has a frame of its own; else they differ in their names alone.
    """
    uses = f'<uses href="{_LIBRARY}/jaus/mobility.xmi#VelocityStateSensor"/>'
    maps = (
        _MAP.format(n=n, library=_LIBRARY, frame=f"link_{n}" if own_frames else "base_link")
        for n in range(count if own_maps else 1)
    )
    lines = (_CONNECTION.format(n=n, map=n if own_maps else 0) for n in range(count))
    provider = uses.replace("uses", "provides")
    return (
        f'{_HEAD}<system:System name="grown">'
        f'<components xmi:id="sensor" name="sensor" address="10.1.1">{provider}</components>'
        f'<bridges name="front" address="10.1.2">{uses}{"".join(maps)}'
        f"{''.join(lines)}</bridges></system:System></xmi:XMI>\n"
    )


def _service(types: str, body: str) -> str:
    return (
        f'{_HEAD}<system:System name="grown"><components name="sensor" address="10.1.1"'
        f' provides="S"/></system:System><jaus:ServiceSet name="grown_services">{types}'
        f'<services xmi:id="S" name="S" urn="urn:x-grown:s"><outputs name="ReportM" code="0xD001">'
        f"{body}</outputs></services></jaus:ServiceSet></xmi:XMI>\n"
    )


def nested(depth: int) -> str:
    """Returns a model of a message whose sequences are nested so deep."""
    inside = '<fields xsi:type="jaus:FixedField" name="X" type="uint8"/>'
    inside = f'<fields xsi:type="jaus:Record" name="R">{inside}</fields>'
    for n in range(depth):
        inside = f'<fields xsi:type="jaus:Sequence" name="S{n}">{inside}</fields>'
    return _service("", f'<body xsi:type="jaus:Sequence" name="Body">{inside}</body>')


def doubling(count: int) -> str:
    """Returns a model of so many types each of which holds the one before it twice."""
    reference = '<fields xsi:type="jaus:TypeReference" name="{name}" target="T{n}"/>'
    types = '<types xsi:type="jaus:Record" xmi:id="T0" name="T0">'
    types += '<fields xsi:type="jaus:FixedField" name="X" type="uint8"/></types>'
    for n in range(1, count + 1):
        both = "".join(reference.format(name=name, n=n - 1) for name in ("First", "Second"))
        types += f'<types xsi:type="jaus:Sequence" xmi:id="T{n}" name="T{n}">{both}</types>'
    body = reference.format(name="Body", n=count).replace("fields", "body")
    return _service(types, body)


def main() -> None:
    """Prints one line for each shape and size."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("sizes", nargs="*", type=int, default=[100, 1_000, 3_000])
    sizes = parser.parse_args().sizes
    shapes = {
        "connections of one map": [(n, connections(n, own_maps=False)) for n in sizes],
        "connections of own maps": [(n, connections(n, own_maps=True)) for n in sizes],
        "own maps, own frames": [
            (n, connections(n, own_maps=True, own_frames=True)) for n in sizes
        ],
        "nested sequences": [(n, nested(n)) for n in (10, 20, 60)],
        "types that double": [(n, doubling(n)) for n in (4, 8, 11)],
    }
    nothing = seconds_to_generate(connections(1, own_maps=False))
    print("shape                       size   processor time   above that of one, ratio")
    for shape, models in shapes.items():
        least = 0.0
        for size, text in models:
            seconds = seconds_to_generate(text)
            least = least or max(seconds - nothing, 0.01)
            print(f"{shape:24} {size:7d} {seconds:14.2f} s {(seconds - nothing) / least:18.1f}")


def seconds_to_generate(text: str, *, again: bool = False) -> float:
    """Returns the processor time of a generation into an empty folder.

    Args:
        again: Whether it is that of a second one, of the unchanged model.
    """
    with tempfile.TemporaryDirectory() as folder:
        model = Path(folder) / "grown.xmi"
        model.write_text(text, encoding="utf-8")
        command = [sys.executable, "-m", "jausml", "generate", "-q", str(model), "-o", "out"]
        homes = {"XDG_CACHE_HOME": f"{folder}/cache", "XDG_STATE_HOME": f"{folder}/state"}
        run = partial(
            subprocess.run,
            command,
            check=True,
            capture_output=True,
            cwd=folder,
            env=os.environ | homes,
        )
        if again:
            run()
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        run()
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


if __name__ == "__main__":
    main()

"""Models of any size, and what a verb takes of a processor with them."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

_LIBRARY = "http://www.jausml.org/library"
HEAD = """<?xml version="1.0" encoding="UTF-8"?>
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
        f'{HEAD}<system:System name="grown">'
        f'<components xmi:id="sensor" name="sensor" address="10.1.1">{provider}</components>'
        f'<bridges name="front" address="10.1.2">{uses}{"".join(maps)}'
        f"{''.join(lines)}</bridges></system:System></xmi:XMI>\n"
    )


def processor_seconds(text: str, *verb: str, python: str = sys.executable) -> float:
    """Returns the processor time of a verb of jausml with a model, from nothing.

    Args:
        verb: The verb and its options; the model follows them.
        python: That of the environment whose jausml is measured.
    """
    with tempfile.TemporaryDirectory() as folder:
        model = Path(folder) / "grown.xmi"
        model.write_text(text, encoding="utf-8")
        homes = {"XDG_CACHE_HOME": f"{folder}/cache", "XDG_STATE_HOME": f"{folder}/state"}
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(
            [python, "-m", "jausml", *verb, str(model)],
            check=True,
            capture_output=True,
            cwd=folder,
            env=os.environ | homes,
        )
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime

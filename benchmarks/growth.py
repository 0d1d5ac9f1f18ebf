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


_SERVICE = """import `jaus.core-1.1`

service_set grown {{
  service Grown {{
    urn: "urn:x-grown:s"
    version: "1.0"
    inherits: Management
{messages}
  }}
}}

component peer {{ address: 10.1.1 provides: Grown external: true }}
{maps}
bridge front {{
  address: 10.1.2
  uses: Grown
{connections}
}}
"""
_FIELDS = """    record Body {{
      fixed_field count {{ type: uint32 }}
      fixed_field level {{ type: float64 }}
    }} }}"""
_UP_MESSAGE = f"""    outputs: new message_def ReportLevel{{n}} {{{{
      code: 0x{{report:X}}
{_FIELDS}"""
_DOWN_MESSAGE = f"""    inputs: new message_def SetLevel{{n}} {{{{
      code: 0x{{command:X}} moves: true
{_FIELDS}"""
_UP_MAP = """
up{n} {{
  JAUS ReportLevel{n}
  ROS geometry_msgs/PointStamped
  JAUS->ROS (
    clock -> header.stamp
    "link" -> header.frame_id
    count -> point.x
    level -> point.y
    ignore point.z
  )
}}
"""
_DOWN_MAP = """
down{n} {{
  JAUS SetLevel{n}
  ROS geometry_msgs/PointStamped
  ROS->JAUS ( point.x -> count  point.y -> level )
  stopJaus: {{}}
}}
"""
_UP = "  connection up{n} {{ map: up{n} peers: peer exchange: message topic up{n} {{}} }}"
_DOWN = "  connection down{n} {{ map: down{n} peers: peer topic down{n} {{}} }}"
_FIRST_REPORT, _FIRST_COMMAND = 0x6000, 0x1000


def both_ways(count: int) -> str:
    """Returns a model of a bridge whose connections have messages and maps of their own.

    Args:
        count: Number of connections in each direction.
    """

    def lines(*patterns: str) -> str:
        return "\n".join(
            pattern.format(n=n, report=_FIRST_REPORT + n, command=_FIRST_COMMAND + n)
            for pattern in patterns
            for n in range(count)
        )

    return _SERVICE.format(
        messages=lines(_UP_MESSAGE, _DOWN_MESSAGE),
        maps=lines(_UP_MAP, _DOWN_MAP),
        connections=lines(_UP, _DOWN),
    )


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
        suffix = "xmi" if text.startswith("<") else "ros2jaus"
        model = Path(folder) / f"grown.{suffix}"
        model.write_text(text, encoding="utf-8")
        return seconds_in(Path(folder), *verb, str(model), python=python)


def seconds_in(folder: Path, *line: str, python: str = sys.executable) -> float:
    """Returns the processor time of a command of jausml in a folder, with all that it starts."""
    homes = {"XDG_CACHE_HOME": f"{folder}/cache", "XDG_STATE_HOME": f"{folder}/state"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [python, "-m", "jausml", *line],
        check=True,
        capture_output=True,
        cwd=folder,
        env=os.environ | homes,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime

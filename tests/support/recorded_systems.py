"""Recordings of the test bridge as `jausml record` writes them, made by hand and in no time."""

import io
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from types import SimpleNamespace

from jausml.language.model.library import LIBRARY_URI
from jausml.live.messages import load_catalogue
from jausml.live.recording.captured import JausMessage, JausWriter
from jausml.live.recording.mcap_files import McapFile

ROOT = Path(__file__).resolve().parents[2]
MODEL = ROOT / "tests" / "cases" / "bridge_loop" / "model.xmi"
SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND
BRIDGE, VEHICLE, OPERATOR = "10.1.9", "10.1.1", "20.1.1"
PERIOD = 0.1
"""Seconds from one command to the next."""

LIMIT = 10.0
"""Speed beyond which no effort stands for it."""


@dataclass(frozen=True)
class Drive:
    """A vehicle that is driven, and what goes wrong meanwhile.

    Attributes:
        dropped: Times of commands that no effort stands for.
        silent: From when on the vehicle answers no more; None for never.
        taken: When the operator takes control of the bridge; None for never.
    """

    seconds: float = 12.0
    dropped: tuple[float, ...] = (3.5,)
    silent: float | None = None
    taken: float | None = 6.0
    has_ros: bool = True
    has_diagnostics: bool = True


@cache
def _tools():
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY), load_catalogue()


@cache
def recorded(drive: Drive = Drive()) -> bytes:
    """Returns the file of a drive."""
    stream = io.BytesIO()
    with McapFile(stream, has_jaus=True) as file:
        writer = _Writer(file)
        for time, write in sorted(_events(writer, drive), key=lambda event: event[0]):
            write(time)
            if time.is_integer():
                file.flush()
    return stream.getvalue()


def recorded_machines(component, service, machine, states) -> bytes:
    """Returns the file of a machine that tells states at times (MachineStates), beside queries."""
    stream = io.BytesIO()
    with McapFile(stream, has_jaus=True) as file:
        writer = _Writer(file)
        for time, state in states.items():
            names = {"Service": service, "Machine": machine, "State": state}
            stay = [{"State": state, "Entries": 1, "Milliseconds": 2500}]
            told = {"MachineRec": {**names, "Milliseconds": 2500}, "TimeList": stay}
            writer.jaus(time, OPERATOR, component, "QueryMachineStates")
            writer.jaus(time, component, OPERATOR, "ReportMachineStates", MachineList=[told])
    return stream.getvalue()


def recorded_traffic(catalogue, node, address, messages, told) -> bytes:
    """Returns the file of messages and of what a bridge tells of its connections.

    Args:
        messages: Time, source, destination, name and fields of each, in their order.
        told: Statuses by times: name, text and values of each.
    """
    stream = io.BytesIO()
    with McapFile(stream, has_jaus=True) as file:
        writer = _Writer(file, catalogue)
        events = [
            (message[0], partial(writer.jaus, *message[:4], **message[4])) for message in messages
        ]
        for time, statuses in told.items():
            found = [(0, *status) for status in statuses]
            events.append((time, partial(writer.statuses, time, found, node, address)))
        for _, write in sorted(events, key=lambda event: event[0]):
            write()
    return stream.getvalue()


def model_in(folder: Path) -> Path:
    """Writes the model of the bridge into a folder of its own; returns its file."""
    path = folder / "model.xmi"
    text = MODEL.read_text(encoding="utf-8")
    path.write_text(text.replace("../../../models/library/", LIBRARY_URI), encoding="utf-8")
    return path


def _events(writer, drive):
    count = round(drive.seconds / PERIOD)
    for number in range(count):
        time = number * PERIOD + 0.03
        is_dropped = any(abs(time - drop_time) < PERIOD / 2 for drop_time in drive.dropped)
        speed = 50.0 if is_dropped else 1.0 + number / count
        if drive.has_ros:
            yield time, lambda at, x=speed: writer.twist(at, x)
        if not is_dropped:
            yield time + 0.001, lambda at, x=speed: writer.effort(at, x)
    for second in range(round(drive.seconds)):
        if drive.has_ros and drive.has_diagnostics:
            yield float(second), lambda at: writer.diagnostics(at, drive)
        yield second + 0.2, lambda at: writer.jaus(at, OPERATOR, VEHICLE, "QueryStatus")
        if drive.silent is None or second < drive.silent:
            yield second + 0.21, writer.ready
    if drive.taken is not None:
        yield drive.taken + 0.5, writer.confirm


class _Writer:
    def __init__(self, file, catalogue=None):
        self.file = file
        self.store, usual = _tools()
        catalogue = catalogue or usual
        self.types = self.store.types
        self.writer = JausWriter(catalogue)
        self.catalogue = catalogue

    def ros(self, at, topic, kind, message):
        text = self.store.generate_msgdef(kind, ros_version=2)[0]
        channel = self.file.ros_channel(topic, kind, text)
        data = bytes(self.store.serialize_cdr(message, kind))
        self.file.write(channel, BEGIN + round(at * SECOND), data)

    def twist(self, at, speed):
        vector = self.types["geometry_msgs/msg/Vector3"]
        kind = "geometry_msgs/msg/Twist"
        message = self.types[kind](vector(speed, 0.0, 0.0), vector(0.0, 0.0, 0.5))
        self.ros(at, "/cmd_vel", kind, message)

    def effort(self, at, speed):
        self.jaus(at, BRIDGE, VEHICLE, "SetWrenchEffort", PropulsiveLinearEffortX=speed * 10)

    def jaus(self, at, source, target, name, **fields):
        payload = self.catalogue.encode({"message": name, "fields": fields})
        subsystem = int(source.partition(".")[0])
        message = JausMessage(BEGIN + round(at * SECOND), source, subsystem, payload)
        packet = SimpleNamespace(destination=target, sequence=0)
        self.writer.write(self.file, message, packet)
        assert not self.writer.undecoded

    def ready(self, at):
        self.jaus(at, VEHICLE, OPERATOR, "ReportStatus", Status=1, Reserved=0)

    def confirm(self, at):
        self.jaus(at, BRIDGE, OPERATOR, "ConfirmControl", ResponseCode=0)

    def diagnostics(self, at, drive):
        lost = sum(drop_time < at for drop_time in drive.dropped)
        is_new = any(at - 1 <= drop_time < at for drop_time in drive.dropped)
        taken = drive.taken is not None and at > drive.taken
        ready = (
            ("node", "active"),
            ("jaus", "ready"),
            ("controller", OPERATOR if taken else "none"),
        )
        values = (
            ("state", "failed" if is_new else "active"),
            *((("dropped: out_of_range", str(lost)),) if lost else ()),
            ("rate (Hz)", "10.00"),
            ("declared rate (Hz)", "0.00"),
            ("age (s)", "0.070"),
            ("when lost", "the stop is sent"),
            ("values limited", "0"),
            (f"peer {VEHICLE}", "ready"),
        )
        reason = "values out of range" if is_new else "running"
        self.statuses(
            at, [(2 if is_new else 0, "drive", reason, values), (0, "jaus state", "", ready)]
        )

    def statuses(self, at, statuses, node="/loop_bridge", address=BRIDGE):
        array = "diagnostic_msgs/msg/DiagnosticArray"
        header = self.types["std_msgs/msg/Header"](
            stamp=self.types["builtin_interfaces/msg/Time"](sec=0, nanosec=0), frame_id=""
        )
        pair = self.types["diagnostic_msgs/msg/KeyValue"]
        status = self.types["diagnostic_msgs/msg/DiagnosticStatus"]
        told = [
            status(level, f"{node}: {name}", text, address, [pair(*value) for value in values])
            for level, name, text, values in statuses
        ]
        self.ros(at, "/diagnostics", array, self.types[array](header, told))

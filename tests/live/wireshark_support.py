"""Capture files, dissectors and what tshark makes of them."""

import re
import shutil
import struct
import subprocess
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from jausml.generation.rendering import render
from jausml.language.model import read_models
from jausml_generators.wireshark.target import TARGET

ROOT = Path(__file__).resolve().parents[2]
CATVEHICLE = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
TSHARK = shutil.which("tshark")
SOURCE = (126, 1, 20)
DESTINATION = (200, 1, 2)
_RAW_IP = 101
_HOSTS = (bytes((127, 0, 0, 1)), bytes((127, 0, 0, 2)))
_ERRORS = re.compile(r"Lua Error|error in the dissector|Dissector bug|Malformed Packet:")


class SystemOfNothing:
    """What a dissector of services alone needs of a system."""

    name = "library"
    hosts = ()
    components = ()


def write_dissector(path: Path, view: Any = None) -> Path:
    """Writes the dissector of the example system, or one of a view; returns its path."""
    model = read_models([CATVEHICLE]).model
    target = TARGET if view is None else replace(TARGET, tasks=lambda model: _one_file(view, model))
    (artifact,) = render(model, [target])
    path.write_text(artifact.text, encoding="utf-8")
    return path


def _one_file(view: Any, model: Any) -> Sequence[Any]:
    (task,) = TARGET.tasks(model)
    return [replace(task, views=(view,))]


def packed(address: tuple[int, int, int]) -> bytes:
    subsystem, node, component = address
    return struct.pack("<I", subsystem << 16 | node << 8 | component)


def packet(payload: bytes, sequence: int = 0, flags: int = 1, source: Any = SOURCE) -> bytes:
    """Returns a message with its transport header."""
    head = struct.pack("<BHB", 0, 14 + len(payload), flags) + packed(DESTINATION) + packed(source)
    return head + payload + struct.pack("<H", sequence % 65536)


def datagram(payload: bytes, sequence: int = 0, flags: int = 1) -> bytes:
    return b"\x02" + packet(payload, sequence, flags)


def udp(payload: bytes) -> bytes:
    head = struct.pack(">HHHH", 3794, 3794, 8 + len(payload), 0)
    return _ip(17, head + payload, *_HOSTS)


def tcp(payload: bytes, position: int, port: int = 40001, *, is_answer: bool = False) -> bytes:
    """Returns a segment; the place of its first byte in its direction is `position`."""
    ports = (3794, port) if is_answer else (port, 3794)
    head = struct.pack(">HHIIBBHHH", *ports, 1 + position, 1, 0x50, 0x18, 65535, 0, 0)
    return _ip(6, head + payload, *(reversed(_HOSTS) if is_answer else _HOSTS))


def _ip(protocol: int, payload: bytes, source: bytes, destination: bytes) -> bytes:
    length = 20 + len(payload)
    head = struct.pack(">BBHHHBBH4s4s", 0x45, 0, length, 0, 0, 64, protocol, 0, source, destination)
    return head + payload


def write_capture(path: Path, packets: Iterable[bytes], most: int = 65535) -> Path:
    """Writes a pcap file of IP packets, of each no more than some bytes."""
    with path.open("wb") as file:
        file.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, _RAW_IP))
        for number, data in enumerate(packets):
            kept = data[:most]
            file.write(struct.pack("<IIII", number, 0, len(kept), len(data)) + kept)
    return path


def run_tshark(script: Path, capture: Path, *arguments: str, timeout: float = 60) -> str:
    """Returns what tshark prints; fails when it or the dissector complains."""
    assert TSHARK is not None
    command = [TSHARK, "-n", "-X", f"lua_script:{script}", "-r", str(capture), *arguments]
    result = subprocess.run(command, capture_output=True, text=True, timeout=timeout)
    complaints = result.stderr.replace("This could be dangerous.", "")
    assert result.returncode == 0, complaints[-2000:]
    assert "Lua" not in complaints, complaints[-2000:]
    found = _ERRORS.search(result.stdout)
    assert not found, result.stdout[max(0, found.start() - 500) : found.end() + 500]
    return result.stdout


@dataclass(frozen=True)
class Shown:
    """A field of a packet as tshark shows it."""

    name: str
    show: str
    value: str
    label: str


def dissect(
    script: Path, packets: Iterable[bytes], folder: Path, *arguments: str
) -> list[list[Shown]]:
    """Returns the JAUS fields of each packet, in the order of the tree."""
    return fields_of(script, write_capture(folder / "packets.pcap", packets), *arguments)


def fields_of(script: Path, capture: Path, *arguments: str) -> list[list[Shown]]:
    """Returns the JAUS fields of each packet of a capture."""
    text = run_tshark(script, capture, "-T", "pdml", *arguments)
    root = ET.fromstring(text)  # noqa: S314 - tshark wrote it
    return [list(_fields(element)) for element in root.iter("packet")]


def _fields(packet_element: ET.Element) -> Iterator[Shown]:
    for element in packet_element.iter("field"):
        name = element.get("name", "")
        if name.startswith("jaus."):
            texts = (element.get(key, "") for key in ("show", "value", "showname"))
            yield Shown(name, *texts)


def shown(fields: Iterable[Shown], name: str) -> list[str]:
    """Returns what a packet shows for a filter."""
    return [field.show for field in fields if field.name == name]

"""The ten tasks of the documentation: jausml's snippets run, and none is longer than another."""

from __future__ import annotations

import re
import shlex
import struct
import sys
from pathlib import Path

import pytest
from for_each import for_each
from scripts import run_script

GUARDS = ("docs",)

PAGE = Path(__file__).resolve().parents[2] / "docs" / "explanation" / "ten-tasks.md"
TEXT = PAGE.read_text(encoding="utf-8")
BLOCK = re.compile(r'^```(python|sh) title="(\w+)"\n(.*?)^```$', re.MULTILINE | re.DOTALL)
HEADING = re.compile(r"^## \d+\. (.+)$", re.MULTILINE)
ROW = re.compile(r"^\| \[(.+)\]\(.*\) \| (.+) \| (.+) \| (.+) \|$", re.MULTILINE)
TOOLS = ("cantools", "pymavlink", "jausml")
_, *PARTS = HEADING.split(TEXT.split("## What next")[0])
TASKS = dict(zip(PARTS[::2], PARTS[1::2], strict=True))


def lines(code):
    return [each for each in code.splitlines() if each.strip()]


def counted(part):
    return {tool: len(lines(code)) for _, tool, code in BLOCK.findall(part)}


def test_there_are_ten():
    assert len(TASKS) == 10
    assert [row[0] for row in ROW.findall(TEXT)] == list(TASKS)


@for_each("task", list(TASKS))
def test_none_is_longer(task):
    count = counted(TASKS[task])
    (row,) = (row[1:] for row in ROW.findall(TEXT) if row[0] == task)
    assert row == tuple(str(count.get(tool, "–")) for tool in TOOLS)
    assert count["jausml"] <= min(count.values())
    assert "pymavlink" in count


def test_lines_are_not_longer_than_others():
    for kind, tool, code in BLOCK.findall(TEXT):
        assert max(map(len, lines(code))) <= 100
        if kind == "python":
            compile(code, tool, "exec")


@pytest.mark.slow
@pytest.mark.live
def test_the_snippets_of_jausml_run(tmp_path):
    (tmp_path / "drive.pcap").write_bytes(capture(bytes.fromhex(QUERY_STATUS)))
    script = ["import subprocess"]
    for kind, tool, code in BLOCK.findall(TEXT):
        if tool not in ("vehicle", "jausml"):
            continue
        script.append(code if kind == "python" else _run(code))
    script += ["operator.stop()", "vehicle.stop()"]
    line = [sys.executable, "-c", "\n".join(script)]
    result = run_script(line, cwd=tmp_path, timeout=120)
    assert result.returncode == 0, result.stdout + result.stderr
    said = result.stdout
    assert "'100.1.1': ('urn:jaus:jss:" in said
    assert "\nREADY\n" in said
    assert "\nTrue\n" in said
    assert "QueryStatus" in said
    assert "\n050401009999\n" in said
    assert "name='ConfirmElementRequest'" in said
    assert "name='ReportWrenchEffort'" in said
    assert said.endswith("\nEMERGENCY\n")


QUERY_STATUS = "02 00 1000 01 0201c800 01016500 0220 0700"


def _run(code):
    program, *words = shlex.split(code)
    command = [sys.executable, "-m", program, *words]
    return f"print(subprocess.run({command!r}, check=True, capture_output=True, text=True).stdout)"


def capture(datagram):
    """Returns a pcap file of one UDP datagram in an IPv4 packet without a frame around it."""
    udp = struct.pack(">HHHH", 3794, 3794, 8 + len(datagram), 0) + datagram
    head = struct.pack(">BBHHHBBH", 0x45, 0, 20 + len(udp), 1, 0, 16, 17, 0)
    packet = head + bytes([10, 9, 0, 1, 239, 255, 0, 1]) + udp
    raw = struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 262144, 101)
    return raw + struct.pack("<IIII", 100, 0, len(packet), len(packet)) + packet

"""Programs outside Python that need not be there, and checks of them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec

from jausml import installing
from jausml.generation import native
from jausml.live.machine.findings import Finding, Verdict
from jausml.views.diagrams.layout.sheet import LayoutError
from jausml.views.diagrams.writers import svg


@dataclass(frozen=True)
class Program:
    """An optional program.

    Attributes:
        name: Its name in reports.
        commands: Names on the PATH; the first that exists is used.
        purpose: Its use.
        package: Its package in Debian and Ubuntu.
        variable: The environment variable that may name another program, empty for none.
    """

    name: str
    commands: tuple[str, ...]
    purpose: str
    package: str
    variable: str = ""

    def path(self) -> str | None:
        """Returns the path of the program, None where there is none."""
        return native.first_program(self.commands, self.variable)

    @property
    def cure(self) -> str:
        """The command that installs it."""
        another = f", or name one in {self.variable}" if self.variable else ""
        return f"apt install {self.package}{another}"

    @property
    def fault(self) -> str:
        """The remark for a computer without it."""
        if named := os.environ.get(self.variable):
            return f"{self.variable} names {named}, which is no program"
        return f"there is no {' or '.join(self.commands)}"


PROGRAMS = (
    Program(
        "compiler",
        native.COMPILERS,
        "compiled translations of bridges (in Python a scan or path costs 20 to 100 times as much)",
        "g++",
        "CXX",
    ),
    Program("git", ("git",), "versions of models, and their merges", "git"),
    Program("tshark", ("tshark",), "dissectors on the command line", "tshark"),
    Program("nft", ("nft",), "firewalls of deployments", "nftables"),
    Program("systemd-analyze", ("systemd-analyze",), "checks of units of deployments", "systemd"),
)
"""The programs that users meet."""


def program_checks() -> Iterator[Finding]:
    """Yields the findings about programs that need not be there."""
    for program in PROGRAMS:
        path = program.path()
        if path is not None:
            text = f"{path} is there for {program.purpose}"
            yield Finding("programs", program.name, Verdict.OK, text)
        else:
            text = f"{program.fault}, which is for {program.purpose}"
            yield Finding("programs", program.name, Verdict.NOTE, text, program.cure)
    yield _fonts()


def _fonts() -> Finding:
    try:
        text = f"{svg.installed_font()} is there for pictures in PNG"
    except LayoutError as error:
        cure = svg.FONT_CURE if find_spec("resvg_py") else installing.command("diagram")
        return Finding("programs", "fonts", Verdict.NOTE, str(error), cure)
    return Finding("programs", "fonts", Verdict.OK, text)

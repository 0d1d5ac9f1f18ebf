"""Optional programs outside Python: purpose, path, and the package that has each."""

from __future__ import annotations

import os
from dataclasses import dataclass

from jausml.generation import native


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

"""Programs that are no part of Python and that some of the work asks for: who lacks one is told."""

from __future__ import annotations

import os
from dataclasses import dataclass

from jausml.generation import native


@dataclass(frozen=True)
class Program:
    """A program that need not be there.

    Attributes:
        name: What it is called where it is asked for.
        commands: Names on the PATH; the first that is there is taken.
        purpose: What it is for.
        package: The package of Debian and Ubuntu that has it.
        variable: The variable of the environment that names another, empty where none does.
    """

    name: str
    commands: tuple[str, ...]
    purpose: str
    package: str
    variable: str = ""

    def path(self) -> str | None:
        """Returns where it is, None where it is not."""
        return native.first_program(self.commands, self.variable)

    @property
    def cure(self) -> str:
        """How one gets it."""
        another = f", or name one in {self.variable}" if self.variable else ""
        return f"apt install {self.package}{another}"

    @property
    def fault(self) -> str:
        """A remark where the program is not there."""
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

"""`python -m jausml.cli`: the command line without the console script."""

from __future__ import annotations

from jausml.cli import main

main(prog_name="jausml")

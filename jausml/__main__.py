"""`python -m jausml`: the command line without the console script."""

from jausml.cli import program

program()

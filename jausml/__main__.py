"""Runs the command line as `python -m jausml`."""

from jausml.cli import main

if __name__ == "__main__":
    main()

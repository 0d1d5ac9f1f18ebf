"""How jausml is installed: the one place that knows where it can be had.

It is on no public index, where whoever takes the name first would be installed. On the day that it
is published there, `SOURCE` becomes `jausml`, and the commands in docs/install.md with it.
"""

from jausml import __version__

SOURCE = f"jausml-{__version__}-py3-none-any.whl"
"""The name for pip: the wheel of a release, or the one that `make wheel` builds."""


def command(extra: str) -> str:
    """Returns the command that installs jausml with an extra, e.g. `record`."""
    return f"pip install '{SOURCE}[{extra}]'"

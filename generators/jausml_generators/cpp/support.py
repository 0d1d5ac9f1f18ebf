"""The headers that generated C++ includes, which stand beside it and are the same for all."""

from __future__ import annotations

import functools

from jausml.generation.target import templates_beside

JAUS = "jaus.hpp"
"""What messages include."""

CORE = ("fastpath.hpp", "core.hpp", JAUS)
"""What the core of a bridge includes."""


@functools.cache
def support(name: str) -> str:
    """Returns the text of a header."""
    return (templates_beside(__file__) / name).read_text(encoding="utf-8")

"""Questions on a terminal: one of several things, or some of them."""

from __future__ import annotations

import re
import sys
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Sequence

_NONE = "0"


def can_ask() -> bool:
    """Tells whether somebody sits at a terminal who can be asked."""
    return sys.stdin.isatty() and sys.stderr.isatty()


def choose(question: str, options: Sequence[str]) -> list[int]:
    """Asks for some of several options; returns their positions, none where none is wanted."""
    click.echo(question, err=True)
    for number, option in enumerate(options, start=1):
        click.echo(f"  {number}  {option}", err=True)
    click.echo(f"  {_NONE}  none of these", err=True)

    def numbers(text: str) -> list[int]:
        words = [each for each in re.split(r"[\s,]+", text.strip()) if each]
        if words == [_NONE]:
            return []
        found = [int(each) - 1 for each in words if each.isascii() and each.isdigit()]
        if not words or len(found) != len(words) or not all(0 <= n < len(options) for n in found):
            raise click.BadParameter(f"give numbers from 1 to {len(options)}, or {_NONE} for none")
        return list(dict.fromkeys(found))

    chosen: list[int] = click.prompt("Which (numbers)", "1", value_proc=numbers, err=True)
    return chosen

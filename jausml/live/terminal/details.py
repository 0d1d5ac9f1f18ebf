"""All that is known of one connection, as texts of a panel.

What others wrote is in them as it is, and never as markup.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.text import Text

from jausml.live.systems.tables import cell, shown_name, shown_state, sparkline

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.live.systems.state import ConnectionState

_WIDEST = 400
_BARS = 40


def told_of(connection: ConnectionState) -> Text:
    """Returns what the model and the bridge say of a connection."""
    text = titled(shown_name(connection), [f"{shown_state(connection)}: {connection.reason}"])
    declaration = connection.declaration
    if declaration is not None:
        topics = ", ".join(each.name for each in declaration.topics)
        carried = f"{declaration.message} {declaration.direction}"
        text.append(f"{cell(f'{carried}: {topics}' if topics else carried, _WIDEST)}\n")
    bars = sparkline(connection.history, connection.declared_rate, _BARS)
    if bars:
        text.append(f"{bars}\n")
    text.append("\n")
    for key, value in connection.values:
        text.append(f"{cell(f'{key}: {value}', _WIDEST)}\n")
    return text


def titled(title: str, lines: Iterable[str]) -> Text:
    """Returns lines below a title."""
    text = Text()
    text.append(f"{cell(title, _WIDEST)}\n", style="bold")
    for line in lines:
        text.append(f"{cell(line, _WIDEST)}\n")
    return text

"""The terminal view of a running system: tables of connections and components, and details.

It needs textual.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import ClassVar

from rich.text import Text
from textual.app import App, ComposeResult
from textual.binding import Binding
from textual.containers import Horizontal, VerticalScroll
from textual.coordinate import Coordinate
from textual.widgets import DataTable, Footer, Input, Static

from jausml.live.systems.inspection import Inspection
from jausml.live.systems.state import ConnectionState, Level, SystemState
from jausml.live.systems.tables import (
    COLUMNS,
    COMPONENT_TITLES,
    MACHINE_TITLES,
    arranged,
    by_address,
    cell,
    component_row,
    is_descending,
    machine_rows,
    row,
    shown_name,
    sparkline,
    state_text,
    summary,
)

_WIDEST = 400  # characters of a line of the details
_BARS = 40  # of the history in the details

_STYLES = {
    Level.OK: "green",
    Level.UNKNOWN: "dim",
    Level.STALE: "cyan",
    Level.WARNING: "yellow",
    Level.NOT_HEARD: "magenta",
    Level.ERROR: "bold red",
}
_PARTS = ("told", "ros", "jaus")  # the identifiers of the parts of the panel
_HISTORY = 4  # index of the column with the history of the rate


def _details_of(connection: ConnectionState) -> Text:
    """Returns the state, the declaration and the values of a connection as lines."""
    text = _titled(shown_name(connection), [f"{state_text(connection)}: {connection.reason}"])
    declaration = connection.declaration
    if declaration is not None:
        topics = ", ".join(topic.name for topic in declaration.topics)
        carried = f"{declaration.message} {declaration.direction}"
        text.append(f"{cell(f'{carried}: {topics}' if topics else carried, _WIDEST)}\n")
    bars = sparkline(connection.history, connection.declared_rate, _BARS)
    if bars:
        text.append(f"{bars}\n")
    text.append("\n")
    for key, value in connection.values:
        text.append(f"{cell(f'{key}: {value}', _WIDEST)}\n")
    return text


def _titled(title: str, lines: Iterable[str]) -> Text:
    """Returns lines below a title."""
    text = Text()
    text.append(f"{cell(title, _WIDEST)}\n", style="bold")
    for line in lines:
        text.append(f"{cell(line, _WIDEST)}\n")
    return text


class Connections(DataTable[Text]):
    """The table of connections."""

    BINDINGS: ClassVar = [Binding("enter", "select_cursor", "Details")]


class SystemView(App[None]):
    """Shows a system, anew every `interval` seconds."""

    TITLE = "jausml top"
    ENABLE_COMMAND_PALETTE = False
    CSS = """
    #summary { height: 1; text-style: bold; }
    #filter { display: none; height: 3; }
    #filter.open { display: block; }
    #connections { height: 1fr; }
    #components { height: auto; max-height: 12; }
    #machines { height: auto; max-height: 8; }
    #panel { display: none; height: 2fr; border-top: solid $primary; }
    #panel.open { display: block; }
    #panel > VerticalScroll { width: 1fr; padding-right: 1; }
    """
    BINDINGS: ClassVar = [
        Binding("slash", "filter", "Filter", key_display="/"),
        Binding("s", "sort_next", "Sort"),
        *(
            Binding(str(index + 1), f"sort({index})", f"Sort by {column.title}", show=False)
            for index, column in enumerate(COLUMNS)
        ),
        Binding("r", "reverse", "Reverse"),
        Binding("escape", "leave", "Back"),
        Binding("q", "quit", "Quit"),
        Binding("ctrl+c", "quit", "Quit", show=False, priority=True),
    ]

    def __init__(
        self, state: Callable[[], SystemState], inspection: Inspection, interval: float
    ) -> None:
        """Takes the first state.

        Args:
            state: Returns the present state.
            inspection: Returns the last messages of a connection; it is closed with the view.
            interval: Seconds between two states.
        """
        super().__init__()
        self._observe = state
        self._inspection = inspection
        self._interval = interval
        self._state = state()
        self._column = 0
        self._is_reversed = False
        self._shown: list[tuple[str, str]] = []

    def compose(self) -> ComposeResult:
        """Yields the parts from top to bottom."""
        yield Static(id="summary", markup=False)
        yield Input(placeholder="part of a name", id="filter")
        yield Connections(id="connections", cursor_type="row")
        yield DataTable(id="components", cursor_type="none")
        yield DataTable(id="machines", cursor_type="none")
        with Horizontal(id="panel"):
            for part in _PARTS:
                with VerticalScroll():
                    yield Static(id=part, markup=False)
        yield Footer()

    def on_mount(self) -> None:
        """Fills the tables, and begins the interval."""
        for name, titles in (("#components", COMPONENT_TITLES), ("#machines", MACHINE_TITLES)):
            table = self.query_one(name, DataTable)
            table.add_columns(*titles)
            table.can_focus = False
        self._set_titles()
        self.query_one(Connections).focus()
        self.look()
        self.set_interval(self._interval, self.look)

    def on_unmount(self) -> None:
        """Ends the inspection of the panel."""
        self._inspection.close()

    # ---- contents ---------------------------------------------------------------------------

    def look(self) -> None:
        """Shows the present state."""
        self._state = self._observe()
        self._show()

    def _show(self) -> None:
        self.query_one("#summary", Static).update(Text(summary(self._state)))
        self._show_connections()
        self._show_components()
        self._show_machines()
        self._show_details()

    def _set_titles(self) -> None:
        """Clears the table, and sets the titles of its columns, with a mark at the sorted one."""
        table = self.query_one(Connections)
        table.clear(columns=True)
        self._shown = []
        mark = "▼" if is_descending(self._column, is_reversed=self._is_reversed) else "▲"
        titles = [column.title for column in COLUMNS]
        titles[self._column] += f" {mark}"
        titles.insert(_HISTORY, "history")
        for title in titles:
            table.add_column(Text(title))

    def _show_connections(self) -> None:
        table = self.query_one(Connections)
        wanted = self.query_one("#filter", Input).value
        connections = arranged(self._state, self._column, wanted, is_reversed=self._is_reversed)
        keys = [connection.key for connection in connections]
        rows = [_cells(connection) for connection in connections]
        if keys == self._shown:
            for index, cells in enumerate(rows):
                self._update_row(table, index, cells)
            return
        chosen = self._chosen_key()
        table.clear()
        for cells in rows:
            table.add_row(*cells)
        self._shown = keys
        if chosen in keys:
            table.move_cursor(row=keys.index(chosen))

    @staticmethod
    def _update_row(table: Connections, index: int, cells: list[Text]) -> None:
        for place, text in enumerate(cells):
            at = Coordinate(index, place)
            former = table.get_cell_at(at)
            if former != text:
                table.update_cell_at(at, text, update_width=len(text) != len(former))

    def _show_components(self) -> None:
        table = self.query_one("#components", DataTable)
        table.clear()
        for component in by_address(self._state):
            first, *others = component_row(component)
            table.add_row(Text(first, style=_STYLES[component.level]), *map(Text, others))

    def _show_machines(self) -> None:
        table = self.query_one("#machines", DataTable)
        table.clear()
        rows = machine_rows(self._state)
        table.display = bool(rows)
        for machine_row in rows:
            table.add_row(*map(Text, machine_row))

    def _show_details(self) -> None:
        if not self.query_one("#panel").has_class("open"):
            return
        connection = self._chosen()
        if connection is None:  # the filter hides all
            self._inspection.away()
            texts = (Text(), Text(), Text())
        else:
            ros, jaus = self._inspection.at(connection)
            texts = (
                _details_of(connection),
                _titled("Last message in ROS", ros),
                _titled("Last message in JAUS", jaus),
            )
        for part, text in zip(_PARTS, texts, strict=True):
            self.query_one(f"#{part}", Static).update(text)

    def _chosen_key(self) -> tuple[str, str] | None:
        index = self.query_one(Connections).cursor_row
        return self._shown[index] if 0 <= index < len(self._shown) else None

    def _chosen(self) -> ConnectionState | None:
        key = self._chosen_key()
        return None if key is None else self._state.connections.get(key)

    # ---- actions ----------------------------------------------------------------------------

    def action_filter(self) -> None:
        """Opens the filter."""
        field = self.query_one("#filter", Input)
        field.add_class("open")
        field.focus()

    def on_input_changed(self) -> None:
        """Filters by the text typed so far."""
        self._show()

    def on_input_submitted(self) -> None:
        """Returns to the table; the filter stays."""
        self.query_one(Connections).focus()

    def action_sort_next(self) -> None:
        """Sorts by the next column."""
        self._sort((self._column + 1) % len(COLUMNS), is_reversed=False)

    def action_sort(self, column: int) -> None:
        """Sorts by a column; by the present one, turns the order."""
        self._sort(column, is_reversed=column == self._column and not self._is_reversed)

    def action_reverse(self) -> None:
        """Reverses the order."""
        self._sort(self._column, is_reversed=not self._is_reversed)

    def _sort(self, column: int, *, is_reversed: bool) -> None:
        chosen = self._chosen_key()
        self._column, self._is_reversed = column, is_reversed
        self._set_titles()
        self._show_connections()
        if chosen in self._shown:
            table = self.query_one(Connections)
            table.move_cursor(row=self._shown.index(chosen))

    def on_data_table_row_selected(self) -> None:
        """Opens the details of the chosen connection, or closes them."""
        panel = self.query_one("#panel")
        panel.toggle_class("open")
        if panel.has_class("open"):
            self._show_details()
        else:
            self._inspection.away()

    def action_leave(self) -> None:
        """Closes the filter and shows all connections; if it is closed, closes the details."""
        field = self.query_one("#filter", Input)
        if field.has_class("open"):
            field.remove_class("open")
            field.value = ""
            self.query_one(Connections).focus()
        elif self.query_one("#panel").has_class("open"):
            self.on_data_table_row_selected()


def _cells(connection: ConnectionState) -> list[Text]:
    cells = [
        Text(text, justify="right" if column.is_number else "left")
        for text, column in zip(row(connection), COLUMNS, strict=True)
    ]
    cells[0].stylize(_STYLES[connection.level])
    cells.insert(_HISTORY, Text(sparkline(connection.history, connection.declared_rate)))
    return cells

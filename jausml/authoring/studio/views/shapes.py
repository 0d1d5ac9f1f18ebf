"""Shapes of the answers; the session makes JSON of them, without the underscores behind names."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jausml.authoring.editing.commands import Command
    from jausml.authoring.proposals.targets import Choice


@dataclass(frozen=True, slots=True)
class Field:
    """A feature of an element that a form shows.

    Attributes:
        kind: `text`, `multiline`, `number`, `integer`, `boolean`, `choice` or `reference`.
        values: What is set; empty while the default holds.
        unit: Unit of its number, empty for none or an unknown one.
    """

    feature: str
    label: str
    kind: str
    many: bool
    required: bool
    values: tuple[str, ...] = ()
    shown: tuple[str, ...] = ()
    default: str = ""
    documentation: str = ""
    unit: str = ""
    choices: tuple[Choice, ...] = ()
    problems: tuple[str, ...] = ()
    changeable: bool = True


@dataclass(frozen=True, slots=True)
class Kind:
    """A class of elements that can be added: `jaus.Component`.

    Attributes:
        values: What a new element begins with, such as a name that nobody has.
    """

    kind: str
    label: str
    documentation: str
    values: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Child:
    """An element that another owns."""

    element: str
    label: str
    kind: str


@dataclass(frozen=True, slots=True)
class Children:
    """A feature that owns elements."""

    feature: str
    label: str
    many: bool
    documentation: str
    kinds: tuple[Kind, ...]
    elements: tuple[Child, ...]


@dataclass(frozen=True, slots=True)
class Form:
    """The properties of an element.

    Attributes:
        class_: Its class: `bridge.Connection`.
        owner: The element that owns it, empty for a root.
    """

    element: str
    class_: str
    title: str
    documentation: str
    readonly: bool
    owner: str
    fields: tuple[Field, ...]
    children: tuple[Children, ...]


@dataclass(frozen=True, slots=True)
class Drop:
    """The commands that add something, whose owner is filled in."""

    commands: Sequence[Command]


@dataclass(frozen=True, slots=True)
class PaletteItem:
    """Something that can be added.

    Attributes:
        id: Its id, the same while the library is.
        group: `components`, `services`, `ros types`, `ready maps` or `elements`.
        onto: What it is added to, as people name it; empty for the system.
    """

    id: str
    group: str
    label: str
    note: str
    documentation: str
    drop: Drop
    label_of_edit: str
    onto: str = ""

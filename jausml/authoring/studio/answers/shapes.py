"""Shapes of the answers; the session makes JSON of them, without the underscores behind names."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jausml.authoring.editing.commands import Command


@dataclass(frozen=True, slots=True)
class Choice:
    """One of the values that a field may have.

    Attributes:
        value: The value: a literal, or the text that names an element.
        label: How people name it.
        documentation: What it means.
    """

    value: str
    label: str
    documentation: str = ""


@dataclass(frozen=True, slots=True)
class Field:
    """A feature of an element that a form shows.

    Attributes:
        feature: Its name.
        label: How people name it.
        kind: `text`, `multiline`, `number`, `integer`, `boolean`, `choice` or `reference`.
        many: Whether it takes more than one value.
        required: Whether it must have a value.
        values: What is set; empty while the default holds.
        shown: The values as people name them.
        default: What holds while nothing is set.
        documentation: What it means.
        unit: Unit of its number, empty for none or an unknown one.
        choices: The legal values; of a text those that are usual.
        problems: What is wrong with it.
        changeable: Whether it may be changed.
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
        kind: Its name.
        label: How people name it.
        documentation: What it means.
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
    """A feature that owns elements.

    Attributes:
        feature: Its name.
        label: How people name it.
        many: Whether it owns more than one.
        documentation: What it means.
        kinds: What can be added; nothing where there is no room for more.
        elements: What is there.
    """

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
        element: The element.
        class_: Its class: `bridge.Connection`.
        title: How people name it.
        documentation: What its class means.
        readonly: Whether nothing of it can be changed.
        owner: The element that owns it, empty for a root.
        fields: Its attributes and references.
        children: The features that own elements.
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
        label: Its name.
        note: A few words beside the name.
        documentation: What it is.
        drop: What adds it.
        label_of_edit: How the edit is called in the log.
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


@dataclass(frozen=True, slots=True)
class Cure:
    """What makes a finding go away."""

    label: str
    commands: Sequence[Command]

"""View of the module `transcoders` of a bridge package: the flat forms of its translations."""

from __future__ import annotations

import functools
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from jausml.generation.languages.python import Imports, Origin, offered
from jausml_generators.bridge.flat.constants import Constants
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.forms import FlatForm, assembled, flat_form, readable
from jausml_generators.common import runtime
from jausml_generators.python.codec.compounds import MAXIMUM_COMPLEXITY
from jausml_generators.python.names import Scope, names_in, snake_case

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml_generators.bridge.base_module import BaseModule
    from jausml_generators.bridge.connections import ConnectionView
    from jausml_generators.bridge.translation import Translations

_WIRE = """
    DecodeError EncodeError check_presence exactly integer latin1 one_of padded real scaled
    scaled_down scaled_up sized take take_text unpadded whole whole_of
"""
_RECORDS = "LEAST CdrRecordRows CdrRecords PresenceRecords record"
_TAKEN = names_in(
    "arithmetic bridge columns connection conversions math numpy octets rotations stamps struct"
)


class Translating(Protocol):
    """A bridge as its flat forms see it."""

    @property
    def source(self) -> str:
        """Model file."""

    @property
    def element_id(self) -> str:
        """Identity of the model element."""

    @property
    def package(self) -> str:
        """Its package."""

    @property
    def base_name(self) -> str:
        """Class that has the readable translations."""

    @property
    def translations(self) -> Translations:
        """The readable translations."""

    @property
    def connections(self) -> tuple[ConnectionView, ...]:
        """The connections."""

    @property
    def module(self) -> BaseModule:
        """What stands in the module of the base besides the connections."""


@dataclass(frozen=True)
class Shared:
    """What makes the flat form of several connections, which differ in attributes of the bridge.

    Attributes:
        name: Its name in the module.
        about: What it makes, as text.
        parameters: Its parameters for the names of these attributes.
        form: The form.
        lines: Statements of the function.
    """

    name: str
    about: str
    parameters: tuple[str, ...]
    form: FlatForm
    lines: tuple[str, ...]


@dataclass(frozen=True)
class Factory:
    """What makes the flat form of one connection.

    Attributes:
        name: Its name in the module.
        about: What it makes, as text.
        form: The form.
        lines: Statements of the function; none when it is made by `shared`.
        shared: What else makes it; None for nothing.
        arguments: Names of attributes of the bridge for that.
    """

    name: str
    about: str
    form: FlatForm
    lines: tuple[str, ...] = ()
    shared: Shared | None = None
    arguments: tuple[str, ...] = ()


@dataclass(frozen=True)
class TranscodersModule:
    """The flat forms of the translations of a bridge.

    Args:
        bridge: The bridge.
    """

    bridge: Translating

    @property
    def source(self) -> str:
        """Model file."""
        return self.bridge.source

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return self.bridge.element_id

    @property
    def path(self) -> str:
        """Path of the module, relative to the output folder."""
        return f"{self.bridge.package}/{self.bridge.package}/transcoders.py"

    @property
    def layouts(self) -> tuple[str, ...]:
        """Statements of the constants that the forms have for bytes."""
        return self._constants.lines if self.factories else ()

    @property
    def tables(self) -> tuple[str, ...]:
        """Statements of those of the base's constants that the forms use as well."""
        used = {name for factory in self.factories for name in factory.form.constants}
        return self.bridge.module.constants_named(used)

    @functools.cached_property
    def factories(self) -> tuple[Factory, ...]:
        """The factories in model order; connections without a flat form have none."""
        return tuple(self._by_connection.values())

    @property
    def uses_numpy(self) -> bool:
        """Whether a form goes through lists with numpy."""
        lines = [line for each in self.factories for line in each.form.lines]
        return any(name in line for line in lines for name in ("numpy.", "columns."))

    @property
    def shared(self) -> tuple[Shared, ...]:
        """The factories that several connections use."""
        found = (each.shared for each in self.factories)
        return tuple(dict.fromkeys(each for each in found if each is not None))

    @property
    def refusals(self) -> dict[str, str]:
        """Why connections have no flat form, by their names."""
        found = {view.name: self._found[self._key(view)] for view in self.bridge.connections}
        return {name: why for name, why in found.items() if isinstance(why, str)}

    def factory_of(self, name: str) -> str:
        """Returns the name of the factory of a connection; empty when it has no flat form.

        Args:
            name: The connection.
        """
        found = self._by_connection.get(name)
        return found.name if found is not None else ""

    @property
    def imports(self) -> Imports:
        """What the module may import."""
        return Imports(
            {
                **runtime.names(),
                "numpy": Origin("numpy"),
                **offered(runtime.WIRE, *_WIRE.split()),
                **offered(runtime.RECORDS, *_RECORDS.split()),
                **offered(f".{self.bridge.package}_base", self.bridge.base_name),
            }
        )

    @property
    def remarks(self) -> tuple[str, ...]:
        """Rules of the linter that the module breaks, each with the reason."""
        all_of: tuple[Factory | Shared, ...] = (*self.factories, *self.shared)
        plain = [each for each in all_of if each.lines]
        uses = ["\n".join(each.lines) for each in plain]
        found = []
        if any("bridge" not in text for text in uses) or not all(e.form.limits for e in plain):
            found.append("ARG001 - all factories have the same parameters")
        if any(each.form.branches > MAXIMUM_COMPLEXITY for each in plain):
            found.append("C901 - a branch for each field")
        return tuple(found)

    # -- forms -----------------------------------------------------------------------------------

    @functools.cached_property
    def _constants(self) -> Constants:
        return Constants()

    def _key(self, view: ConnectionView) -> object:
        """What is the same for connections that have the same form, whichever maps they have."""
        used = view.connection.map
        joins = tuple((each.name, each.type) for each in view.joins)
        return used.message, used.type, view.to_ros, joins, readable(view.translated).text

    @functools.cached_property
    def _found(self) -> dict[object, FlatForm | str]:
        """The forms, or why there is none."""
        module = frozenset(each.name for each in self.bridge.translations.uses.constants.values())
        found: dict[object, FlatForm | str] = {}
        for view in self.bridge.connections:
            key = self._key(view)
            if key in found:
                continue
            try:
                found[key] = flat_form(
                    view.connection, view.translated, view.view_of, module, self._constants
                )
            except NotFlatError as error:
                found[key] = str(error)
        return found

    @functools.cached_property
    def _by_connection(self) -> dict[str, Factory]:
        scope = Scope(_TAKEN)
        groups: dict[object, list[tuple[str, ...]]] = defaultdict(list)
        for view in self.bridge.connections:
            groups[self._key(view)].append(readable(view.translated).attributes)
        shared: dict[object, Shared] = {}
        found: dict[str, Factory] = {}
        names = {view.name: scope.claim(view.name) for view in self.bridge.connections}
        for view in self.bridge.connections:
            key = self._key(view)
            form = self._found[key]
            if isinstance(form, str):
                continue
            attributes = readable(view.translated).attributes
            about = f"The flat form of `translate_{view.name}`.\n\nFrom {view.summary}."
            if len(groups[key]) == 1 or not form.is_shared:
                lines = assembled(form, [f"bridge.{each}" for each in attributes])
                found[view.name] = Factory(names[view.name], about, form, tuple(lines))
                continue
            if key not in shared:
                shared[key] = self._shared(view, form, scope, groups[key])
            own = tuple(attributes[index] for index in _differing(groups[key]))
            found[view.name] = Factory(names[view.name], about, form, (), shared[key], own)
        return found

    @staticmethod
    def _shared(
        view: ConnectionView, form: FlatForm, scope: Scope, group: Sequence[tuple[str, ...]]
    ) -> Shared:
        way = "to_ros" if view.to_ros else "to_jaus"
        name = scope.claim(f"_{snake_case(view.connection.map.name)}_{way}")
        # No name of the model has two underscores in a row.
        own = {index: f"attribute__{index}" for index in _differing(group)}
        texts = [
            f"getattr(bridge, {own[index]})" if index in own else f"bridge.{each}"
            for index, each in enumerate(group[0])
        ]
        lines = assembled(form, texts)
        about = f"The flat form of several translations.\n\nFrom {view.summary}."
        return Shared(name, about, tuple(own.values()), form, tuple(lines))


def _differing(group: Sequence[tuple[str, ...]]) -> list[int]:
    """Returns which attributes of the bridge differ between connections that share a form."""
    return [index for index, names in enumerate(zip(*group, strict=True)) if len(set(names)) > 1]

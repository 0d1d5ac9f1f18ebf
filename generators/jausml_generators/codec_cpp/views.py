"""View of the header with the messages of a system."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from jausml.generation.errors import GenerationError
from jausml.generation.literals import clean
from jausml_generators.cpp.jaus_codec import JausCodec
from jausml_generators.cpp.layout import laid_out
from jausml_generators.cpp.types import UnprintableError
from jausml_generators.python.codec.message_builder import build_messages
from jausml_generators.python.names import snake_case

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.language.metamodel.classes import jaus
    from jausml_generators.python.codec.messages import MessageView


class HeaderView:
    """The header of a system.

    Args:
        services: Those whose messages it has; of definitions of one code the first that fits is
            what a visitor gets.
    """

    def __init__(self, system: object, source: str, services: Iterable[jaus.Service]) -> None:
        self._system = str(system)
        self.source = source
        self.element_id = f"codec_cpp:{self._system}"
        self.messages: Sequence[MessageView] = build_messages(
            each for service in services for each in (*service.inputs, *service.outputs)
        )
        self.codec = JausCodec(is_bounded=True)
        for message in self.messages:
            try:
                self.codec.add(message)
            except UnprintableError as error:
                reason = f"{message.jaus_name}: {error} has no form in C++"
                raise GenerationError(reason) from None

    @property
    def path(self) -> str:
        """Where the file stands."""
        return f"codec_cpp/{snake_case(self._system)}_jaus.hpp"

    @property
    def title(self) -> str:
        """The name of the system in one line."""
        return clean(self._system)

    @property
    def lines(self) -> tuple[str, ...]:
        """The structs."""
        return tuple(laid_out(self.codec.lines))

    @property
    def cases(self) -> tuple[str, ...]:
        """What a visitor gets, by the codes of the messages."""
        found: dict[str, list[str]] = defaultdict(list)
        for message in self.messages:
            found[message.code_text].append(self.codec.structs[message.class_name].cpp)
        lines = (
            f"    case {code}: return jausml::visit<{', '.join(names)}>(data, size, visitor);"
            for code, names in found.items()
        )
        return tuple(laid_out(lines))

"""Target `codec_cpp`: headers with the JAUS messages of a system, for programs without Python."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

from jausml.generation.errors import GenerationError
from jausml.generation.literals import clean
from jausml.generation.target import (
    FileTask,
    Target,
    Task,
    TextFile,
    TextTask,
    WholeLibrary,
    source_of,
    system_of,
    templates_beside,
)
from jausml.language.metamodel.classes import jaus
from jausml.language.model.model import Model
from jausml_generators.common.components import library_services, used_services
from jausml_generators.cpp.jaus_codec import JausCodec
from jausml_generators.cpp.types import JAUS, UnprintableError, laid_out, support
from jausml_generators.python.codec.message_builder import build_messages
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.names import snake_case


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
            output for service in services for output in (*service.inputs, *service.outputs)
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
        """The cases of a visitor, by the codes of the messages."""
        structs_by_code: dict[str, list[str]] = defaultdict(list)
        for message in self.messages:
            structs_by_code[message.code_text].append(self.codec.structs[message.class_name].cpp)
        lines = (
            f"    case {code}: return jausml::visit<{', '.join(names)}>(data, size, visitor);"
            for code, names in structs_by_code.items()
        )
        return tuple(laid_out(lines))


def tasks(model: Model) -> list[Task]:
    """Returns the files for the messages that the system can send or receive."""
    return _headers(model, used_services(model))


def whole_library_tasks(model: Model) -> list[Task]:
    """Returns the files for every message of the shipped library and of the system."""
    return _headers(model, [*used_services(model), *library_services()])


def _headers(model: Model, services: Sequence[jaus.Service]) -> list[Task]:
    view = HeaderView(system_of(model).name, source_of(model), services)
    copy = TextFile(f"codec_cpp/{JAUS}", support(JAUS), view.element_id, "jausml")
    return [FileTask("messages.hpp.j2", [view], lambda view: view.path), TextTask([copy])]


TARGET = Target(
    name="codec_cpp",
    description="C++ headers with the JAUS messages of the system, for programs without Python.",
    tasks=tasks,
    template_folders=(templates_beside(__file__),),
    is_on_request=True,
    whole_library=WholeLibrary(
        help="every message of the library, not only those of the system", tasks=whole_library_tasks
    ),
)
"""Structs that read and write themselves (AS5684), of fixed capacity where it is bounded."""

"""The runtime's own messages are what the generator makes of the library."""

from __future__ import annotations

import importlib.util
from typing import TYPE_CHECKING

from codec_support import ROOT, library

from jausml.language.semantics.core_services import CORE, CORE_MESSAGES, SERVED_BY_RUNTIME
from jausml.runtime import messages as core_messages
from jausml.runtime.services import core
from jausml.runtime.services.liveness import UNSOLICITED
from jausml.runtime.wire.message import Message

if TYPE_CHECKING:
    from types import ModuleType

GUARDS = (
    "models/library/jaus",
    "jausml/runtime/messages.py",
    "tools/build_core_messages.py",
)


def tool(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / "tools" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_module_is_up_to_date() -> None:
    build = tool("build_core_messages")
    assert build.OUTPUT.read_text("utf-8") == build.build()


def test_the_module_has_every_message_of_the_core_services() -> None:
    views, _, _ = library("core-v1.1")
    expected = {view.jaus_name: view.code for view in views}
    classes = {
        name: cls.CODE
        for name, cls in vars(core_messages).items()
        if isinstance(cls, type) and issubclass(cls, Message) and hasattr(cls, "CODE")
    }
    assert classes == expected == CORE_MESSAGES


def test_messages_of_core_1_0_are_the_same() -> None:
    newer = {view.jaus_name: view for view in library("core-v1.1")[0]}
    for view in library("core-v1.0")[0]:
        assert view.body.segments == newer[view.jaus_name].body.segments
        assert view.code == newer[view.jaus_name].code


def test_models_and_runtime_agree_on_the_services_that_the_runtime_serves() -> None:
    classes = [each for name, each in vars(core).items() if name.endswith("Service")]
    served = frozenset().union(*(each.urns for each in classes if each is not core.CoreService))
    # Transport has no messages; unsolicited heartbeats are a setting of Liveness.
    assert served | {CORE + "Transport", UNSOLICITED} == SERVED_BY_RUNTIME

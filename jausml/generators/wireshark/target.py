"""One Lua file that makes Wireshark show JAUS messages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.generation.engine import ArtifactTask, FileTask, templates_beside
from jausml.generators.common.system import source_of, system_of
from jausml.generators.wireshark.services import library_services, used_services
from jausml.generators.wireshark.views import DissectorView

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.model.model import Model


class WiresharkTarget:
    """A dissector for JAUS over UDP and TCP (AS5669A) and the bodies of messages (AS5684).

    Args:
        whole_library: Whether it knows every message of the shipped library, and not only those
            that the system can send or receive.
    """

    name = "wireshark"
    description = "A Wireshark dissector in Lua for the messages of the system."
    template_folders = (templates_beside(__file__),)
    is_on_request = True

    def __init__(self, *, whole_library: bool = False) -> None:
        self._whole_library = whole_library

    def for_whole_library(self) -> WiresharkTarget:
        """Returns the target for every message of the shipped library (`--all`)."""
        return WiresharkTarget(whole_library=True)

    def tasks(self, model: Model) -> Sequence[ArtifactTask[Any]]:
        """Returns the one file.

        Args:
            model: A valid model.
        """
        system = system_of(model)
        services = used_services(model)
        if self._whole_library:
            services += library_services()
        view = DissectorView(system, source_of(model), services)
        return [FileTask("dissector.lua.j2", [view], lambda view: view.path)]


TARGET = WiresharkTarget()

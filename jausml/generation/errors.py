"""Errors of the generation layer, which the command line turns into messages."""

from __future__ import annotations

from collections.abc import Sequence


class GenerationError(Exception):
    """Base of every error of this layer; its text is meant for people."""


class SelectionError(GenerationError):
    """The targets that the user names do not exist, or not with that option."""


class OwnershipError(GenerationError):
    """The workspace has no files of the model that is to be adopted."""


class NoSystemError(GenerationError):
    """The file to generate from does not hold exactly one system."""

    def __init__(self, path: str, systems: Sequence[str], maps: Sequence[str]) -> None:
        content = f"{len(systems)} systems" if systems else "no system"
        super().__init__(f"{path} holds {content}, where one is needed")
        self.path = path
        self.systems = systems
        self.maps = maps


class TooLargeError(GenerationError):
    """The model asks for more than a workspace can hold; nothing has been written."""


class InternalError(GenerationError):
    """A target is wrong (template, view or its output), not the user's model."""

    def __init__(self, where: str, reason: str) -> None:
        super().__init__(f"{where}: {reason}")
        self.where = where


class RefusedError(GenerationError):
    """A plan with refusals was applied; nothing has been written."""


class WriteError(GenerationError):
    """A file could not be written or deleted; files before it in the plan are already new."""

    def __init__(self, path: str, reason: str) -> None:
        super().__init__(f"{path}: {reason}")
        self.path = path

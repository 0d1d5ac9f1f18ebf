"""Errors of messages: of bytes, of values, of definitions, and of names that nobody knows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import TypeVar

_LEAST_BEGINNING = 3

ErrorT = TypeVar("ErrorT", bound="CodecError")


class MessageError(ValueError):
    """Whatever is wrong with a message, a name or a catalogue."""


class CodecError(MessageError):
    """A fault at one place of a message.

    Attributes:
        path: Path of the field, e.g. `NodeList[2].NodeRec.NodeID`; empty for the message itself.
        others: What is wrong beside it.
    """

    def __init__(self, reason: str, path: str = "") -> None:
        super().__init__(reason)
        self.reason = reason
        self.path = path
        self.others: tuple[CodecError, ...] = ()

    def __str__(self) -> str:
        own = f"{self.path}: {self.reason}" if self.path else self.reason
        return "; ".join([own, *map(str, self.others)])

    def inside(self: ErrorT, step: str) -> ErrorT:
        """Puts a step before the path and returns the error, on its way out of a container."""
        joint = "" if not self.path or self.path.startswith("[") else "."
        self.path = f"{step}{joint}{self.path}"
        for other in self.others:
            other.inside(step)
        return self

    def beside(self: ErrorT, others: Iterable[CodecError]) -> ErrorT:
        """Adds further faults, and returns the error."""
        self.others = (*self.others, *others)
        return self


class DecodeError(CodecError):
    """Bytes that are not the message they claim to be."""


class EncodeError(CodecError):
    """Fields that cannot be encoded: a value out of range, an absent or unknown field."""


class DefinitionError(CodecError):
    """A message definition of a model that gives no codec; `jausml validate` tells more."""


class CatalogueError(MessageError):
    """Models that cannot be read."""


class UnknownServiceError(MessageError):
    """No service has the name."""

    def __init__(self, message: str, suggestions: Sequence[str] = ()) -> None:
        super().__init__(message + did_you_mean(suggestions))
        self.suggestions = tuple(suggestions)


class UnknownMessageError(UnknownServiceError):
    """No message has the name or code."""


class AmbiguousMessageError(MessageError):
    """A name or code has several meanings.

    Attributes:
        choices: The meanings, each as `NAME of SERVICE/VERSION`.
    """

    def __init__(self, what: str, choices: Sequence[str]) -> None:
        owners = {choice.partition(" of ")[2] for choice in choices}
        hint = f"; name the {'service' if len(owners) > 1 else 'message'} that is meant"
        super().__init__(f"{what} has several meanings: {', '.join(choices)}{hint}")
        self.choices = tuple(choices)


def did_you_mean(suggestions: Sequence[str]) -> str:
    """Returns the end of an error message that offers names, empty without any."""
    return f"; did you mean {' or '.join(suggestions)}?" if suggestions else ""


def similar(name: str, known: Iterable[str], limit: int = 3) -> list[str]:
    """Returns the known names that are similar to one or begin with it, without regard to case."""
    by_folded = {candidate.casefold(): candidate for candidate in sorted(known)}
    folded = name.casefold()[:200]
    keys = get_close_matches(folded, by_folded, n=limit, cutoff=0.8)
    if not keys and len(folded) >= _LEAST_BEGINNING:
        keys = [key for key in by_folded if key.startswith(folded)][:limit]
    return [by_folded[key] for key in keys]

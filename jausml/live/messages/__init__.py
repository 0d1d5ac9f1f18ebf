"""Messages: a catalogue of what models define, and a codec that needs no generated code."""

from typing import TYPE_CHECKING, Any

from jausml.live.messages.catalogue import Catalogue
from jausml.live.messages.entries import (
    DecodedMessage,
    EmbeddedMessage,
    MessageEntry,
    ServiceEntry,
    read_code,
)
from jausml.live.messages.errors import (
    AmbiguousMessageError,
    CatalogueError,
    CodecError,
    DecodeError,
    DefinitionError,
    EncodeError,
    MessageError,
    UnknownMessageError,
    UnknownServiceError,
)

if TYPE_CHECKING:
    from jausml.live.messages.defined import load_catalogue

__all__ = [
    "AmbiguousMessageError",
    "Catalogue",
    "CatalogueError",
    "CodecError",
    "DecodeError",
    "DecodedMessage",
    "DefinitionError",
    "EmbeddedMessage",
    "EncodeError",
    "MessageEntry",
    "MessageError",
    "ServiceEntry",
    "UnknownMessageError",
    "UnknownServiceError",
    "load_catalogue",
    "read_code",
]


def __getattr__(name: str) -> Any:
    """Returns `load_catalogue`, which reads models (PEP 562): a given catalogue needs none."""
    if name != "load_catalogue":
        raise AttributeError(f"module 'jausml.live.messages' has no attribute {name!r}")
    from jausml.live.messages.defined import load_catalogue  # noqa: PLC0415 - as said

    return load_catalogue

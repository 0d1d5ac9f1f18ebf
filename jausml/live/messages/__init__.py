"""Messages: a catalogue of what models define, and a codec that needs no generated code."""

from jausml.live.messages.catalogue import Catalogue, load_catalogue
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

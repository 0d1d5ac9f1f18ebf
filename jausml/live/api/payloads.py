"""JAUS messages: bytes to fields and back, by the definitions of the library and of models."""

from __future__ import annotations

import logging
import os
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jausml.language.model.project import made_project
from jausml.language.text.notation import NOTATIONS
from jausml.live.messages import load_catalogue
from jausml.live.messages.of_project import project_catalogue

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import TypeAlias

    from jausml.live.messages import Catalogue, DecodedMessage

    Models: TypeAlias = str | os.PathLike[str] | Sequence[str | os.PathLike[str]]
    """One file, or several."""


_LOG = logging.getLogger(__name__)


@lru_cache(maxsize=8)
def _catalogue(models: tuple[str, ...], project: Path | None) -> Catalogue:
    if project is not None:
        return project_catalogue(_LOG.warning)
    return load_catalogue(models, notations=NOTATIONS)


def catalogue(models: Models = ()) -> Catalogue:
    """Returns the messages of the library and of models, read once.

    Without any, those of the project of the current folder count, if `jausml init` made it.

    Raises:
        MessageError: A model cannot be read; the text has all errors with their places.
    """
    each_model = (models,) if isinstance(models, (str, os.PathLike)) else models
    names = tuple(os.fspath(each) for each in each_model)
    return _catalogue(names, None if names else made_project(Path.cwd()))


def decode(
    payload: bytes | str,
    *,
    service: str | None = None,
    message: str | None = None,
    models: Models = (),
) -> DecodedMessage:
    """Returns the message that bytes hold: its `entry` (name, code) and its `fields`.

    Args:
        service: Where a code has several meanings, that of this service: URN or name.
        message: Where it still has several, the message of this name.
    """
    data = bytes.fromhex(payload) if isinstance(payload, str) else payload
    return catalogue(models).decode(data, service, message)


def encode(
    message: str | int,
    fields: Mapping[str, Any] | None = None,
    *,
    service: str | None = None,
    models: Models = (),
) -> bytes:
    """Returns the bytes of a message: its code and its body.

    Args:
        fields: Its fields in units of the standard; the one record of a body need not be named.
        service: Where several messages have the name, that of this service: URN or name.

    Raises:
        MessageError: There is no such message, or the fields are wrong.
    """
    entry = catalogue(models).message(message, service)
    return entry.encode(entry.completed(dict(fields or {})))

"""Messages in words, for people who look at an exchange."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import TYPE_CHECKING

from jausml.live.messages import MessageError
from jausml.runtime import messages as core_messages
from jausml.runtime.wire.message import DecodeError, Message, read_code

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.live.messages import Catalogue

MAX_LENGTH = 200
"""Characters of a description; the bytes are shown beside it."""


def describe(payload: bytes, catalogue: Catalogue) -> str:
    """Returns the name and the fields of a message, or why it has none."""
    try:
        code = read_code(payload)
    except DecodeError:
        return f"{len(payload)} bytes, no message code"
    known = core_classes().get(code)
    if known is None:
        return _from_catalogue(code, payload, catalogue)
    try:
        text = repr(known.decode(payload))
    except DecodeError as error:
        return f"{known.NAME}, not decodable: {error}"
    return shortened(text.replace(f"{known.NAME}.", ""))


@lru_cache(maxsize=1)
def core_classes() -> Mapping[int, type[Message]]:
    """Returns the codecs of the core messages by message code."""
    found = vars(core_messages).values()
    return {
        each.CODE: each
        for each in found
        if isinstance(each, type) and issubclass(each, Message) and hasattr(each, "CODE")
    }


def shortened(text: str) -> str:
    """Returns the text, cut to `MAX_LENGTH` characters."""
    return text if len(text) <= MAX_LENGTH else f"{text[: MAX_LENGTH - 3]}..."


def _from_catalogue(code: int, payload: bytes, catalogue: Catalogue) -> str:
    try:
        message = catalogue.decode(payload)
    except MessageError as error:
        return shortened(f"message {code:04X} with {len(payload) - 2} bytes of body ({error})")
    return shortened(f"{message.entry.name} {json.dumps(message.fields)}")

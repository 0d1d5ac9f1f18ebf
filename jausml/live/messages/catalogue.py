"""Catalogue of messages by name and code, whoever lists them: models, or what was read of them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from jausml.live.messages.entries import (
    DecodedMessage,
    MessageEntry,
    ServiceEntry,
    read_code,
)
from jausml.live.messages.errors import (
    AmbiguousMessageError,
    CodecError,
    DecodeError,
    EncodeError,
    MessageError,
    UnknownMessageError,
    UnknownServiceError,
    similar,
)
from jausml.live.messages.values import check_names, shown

MAXIMUM_DEPTH = 8
"""Messages inside messages that are decoded; what stands deeper remains hex."""

_KEYS = ("message", "code", "service", "service_version", "fields")
_CODE = re.compile(r"(?:0[xX])?[0-9A-Fa-f]{4}")


def as_it_is(_payload: bytes, /) -> None:
    """Leaves a message inside another as hex, where it takes the place of `Catalogue.decode`."""


class Catalogue:
    """Services and messages by name and code.

    Attributes:
        services: By URN and version.
    """

    def __init__(self) -> None:
        """Begins empty; subclasses add services and messages."""
        self.services: dict[tuple[str, str], ServiceEntry] = {}
        self._codes: dict[str, list[int]] = {}

    def _with_code(self, code: int) -> tuple[MessageEntry, ...]:
        """Returns the messages of a code: definitions that are equal become one."""
        raise NotImplementedError

    @property
    def messages(self) -> tuple[MessageEntry, ...]:
        """All messages in the order of their codes."""
        codes = {code for codes in self._codes.values() for code in codes}
        return tuple(entry for code in sorted(codes) for entry in self._with_code(code))

    def find_services(self, service: str) -> tuple[ServiceEntry, ...]:
        """Returns the services of a name, in all versions unless one is given.

        Args:
            service: URN, the end of a URN or name, then `/VERSION` if one is meant.
        """
        name, _, version = service.partition("/")
        every = list(self.services.values())
        named = [service for service in every if name in (service.urn, service.name)]
        named = named or [service for service in every if name and service.urn.endswith(f":{name}")]
        matches = tuple(service for service in named if version in ("", service.version))
        if matches:
            return matches
        if named:
            versions = [f"{name}/{service.version}" for service in named]
            raise UnknownServiceError(f"service {name} has no version {version}", versions)
        known = {identifier for service in every for identifier in (service.urn, service.name)}
        raise UnknownServiceError(f"no service {shown(name)}", similar(name, known))

    def find(self, code: int, service: str | None = None) -> tuple[MessageEntry, ...]:
        """Returns the messages of a code; several when it has several meanings."""
        entries = self._with_code(code)
        if service is None:
            return entries
        return self._of_service(entries, service)

    def _of_service(
        self, entries: Sequence[MessageEntry], service: str
    ) -> tuple[MessageEntry, ...]:
        """Returns the entries that a service defines itself, else inherited ones."""
        service_entries: list[MessageEntry] = []
        for candidate in self.find_services(service):
            for ancestor in candidate.lineage:
                own = [entry for entry in entries if ancestor in entry.services]
                service_entries.extend(own)
                if own:
                    break
        return tuple(dict.fromkeys(service_entries))

    def message(self, name_or_code: str | int, service: str | None = None) -> MessageEntry:
        """Returns the one message of a name or code.

        Args:
            name_or_code: Name, code, or code in hexadecimal such as `4002` or `0x4002`.
        """
        entries = self.named(name_or_code)
        what = name_or_code if isinstance(name_or_code, str) else f"0x{name_or_code:04X}"
        if not entries:
            if _CODE.fullmatch(what):
                raise self._unknown(int(what, 16))
            raise UnknownMessageError(f"no message {shown(what)}", self._similar(what, service))
        return self._only(what, entries, service)

    def _only(
        self, what: str, entries: Sequence[MessageEntry], service: str | None
    ) -> MessageEntry:
        """Returns the one entry that a service leaves."""
        left = entries if service is None else self._of_service(entries, service)
        if not left:
            choices = tuple(
                f"{known_service.label}" for entry in entries for known_service in entry.services
            )
            raise UnknownMessageError(f"{service} has no message {what}", choices[:3])
        if len(left) > 1:
            raise AmbiguousMessageError(what, _choices(left))
        return left[0]

    def named(self, name_or_code: str | int) -> tuple[MessageEntry, ...]:
        """Returns all messages of a name or code, none for an unknown one."""
        if isinstance(name_or_code, int):
            return self._with_code(name_or_code)
        codes = self._codes.get(name_or_code)
        if codes is None:
            is_code = _CODE.fullmatch(name_or_code)
            return self._with_code(int(name_or_code, 16)) if is_code else ()
        entries = [entry for code in codes for entry in self._with_code(code)]
        return tuple(entry for entry in entries if entry.name == name_or_code)

    def _similar(self, name: str, service: str | None) -> list[str]:
        if service is None:
            return similar(name, self._codes)
        entries = [
            entry
            for known_service in self.find_services(service)
            for ancestor in known_service.lineage
            for entry in ancestor.messages
        ]
        return similar(name, {entry.name for entry in entries}) or similar(name, self._codes)

    def decode(
        self, payload: bytes, service: str | None = None, message: str | None = None
    ) -> DecodedMessage:
        """Returns the message of a payload, with the messages that stand in it.

        Where a code has several meanings, that one is taken whose definition fits the bytes.

        Args:
            service: Service whose messages are meant where a code has several meanings; other
                codes are those of the whole catalogue.
            message: Name of the message that is meant where a code still has several meanings.

        Raises:
            DecodeError: The bytes are no message of their code.
            UnknownMessageError: There is no message of the code.
            AmbiguousMessageError: Several definitions fit; the error lists them.
        """
        return self._decode(payload, service, message, MAXIMUM_DEPTH)

    def _decode(
        self, payload: bytes, service: str | None, message: str | None, depth: int
    ) -> DecodedMessage:
        code = read_code(payload)
        entries = self.find(code, service) or self._with_code(code)
        if not entries:
            raise self._unknown(code)
        entries = tuple(entry for entry in entries if entry.name == message) or entries
        deeper = partial(self._decode, service=service, message=message, depth=depth - 1)
        inner = deeper if depth else as_it_is
        fitting: list[tuple[MessageEntry, dict[str, Any]]] = []
        error: CodecError = DecodeError("no definition fits")
        for entry in entries:
            try:
                fitting.append((entry, entry.decode(payload, inner)))
            except CodecError as why:
                error = why
        if len(fitting) > 1:
            what = f"message code 0x{code:04X}"
            raise AmbiguousMessageError(what, _choices([entry for entry, _ in fitting]))
        if not fitting:
            raise error
        entry, fields = fitting[0]
        return DecodedMessage(entry, fields, self._service_of(entry, service))

    def _service_of(self, entry: MessageEntry, service: str | None) -> ServiceEntry:
        """Returns the service to name for a message: the meant one if it defines it."""
        meant = self.find_services(service) if service is not None else ()
        for candidate in meant:
            for ancestor in candidate.lineage:
                if ancestor in entry.services:
                    return ancestor
        return entry.services[0]

    def _unknown(self, code: int) -> UnknownMessageError:
        swapped = self._with_code(code >> 8 | (code & 0xFF) << 8)
        hint = f"; with its bytes swapped it is {swapped[0].name}" if swapped else ""
        return UnknownMessageError(f"no message has the code 0x{code:04X}{hint}")

    def encode(self, message: Mapping[str, Any]) -> bytes:
        """Returns the payload of a message in the shape of `DecodedMessage.to_json`.

        Args:
            message: An object with `message` (name) or `code`, and `fields`; a `service` and
                `service_version` choose between several meanings. The one record of a body need
                not be named.
        """
        try:
            return self._encode(message)
        except RecursionError:
            raise EncodeError("messages are nested too deep in it") from None

    def _encode(self, message: Mapping[str, Any]) -> bytes:
        entry = self._meant(message)
        fields = message.get("fields", {})
        if not isinstance(fields, dict):
            raise EncodeError(f"{shown(fields)} is not an object of fields", "fields")
        return entry.encode(entry.completed(fields))

    def _meant(self, message: Mapping[str, Any]) -> MessageEntry:
        name, code = message.get("message"), message.get("code")
        if name is None and code is None:
            raise EncodeError("the object has neither 'message' nor 'code'")
        check_names(message, _KEYS, ())
        service = _service_of(message)
        for value, key in ((name, "message"), (code, "code")):
            legal = isinstance(value, str) or (key == "code" and type(value) is int)
            if value is not None and not legal:
                raise EncodeError(f"{shown(value)} is no {key}", key)
        if code is None:
            return self.message(str(name), service)
        if name is None:
            return self.message(self._code_of(code), service)
        entries = self.named(name)
        if not entries:
            return self.message(name, service)  # which raises with suggestions
        number = self._code_of(code)
        left = [entry for entry in entries if entry.code == number]
        if not left:
            raise EncodeError(f"{name} has the code {entries[0].code_text}, not {code}", "code")
        return self._only(name, left, service)

    @staticmethod
    def _code_of(code: str | int) -> int:
        if isinstance(code, int) and 0 <= code <= 0xFFFF:
            return code
        if isinstance(code, int) or not _CODE.fullmatch(code):
            raise EncodeError(f"{shown(code)} is not a code of four hexadecimal digits", "code")
        return int(code, 16)

    def encode_embedded(self, message: Any, /) -> bytes:
        """Returns the payload of a message inside another, in the shape of `encode`."""
        if not isinstance(message, dict):
            raise EncodeError(f"{shown(message)} is not an object of a message")
        try:
            return self._encode(message)
        except CodecError:
            raise
        except MessageError as error:
            raise EncodeError(str(error)) from None


def _service_of(message: Mapping[str, Any]) -> str | None:
    service, version = message.get("service"), message.get("service_version")
    for value, key in ((service, "service"), (version, "service_version")):
        if value is not None and not isinstance(value, str):
            raise EncodeError(f"{shown(value)} is not a string", key)
    if version is not None and service is None:
        raise EncodeError("says nothing without a service", "service_version")
    if service is None or not version:
        return service
    name, _, own = service.partition("/")
    if own not in ("", version):
        raise EncodeError(f"{shown(version)} is not that of {service}", "service_version")
    return f"{name}/{version}"


def _choices(entries: Sequence[MessageEntry]) -> list[str]:
    """Returns the names of entries, with some of their services."""
    choices = []
    for entry in entries:
        labels = [service.label for service in entry.services]
        rest = f" and {len(labels) - 2} more" if len(labels) > 2 else ""
        choices.append(f"{entry.name} of {', '.join(labels[:2])}{rest}")
    return choices

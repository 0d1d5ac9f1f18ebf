"""The process in which values are tried: it has one generated translation, and nothing of jausml.

It answers each line of JSON on its input with one on its output: what came out, or why nothing did.
`jausml/live/workers` runs it.
"""

from __future__ import annotations

import importlib
import json
import re
import sys
import typing

_MEMORY = 1 << 30
_STEP = re.compile(r"([^\[\]]+)(?:\[(\d{1,4})\])?")
_SHOWN = 8
_REAL = frozenset({"double", "float", "float32", "float64"})


class BadValueError(ValueError):
    """A text that is no value of the field that it is for."""


def limit_memory() -> None:
    """Keeps a translation from taking all memory; where the system knows no limits, none is set."""
    try:
        import resource  # noqa: PLC0415 - Windows has none
    except ImportError:
        return
    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))


class Translation:
    """The one translation of a bridge that is not opened."""

    def __init__(self) -> None:
        bridge = importlib.import_module("trial.trial").Trial()
        self._connection = bridge.tried
        self._translate = bridge.translate_tried
        module = importlib.import_module("trial.trial_base")
        method = module.TrialBase.translate_tried
        hints = typing.get_type_hints(method, vars(module))
        hints.pop("return", None)
        self._classes = {name: _class_of(hint) for name, hint in hints.items()}

    def answer(self, request: dict[str, typing.Any]) -> dict[str, typing.Any]:
        """Returns the translation of the messages of a request, by the names of parameters."""
        counts = dict(self._connection.statistics.out_of_range)
        try:
            messages = {
                name: _message(self._classes[name], content)
                for name, content in request.items()
                if name in self._classes
            }
            target = self._translate(**messages)
            values = _as_values(target)
        except Exception as error:
            return {"error": f"{error}" or type(error).__name__, "kind": type(error).__name__}
        after = self._connection.statistics.out_of_range
        values["notes"] = [
            f"{field}: {policy}"
            for (policy, field), count in after.items()
            if count != counts.get((policy, field))
        ]
        return values


def _class_of(hint: typing.Any) -> typing.Any:
    """Returns the class of a parameter, which may be one of `X | None`."""
    inner = [alternative for alternative in typing.get_args(hint) if alternative is not type(None)]
    return inner[0] if inner else hint


def _message(cls: typing.Any, content: dict[str, typing.Any]) -> typing.Any:
    if "payload" in content:
        return cls.decode(bytes.fromhex(content["payload"]))
    message = cls()
    for path, text in content["values"].items():
        _put(message, path.split("."), text, path)
    return message


def _put(message: typing.Any, steps: list[str], text: str, path: str) -> None:
    """Gives a field of a ROS message a value, elements of sequences included."""
    match = _STEP.fullmatch(steps[0])
    if match is None or match[1] not in message.LAYOUT:
        raise BadValueError(f"there is no field {path}")
    name, index = match[1], match[2]
    kind = message.LAYOUT[name]
    if index is None:
        if steps[1:]:
            _put(getattr(message, name), steps[1:], text, path)
        else:
            setattr(message, name, _value(kind, text, path))
        return
    values, element = getattr(message, name), _element(kind)
    nested = {
        message_class.TYPE.replace("/msg/", "/"): message_class for message_class in message.NESTED
    }.get(element)
    while len(values) <= int(index):
        values.append(nested() if nested is not None else _value(element, "", path))
    if nested is not None:
        _put(values[int(index)], steps[1:], text, path)
    else:
        values[int(index)] = _value(element, text, path)


def _element(kind: str) -> str:
    inner = re.fullmatch(r"sequence<([^,<>]+(?:<\d+>)?)(?:, *\d+)?>|(.+)\[\d+\]", kind)
    return (inner[1] or inner[2]) if inner is not None else kind


def _value(kind: str, text: str, path: str) -> typing.Any:
    try:
        if kind.startswith(("string", "wstring")):
            return text
        if kind in ("boolean", "bool"):
            return {"": False, "true": True, "false": False, "1": True, "0": False}[text.lower()]
        if kind in _REAL:
            return float(text or 0)
        return int(text or "0", 0)
    except (KeyError, ValueError) as error:
        raise BadValueError(f"{path}: {text!r} is no {kind}") from error


def _as_values(target: typing.Any) -> dict[str, typing.Any]:
    if target is None:
        return {"error": "the translation drops the message", "kind": "dropped"}
    if hasattr(target, "LAYOUT"):
        return {"values": list(_rows(target, "")), "bytes": target.to_cdr().hex()}
    return {"bytes": target.encode().hex()}


def _rows(message: typing.Any, before: str) -> typing.Iterator[tuple[str, str]]:
    for name in message.LAYOUT:
        value, path = getattr(message, name), f"{before}{name}"
        if hasattr(value, "LAYOUT"):
            yield from _rows(value, f"{path}.")
        elif isinstance(value, str | bool | int | float):
            yield path, _text(value)
        elif len(value) and hasattr(value[0], "LAYOUT"):
            for index, element in enumerate(value[:_SHOWN]):
                yield from _rows(element, f"{path}[{index}].")
        else:
            shown = ", ".join(_text(element) for element in value[:_SHOWN])
            yield path, f"{shown}, ... ({len(value)})" if len(value) > _SHOWN else shown


def _text(value: typing.Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.12g}" if isinstance(value, float) else str(value)


def main() -> None:
    """Answers until the input ends."""
    translation = Translation()
    limit_memory()
    for line in sys.stdin:
        sys.stdout.write(json.dumps(translation.answer(json.loads(line))) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()

"""JSON-RPC 2.0: requests and answers as text, typed parameters, and the methods that answer."""

from __future__ import annotations

import asyncio
import collections.abc
import json
import math
import types
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from functools import lru_cache, partial
from inspect import Parameter, signature
from pathlib import PurePath
from typing import (
    Any,
    Literal,
    NoReturn,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

MadeT = TypeVar("MadeT")

_WORDS = {str: "a text", int: "a whole number", float: "a number", bool: "true or false"}


class TypedError(Exception):
    """A value is not of its type; the message says which."""


def typed(call: Callable[..., MadeT], value: object, where: str = "params") -> Callable[[], MadeT]:
    """Returns a call, of a class or function, with the members of an object as its parameters."""
    try:
        bound_call: Callable[[], MadeT] = _bound(call, value, where)
    except RecursionError as error:
        raise TypedError(f"{where} is too deep") from error
    return bound_call


def _typed(kind: Any, value: Any, where: str) -> Any:
    origin = get_origin(kind)
    if kind is object:
        return value
    if is_dataclass(kind):
        return _bound(kind, value, where)()
    if origin in (Union, types.UnionType):
        return _one_of(get_args(kind), value, where)
    if origin is Literal:
        if value not in get_args(kind):
            raise TypedError(f"{where} is one of {', '.join(map(str, get_args(kind)))}")
        return value
    if origin is tuple:
        return _list(get_args(kind), value, where)
    if origin in (dict, collections.abc.Mapping):
        return _mapping(get_args(kind)[1], value, where)
    return _plain(kind, value, where)


def _bound(call: Any, value: Any, where: str) -> Any:
    """Returns the result of a dataclass or another callable for an object with its parameters."""
    if not isinstance(value, dict):
        raise TypedError(f"{where} is an object")
    hints, known = _hints(getattr(call, "func", call)), signature(call).parameters
    unknown = [member for member in value if member not in known]
    if unknown:
        raise TypedError(f"{where} has no {unknown[0]!r}")
    for name, parameter in known.items():
        if parameter.default is Parameter.empty and name not in value:
            raise TypedError(f"{where} lacks {name}")
    return partial(
        call,
        **{
            name: _typed(hints[name], argument, f"{where}.{name}")
            for name, argument in value.items()
        },
    )


@lru_cache(maxsize=256)
def _hints(kind: Any) -> Mapping[str, Any]:
    return get_type_hints(kind)


def _one_of(kinds: tuple[Any, ...], value: Any, where: str) -> Any:
    if value is None and type(None) in kinds:
        return None
    others = [kind for kind in kinds if kind is not type(None)]
    faults = []
    for other in others:
        try:
            return _typed(other, value, where)
        except TypedError as fault:
            faults.append(fault)
    raise faults[0]


def _list(kinds: tuple[Any, ...], value: Any, where: str) -> Any:
    if not isinstance(value, list):
        raise TypedError(f"{where} is a list")
    if kinds[-1] is Ellipsis:
        kinds = kinds[:1] * len(value)
    if len(value) != len(kinds):
        raise TypedError(f"{where} has {len(kinds)} values")
    pairs = enumerate(zip(kinds, value, strict=True))
    return tuple(_typed(kind, item, f"{where}[{index}]") for index, (kind, item) in pairs)


def _mapping(kind: Any, value: Any, where: str) -> Any:
    if not isinstance(value, dict):
        raise TypedError(f"{where} is an object")
    return {
        _plain(str, name, f"a name in {where}"): _typed(kind, member, f"{where}[{name!r}]")
        for name, member in value.items()
    }


def _plain(kind: Any, value: Any, where: str) -> Any:
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        value = _float(value, where)
    if type(value) is not kind:
        raise TypedError(f"{where} is {_WORDS[kind]}")
    if kind is float and not math.isfinite(value):
        raise TypedError(f"{where} is a finite number")
    if kind is str and not _is_unicode(value):
        raise TypedError(f"{where} is no Unicode text")
    return value


def _float(value: int, where: str) -> float:
    try:
        return float(value)
    except OverflowError as error:
        raise TypedError(f"{where} is too large") from error


def _is_unicode(text: str) -> bool:
    """Tells whether a text has no half of a pair of surrogates, which no file can hold."""
    try:
        text.encode()
    except UnicodeEncodeError:
        return False
    return True


def as_json(value: Any) -> Any:
    """Returns a value in the types of JSON.

    Dataclasses become objects, of which a `NAME` is the kind, paths posix text, and numbers that
    JSON does not have null.
    """
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, str | int | float | bool | None):
        return value.value if isinstance(value, Enum) else value
    if is_dataclass(value):
        return _members(value)
    if isinstance(value, dict):
        return {str(name): as_json(member) for name, member in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [as_json(item) for item in value]
    if isinstance(value, Enum):
        return as_json(value.value)
    if isinstance(value, PurePath):
        return value.as_posix()
    raise TypeError(f"{type(value).__name__} has no place in JSON")


def _members(value: Any) -> dict[str, Any]:
    # A name of Python's own has an underscore behind it.
    members = {
        field.name.rstrip("_"): as_json(getattr(value, field.name)) for field in fields(value)
    }
    name = getattr(value, "NAME", "")
    if not name:
        return members
    if "kind" in members:
        members["type"] = members.pop("kind")
    return {"kind": name, **members}


PARSE_ERROR = -32700
INVALID_REQUEST = -32600
METHOD_NOT_FOUND = -32601
INVALID_PARAMS = -32602
INTERNAL_ERROR = -32603
REFUSED = -32000
"""The code of a refused request; the message says why."""
UNAUTHORIZED = -32001
BUSY = -32002

Id = str | int | float | None

_LARGEST = 2**53  # beyond it the numbers of JSON are not exact

ResultT = TypeVar("ResultT")

_THREADS = 8


class RpcError(Exception):
    """A request that gets no result."""

    def __init__(
        self, code: int, message: str, data: Mapping[str, Any] | None = None, id_: Id = None
    ) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        self.data = data
        self.id = id_


@dataclass(frozen=True)
class Request:
    """A request."""

    method: str
    params: Mapping[str, Any]
    id: Id
    is_notification: bool = False


def parsed(text: str) -> Request:
    """Returns the request that a message holds."""
    try:
        message = json.loads(text, parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        raise RpcError(PARSE_ERROR, "this is no JSON") from error
    if not isinstance(message, dict):
        raise RpcError(INVALID_REQUEST, "a request is an object, one a message")
    id_ = message.get("id")
    if isinstance(id_, bool) or not isinstance(id_, str | int | float | None):
        raise RpcError(INVALID_REQUEST, "the id of a request is a text or a number")
    if isinstance(id_, int | float) and abs(id_) > _LARGEST:
        raise RpcError(INVALID_REQUEST, "the id of a request is too large")
    method, params = message.get("method"), message.get("params", {})
    if message.get("jsonrpc") != "2.0" or not isinstance(method, str):
        raise RpcError(INVALID_REQUEST, 'a request has "jsonrpc": "2.0" and a method', id_=id_)
    if not isinstance(params, dict):
        raise RpcError(INVALID_PARAMS, "parameters are given by name", id_=id_)
    return Request(method, params, id_, "id" not in message)


def _no_number(constant: str) -> NoReturn:
    raise ValueError(constant)


def answer(id_: Id, result: object, revision: int | None = None) -> str:
    """Returns the message that answers a request.

    `revision`: the revision of the project of which its refs are, where it has any.
    """
    more = {} if revision is None else {"revision": revision}
    return _text({"id": id_, "result": as_json(result), **more})


def refusal(error: RpcError, id_: Id = None) -> str:
    """Returns the message that says why a request gets no result."""
    body: dict[str, Any] = {"code": error.code, "message": error.message}
    if error.data is not None:
        body["data"] = as_json(error.data)
    return _text({"id": error.id if id_ is None else id_, "error": body})


def notification(method: str, params: object) -> str:
    """Returns a message that nobody answers."""
    return _text({"method": method, "params": as_json(params)})


def _text(message: Mapping[str, Any]) -> str:
    return json.dumps({"jsonrpc": "2.0", **message}, allow_nan=False, separators=(",", ":"))


@dataclass(frozen=True)
class Method:
    """The function that answers a request; its parameters are those of the request.

    It runs on any thread; `in_turn`, it waits until those that were asked for before are done, as
    all do that change something.
    """

    answer: Callable[..., object]
    in_turn: bool = False


class Answering:
    """Answers requests on threads, so that none waits for a slow one."""

    def __init__(
        self, methods: Mapping[str, Method], refusal_of: Callable[[Exception], RpcError | None]
    ) -> None:
        """Begins without a request.

        Args:
            refusal_of: Returns what a page is told of an error of a method; None for a fault.
        """
        self._methods, self._refusal_of = methods, refusal_of
        self._threads = ThreadPoolExecutor(_THREADS, "answer")
        self._changes = ThreadPoolExecutor(1, "change")

    async def answer(self, request: Request, *context: object) -> object:
        """Returns the result of a request (`context`: the first arguments of its function)."""
        method = self._methods.get(request.method)
        if method is None:
            raise RpcError(METHOD_NOT_FOUND, f"there is no method {request.method[:80]!r}")
        try:
            call = typed(partial(method.answer, *context), dict(request.params))
            if method.in_turn:
                return await self.in_turn(call)
            return await asyncio.get_running_loop().run_in_executor(self._threads, call)
        except TypedError as error:
            raise RpcError(INVALID_PARAMS, str(error)) from error
        except Exception as error:
            refused = self._refusal_of(error)
            if refused is None:
                raise
            raise refused from error

    async def in_turn(self, work: Callable[[], ResultT]) -> ResultT:
        """Runs a function when all earlier requests that change something are done."""
        return await asyncio.get_running_loop().run_in_executor(self._changes, work)

    def close(self) -> None:
        """Stops new requests; those under way are completed."""
        self._threads.shutdown(wait=False, cancel_futures=True)
        self._changes.shutdown(wait=False, cancel_futures=True)

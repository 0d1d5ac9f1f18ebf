"""JSON-RPC 2.0: requests and answers as text, and the methods that answer requests."""

from __future__ import annotations

import asyncio
import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

from jausml.authoring.editing.commands import EditError
from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.json_values import TypedError, as_json, typed

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


PARSE_ERROR = -32700
INVALID_REQUEST = -32600
METHOD_NOT_FOUND = -32601
INVALID_PARAMS = -32602
INTERNAL_ERROR = -32603
REFUSED = -32000
"""What was asked for cannot be done; the message says why."""
UNAUTHORIZED = -32001
BUSY = -32002

Id = str | int | float | None

_LARGEST = 2**53
"""Beyond it the numbers of JSON are not exact."""

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
    """What is asked for."""

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
    if isinstance(id_, int) and abs(id_) > _LARGEST:
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
    """What answers a request: a function, whose parameters are those of the request.

    It runs on any thread; `in_turn`, it waits until those that were asked for before are done, as
    all do that change something.
    """

    answer: Callable[..., object]
    in_turn: bool = False


class Answering:
    """Answers requests on threads, so that none waits for a slow one."""

    def __init__(self, methods: Mapping[str, Method]) -> None:
        self._methods = methods
        self._threads = ThreadPoolExecutor(_THREADS, "answer")
        self._changes = ThreadPoolExecutor(1, "change")

    async def answer(self, request: Request) -> object:
        """Returns the result of a request."""
        method = self._methods.get(request.method)
        if method is None:
            raise RpcError(METHOD_NOT_FOUND, f"there is no method {request.method[:80]!a}")
        try:
            call = typed(method.answer, dict(request.params))
            if method.in_turn:
                return await self.in_turn(call)
            return await asyncio.get_running_loop().run_in_executor(self._threads, call)
        except EditError as error:
            refused = RpcError(REFUSED, str(error), {"conflict": error.conflict})
            raise refused from error
        except TypedError as error:
            raise RpcError(INVALID_PARAMS, str(error)) from error
        except AnswerError as error:
            raise RpcError(REFUSED, str(error)) from error

    async def in_turn(self, work: Callable[[], ResultT]) -> ResultT:
        """Does something when all that was asked for before and changes something is done."""
        return await asyncio.get_running_loop().run_in_executor(self._changes, work)

    def close(self) -> None:
        """Begins nothing more; what was begun is done."""
        self._threads.shutdown(wait=False, cancel_futures=True)
        self._changes.shutdown(wait=False, cancel_futures=True)

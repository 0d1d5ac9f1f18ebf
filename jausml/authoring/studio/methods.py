"""What pages may ask: methods by name, each with the dataclass of its parameters."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from jausml.authoring.editing.commands import EditError
from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.rpc import INVALID_PARAMS, METHOD_NOT_FOUND, REFUSED, RpcError
from jausml.authoring.studio.typed import TypedError, typed

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from jausml.authoring.studio.rpc import Request

ParamsT = TypeVar("ParamsT")
ResultT = TypeVar("ResultT")

_THREADS = 8


@dataclass(frozen=True)
class Method(Generic[ParamsT]):
    """A method.

    Attributes:
        answer: Returns the result; any thread may call it.
        in_turn: Whether it waits until those that were asked for before are done, as all do that
            change something.
    """

    params: type[ParamsT]
    answer: Callable[[ParamsT], object]
    in_turn: bool = False


@dataclass(frozen=True)
class Nothing:
    """No parameters."""


class Answering:
    """Answers requests on threads, so that none waits for a slow one."""

    def __init__(self, methods: Mapping[str, Method[Any]]) -> None:
        self._methods = methods
        self._threads = ThreadPoolExecutor(_THREADS, "answer")
        self._changes = ThreadPoolExecutor(1, "change")

    async def answer(self, request: Request) -> object:
        """Returns the result of a request."""
        method = self._methods.get(request.method)
        if method is None:
            raise RpcError(METHOD_NOT_FOUND, f"there is no method {request.method[:80]!a}")
        try:
            params = typed(method.params, dict(request.params))
        except TypedError as fault:
            raise RpcError(INVALID_PARAMS, str(fault)) from fault
        try:
            if method.in_turn:
                return await self.in_turn(method.answer, params)
            loop = asyncio.get_running_loop()
            return await loop.run_in_executor(self._threads, method.answer, params)
        except EditError as error:
            told = RpcError(REFUSED, str(error), {"conflict": error.conflict})
            raise told from error
        except TypedError as error:
            raise RpcError(INVALID_PARAMS, str(error)) from error
        except AnswerError as error:
            raise RpcError(REFUSED, str(error)) from error

    async def in_turn(self, work: Callable[[ParamsT], ResultT], params: ParamsT) -> ResultT:
        """Does something when all that was asked for before and changes something is done."""
        return await asyncio.get_running_loop().run_in_executor(self._changes, work, params)

    def close(self) -> None:
        """Begins nothing more; what was begun is done."""
        self._threads.shutdown(wait=False, cancel_futures=True)
        self._changes.shutdown(wait=False, cancel_futures=True)

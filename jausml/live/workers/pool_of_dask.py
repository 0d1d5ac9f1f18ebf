"""The pool of a scheduler of Dask: each of its workers has processes of its own for the work."""

from __future__ import annotations

import functools
import uuid
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from distributed import Client, KilledWorker, get_worker
from distributed.diagnostics.plugin import WorkerPlugin

from jausml.language.model.cache import digest, tool
from jausml.live.workers.pool_processes import PoolError, PoolProcesses

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from concurrent.futures import Executor

_SECONDS = 30
"""How long a scheduler, and a worker, is waited for."""


class _Processes(WorkerPlugin):  # type: ignore[misc]
    """The processes of a worker, as long as the work lasts."""

    def __init__(self, name: str, begin: bytes) -> None:
        self.name = name
        self._begin = begin

    def setup(self, worker: Any) -> None:  # noqa: ARG002 - as Dask has it
        """Begins them."""
        self.processes = PoolProcesses(self._begin)

    def teardown(self, worker: Any) -> None:  # noqa: ARG002 - as above
        """Ends them."""
        self.processes.close()


def _ask(name: str, piece: Any) -> Any:
    """Runs on a worker."""
    return get_worker().plugins[name].processes.ask(piece)


def _which_jausml() -> str:
    return digest(tool())


@contextmanager
def of_dask(
    begin: bytes, address: str
) -> Iterator[tuple[Executor, Callable[[Any], Any], Callable[[], None]]]:
    """Gives the workers of a scheduler."""
    try:
        client = Client(address, timeout=_SECONDS, set_as_default=False)
    except (OSError, TimeoutError, ValueError) as error:
        raise PoolError(f"no scheduler of Dask answers at {address}") from error
    with client:
        _check(client, address)
        name = f"jausml-{uuid.uuid4()}"
        client.register_plugin(_Processes(name, begin))
        executor = client.get_executor(pure=False)
        try:
            yield executor, functools.partial(_ask, name), functools.partial(_check_left, client)
        except (CancelledError, KilledWorker, OSError) as error:
            raise PoolError(f"the scheduler at {address}: {error or 'it has ended'}") from error
        finally:
            executor.shutdown(wait=False)
            with suppress(OSError):  # there may be no scheduler any more
                client.unregister_worker_plugin(name)


def _check(client: Client, address: str) -> None:
    try:
        client.wait_for_workers(1, timeout=_SECONDS)
    except TimeoutError as error:
        raise PoolError(f"the scheduler at {address} has no workers") from error
    own = _which_jausml()
    for worker, found in client.run(_which_jausml, on_error="return").items():
        if found != own:
            raise PoolError(f"the worker {worker} of {address} has another jausml, or none")


def _check_left(client: Client) -> None:
    if not client.nthreads():
        raise PoolError("no worker is left")

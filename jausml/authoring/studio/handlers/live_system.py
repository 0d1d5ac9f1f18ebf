"""Requests about the running system: it is watched from `live.start` until nobody looks."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

from jausml.authoring.editing.commands import EditError
from jausml.authoring.studio.json_values import freshness_as_json
from jausml.authoring.studio.live import LiveSystem, NotWatchedError, Watched
from jausml.authoring.studio.rpc import REFUSED, Method, RpcError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.authoring.studio.context import StudioContext


class LiveRequests:
    """The one system that is watched, if any."""

    def __init__(self, context: StudioContext) -> None:
        self._context = context
        self._live: LiveSystem | None = None
        self._lock = threading.Lock()

    def methods(self) -> Mapping[str, Method]:
        """Returns the methods by name."""
        return {
            "live.start": Method(self.start),
            "live.stop": Method(self.stop),
            "live.message": Method(self.message),
        }

    def start(self, file: str) -> dict[str, Any]:
        """Watches the system of a file, in the place of the one before."""
        project = self._context.project
        watched = Watched(file, project.root / file, project.root, project.model(file).model)
        with self._lock:
            if self._live is None or self._live.file != file:
                self._stop()
                self._live = LiveSystem(watched, self._context.network, self._notify)
                self._live.start()
            else:
                self._live.tell_again()
        return {}

    def stop(self) -> dict[str, Any]:
        """Watches nothing any more."""
        with self._lock:
            self._stop()
        return {}

    def leave(self) -> None:
        """Watches nothing any more; who calls does not wait for it."""
        threading.Thread(target=self.stop, name="leaving", daemon=True).start()

    def message(self, connection: str) -> dict[str, Any]:
        """Returns the last message of a connection, by the id of its row, on both sides."""
        with self._lock:
            live = self._live
        try:
            if live is None:
                raise NotWatchedError("no system is watched")
            return live.message(connection)
        except NotWatchedError as error:
            raise RpcError(REFUSED, str(error)) from error

    def changed(self) -> None:
        """Goes on with the model as it is after a change of the project."""
        with self._lock:
            if self._live is None:
                return
            try:
                self._live.follow(self._context.project.model(self._live.file).model)
            except EditError:  # the file is gone
                self._stop()

    def _stop(self) -> None:
        if self._live is not None:
            self._live.stop()
        self._live = None

    def _notify(self, values: dict[str, Any]) -> None:
        try:
            verdict = self._context.project.read(values["file"])[1]
        except EditError:
            return  # the file has gone meanwhile
        self._context.subscribers.notify(
            "live", {**values, "freshness": freshness_as_json(verdict)}
        )

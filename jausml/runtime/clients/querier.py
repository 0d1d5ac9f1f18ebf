"""Components that query other components."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from ..base.address import JausAddress
from ..services.host import Host
from ..wire.message import Message
from .query import PendingQuery, QueryClient

R = TypeVar("R", bound=Message)


class Querier(Host):
    """A component that queries other components."""

    def query(
        self,
        target: JausAddress,
        query: Message,
        report_class: type[R],
        on_report: Callable[[R, JausAddress], None] | Callable[[bytes, JausAddress], None],
        *,
        on_failure: Callable[[], None] | None = None,
        timeout: float = 1.0,
        retries: int = 3,
        payloads: bool = False,
    ) -> PendingQuery:
        """Queries another component for one report.

        Args:
            on_failure: Called when every attempt stayed unanswered.
            timeout: Seconds to wait for the report before the query is repeated.
            payloads: Whether ``on_report`` takes the encoded report, message code and body. It
                may raise DecodeError, which is counted.
        """
        with self.loop.lock:
            return self.part(QueryClient).ask(
                target,
                query,
                report_class,
                on_report,
                on_failure=on_failure,
                timeout=timeout,
                retries=retries,
                payloads=payloads,
            )

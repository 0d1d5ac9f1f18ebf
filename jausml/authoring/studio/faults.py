"""Faults of the studio itself: the latest are kept, so that a page can show them."""

from __future__ import annotations

import logging
import threading
from collections import deque
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

_MOST = 100
_LOGGER = "jausml"


class Faults(logging.Handler):
    """Keeps what is logged of warnings and faults, with their tracebacks."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._records: deque[dict[str, Any]] = deque(maxlen=_MOST)
        self._told = threading.Lock()
        self._format = logging.Formatter("%(message)s")

    @property
    def all(self) -> list[dict[str, Any]]:
        """The latest, the last one first."""
        with self._told:
            return list(reversed(self._records))

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Keeps what is logged as long as the context lasts."""
        logger = logging.getLogger(_LOGGER)
        logger.addHandler(self)
        try:
            yield
        finally:
            logger.removeHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Keeps a record."""
        told = {
            "time": record.created,
            "level": record.levelname.lower(),
            "text": record.getMessage(),
            "details": self._format.formatException(record.exc_info) if record.exc_info else "",
        }
        with self._told:
            self._records.append(told)

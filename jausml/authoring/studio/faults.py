"""Faults of a studio, for the page that shows them."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_MOST_FAULTS = 100


class Faults(logging.Handler):
    """Keeps what is logged of warnings and faults, with their tracebacks."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._records: deque[dict[str, Any]] = deque(maxlen=_MOST_FAULTS)

    @property
    def all(self) -> list[dict[str, Any]]:
        """The latest, the last one first."""
        return list(self._records.copy())[::-1]

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Keeps what is logged as long as the context lasts."""
        logger = logging.getLogger("jausml")
        logger.addHandler(self)
        try:
            yield
        finally:
            logger.removeHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Keeps a record."""
        formatted = logging.Formatter().formatException
        entry = {
            "time": record.created,
            "level": record.levelname.lower(),
            "text": record.getMessage(),
            "details": formatted(record.exc_info) if record.exc_info else "",
        }
        self._records.append(entry)

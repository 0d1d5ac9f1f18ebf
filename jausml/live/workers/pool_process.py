"""The process of a pool: it makes a worker of what it is told first, and asks it piece by piece.

It reads pickled values from its input and writes one for each piece, until the input ends. Its
argument is the folder of its temporary files, which it removes then.
"""

from __future__ import annotations

import os
import pickle
import shutil
import signal
import sys
from contextlib import suppress


def main() -> None:
    """Answers until the input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever began it ends it
    with suppress(EOFError, BrokenPipeError):
        _serve()
    # Whoever began it may have ended without a word.
    shutil.rmtree(sys.argv[1], ignore_errors=True)


def _serve() -> None:
    with os.fdopen(os.dup(0), "rb") as requests, os.fdopen(os.dup(1), "wb") as answers:
        # What the work begins neither reads pieces nor prints answers.
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(2, 1)
        worker = None
        make, shared = pickle.load(requests)  # noqa: S301 - of the process that began it
        while True:
            piece = pickle.load(requests)  # noqa: S301 - as above
            try:
                worker = worker or make(shared)
                answer = pickle.dumps((True, worker(piece)))
            except Exception as error:
                answer = pickle.dumps((False, error))
            answers.write(answer)
            answers.flush()


if __name__ == "__main__":
    del sys.path[0]  # the folder of this file
    main()

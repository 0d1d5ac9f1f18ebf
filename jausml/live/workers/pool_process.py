"""The process of a pool, which makes a worker, and calls it for each piece of work.

Its input has pickled values: first a pair of the function that makes the worker and the argument
of that, then the pieces. It writes an answer for each, the pickled pair of True and the result, or
of False and the error, until the input ends. Then it removes the folder of its temporary files,
which its argument names.
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
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # its parent ends it
    with suppress(EOFError, BrokenPipeError):
        _serve()
    # Its parent may have died, and does not remove the folder.
    shutil.rmtree(sys.argv[1], ignore_errors=True)


def _serve() -> None:
    with os.fdopen(os.dup(0), "rb") as requests, os.fdopen(os.dup(1), "wb") as answers:
        # Processes and prints of the work must not touch the pipes.
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(2, 1)
        worker = None
        make, shared = pickle.load(requests)  # noqa: S301 - of its parent
        while True:
            piece = pickle.load(requests)  # noqa: S301 - as above
            try:
                if worker is None:
                    worker = make(shared)
                answer = pickle.dumps((True, worker(piece)))
            except Exception as error:
                answer = _failure(error)
            answers.write(answer)
            answers.flush()


def _failure(error: Exception) -> bytes:
    """Returns the answer with an error, or with its text where the other side cannot make it."""
    try:
        answer = pickle.dumps((False, error))
        pickle.loads(answer)  # noqa: S301 - made here
    except Exception:
        return pickle.dumps((False, RuntimeError(f"{type(error).__name__}: {error}")))
    return answer


if __name__ == "__main__":
    del sys.path[0]  # the folder of this file
    main()

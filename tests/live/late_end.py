"""The bridge of test_fast_path, which keeps the lock for a while before it ends anything."""

import json
import sys
import time
from pathlib import Path

from fast.fast import Fast
from jausml_runtime import run_bridge

LONGEST = 60.0


class LateEnd(Fast):
    """Ends when a file is there; until then a core goes on passing messages, without the lock."""

    def close(self) -> None:
        """Waits for the file with the lock."""
        with self.loop.lock:
            sys.stdout.write(json.dumps({"kind": "ends"}) + "\n")
            sys.stdout.flush()
            end = time.monotonic() + LONGEST
            while not Path(sys.argv[1]).exists() and time.monotonic() < end:
                time.sleep(0.01)
            super().close()


if __name__ == "__main__":
    raise SystemExit(run_bridge(LateEnd(), sys.argv[2:]))

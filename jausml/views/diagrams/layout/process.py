"""The process that runs Graphviz: graphs come on stdin as JSON, their layouts go to stdout.

Native code that hangs, crashes or writes warnings does so here.
"""

from __future__ import annotations

import json
import sys


def main() -> None:
    """Lays out graphs, each by itself."""
    import pygraphviz  # noqa: PLC0415 - this process alone needs it

    graphs = [pygraphviz.AGraph(string=each) for each in json.load(sys.stdin)]
    layouts = [json.loads(each.draw(format="json", prog="dot")) for each in graphs]
    json.dump(layouts, sys.stdout)


if __name__ == "__main__":
    main()

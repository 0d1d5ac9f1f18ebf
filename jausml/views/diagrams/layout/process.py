"""The process that runs Graphviz: a graph comes on stdin, its layout goes to stdout as JSON.

Native code that hangs, crashes or writes warnings does so here.
"""

from __future__ import annotations

import sys


def main() -> None:
    """Lays out one graph."""
    import pygraphviz  # noqa: PLC0415 - this process alone needs it

    graph = pygraphviz.AGraph(string=sys.stdin.read())
    sys.stdout.buffer.write(graph.draw(format="json", prog="dot"))


if __name__ == "__main__":
    main()

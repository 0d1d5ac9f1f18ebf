"""Metamodels that several threads ask for at once: there is one of each."""

import sys

from scripts import succeeded

PROGRAM = """
import threading
from jausml.language.metamodel import load_metamodels

found, together = [], threading.Barrier(4)

def load():
    together.wait()
    found.append(load_metamodels())

threads = [threading.Thread(target=load) for _ in range(4)]
for each in threads:
    each.start()
for each in threads:
    each.join()
print(len(found), len(set(map(id, found))))
"""


def test_metamodels_are_loaded_once():
    done = succeeded([sys.executable, "-c", PROGRAM], timeout=60)
    assert done.stdout.split() == ["4", "1"]

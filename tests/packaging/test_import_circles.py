"""No module of the project imports one that imports it, imports for types included."""

import grimp
from sources import PACKAGES


def circles():
    """All groups of modules that import each other, directly or through others."""
    graph = grimp.build_graph(*PACKAGES, cache_dir=None)
    assert {module_name.partition(".")[0] for module_name in graph.modules} == set(PACKAGES)
    found = set()
    for module in graph.modules:
        others = graph.find_upstream_modules(module) & graph.find_downstream_modules(module)
        if others - {module}:
            found.add(frozenset({module} | others))
    return found


def test_there_are_no_circles():
    assert circles() == set()

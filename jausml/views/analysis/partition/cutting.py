"""Cutting: parts of a system that hold the limits and weigh little, found by a graph library."""

from __future__ import annotations

from collections import defaultdict
from itertools import combinations
from typing import TYPE_CHECKING

import networkx

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator, Sequence

    from jausml.views.analysis.partition.scale import Part, Scale

_SEED = 1


def cut(scale: Scale, now: Sequence[Part]) -> Sequence[Part]:
    """Returns the lightest of the partitions that are found, `now` itself if none is better.

    Communities (Louvain), the bridges of now and all in one are halved (Kernighan and Lin) until
    they hold the limits, and then improved by what the weight says, which knows more than a graph.
    """
    if not scale.groups:
        return now
    graph = attractions(scale)
    communities = networkx.community.louvain_communities(graph, seed=_SEED)
    starts = (now, [frozenset(graph)], [frozenset(community) for community in communities])
    partitions = [
        _improved(scale, [half for part in start for half in _halves(scale, graph, part)])
        for start in starts
    ]
    grown: list[Part] = []
    for number in sorted(graph, key=scale.size):
        grown = _put(scale, grown, number)
    return min((now, *partitions, _improved(scale, grown)), key=scale.total)


def attractions(scale: Scale) -> networkx.Graph[int]:
    """Returns the savings of each two groups that share something, by being in one bridge."""
    graph: networkx.Graph[int] = networkx.Graph()
    graph.add_nodes_from(range(len(scale.groups)))
    sharing: dict[Hashable, list[int]] = defaultdict(list)
    for number, group in enumerate(scale.groups):
        for key in (*group.cost.datagrams, *(key for key, _ in group.cost.remote)):
            sharing[key].append(number)
    for numbers in sharing.values():
        for one, other in combinations(dict.fromkeys(numbers), 2):
            apart = scale.total((frozenset((one,)), frozenset((other,))))
            over, weight = scale.weight(frozenset((one, other)))
            if over <= apart[0] and weight < apart[1]:
                graph.add_edge(one, other, weight=apart[1] - weight)
    return graph


def _halves(scale: Scale, graph: networkx.Graph[int], part: Part) -> Iterator[Part]:
    """Yields parts of a part that hold the limits, as far as groups do."""
    if len(part) == 1 or not scale.weight(part)[0]:
        yield part
        return
    for half in halved(graph, part):
        yield from _halves(scale, graph, half)


def halved(graph: networkx.Graph[int], part: Part) -> list[Part]:
    """Returns two parts of a part that share little."""
    inside = graph.subgraph(sorted(part))
    return list(map(frozenset, networkx.community.kernighan_lin_bisection(inside, seed=_SEED)))


def _improved(scale: Scale, parts: Sequence[Part]) -> list[Part]:
    """Moves groups, and empties parts, as long as that makes the whole better."""
    best = list(parts)
    while True:
        better = best
        for number in range(len(scale.groups)):
            home = next(part for part in better if number in part)
            rest = [part for part in better if part is not home]
            better = _put(scale, [home - {number}, *rest], number)
        for part in sorted(better, key=lambda part: (len(part), min(part))):
            if part in better:
                emptied = [other for other in better if other is not part]
                for number in sorted(part, key=scale.size):
                    emptied = _put(scale, emptied, number)
                better = min(better, emptied, key=scale.total)
        if scale.total(better) >= scale.total(best):
            return best
        best = better


def _put(scale: Scale, parts: Sequence[Part], number: int) -> list[Part]:
    """Returns parts after a group went into the one where it weighs least, the first if several."""
    added = [scale.added(part, number) for part in (*parts, frozenset[int]())]
    at = min(range(len(added)), key=added.__getitem__)
    rest = [part for index, part in enumerate(parts) if part and index != at]
    return [(parts[at] if at < len(parts) else frozenset()) | {number}, *rest]

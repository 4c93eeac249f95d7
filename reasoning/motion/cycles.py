"""Cycles of overlapping obstacles: a basis of them all, and a shortest odd one."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from reasoning.motion.convex import Point

Graph = dict[int, list[tuple[int, int]]]
"""For each obstacle its neighbours, each with a number of the link between them."""


class Link(NamedTuple):
    """Two obstacles that overlap when grown, and the way between their centres that stays inside them."""

    a: int
    b: int
    way: tuple[Point, Point, Point, Point]


class Segment(NamedTuple):
    """A piece of some cycles, those with a bit in the mask: from (x, low) upwards to `high`, x growing by `slope`."""

    low: float
    high: float
    x: float
    slope: float
    mask: int


def meets(p: Point, a: Point, b: Point) -> bool:
    """Whether the half-line from p to the right meets the segment ab, which has its lower end and not its upper."""
    if b[1] < a[1]:
        a, b = b, a
    return a[1] <= p[1] < b[1] and p[0] < a[0] + (p[1] - a[1]) * ((b[0] - a[0]) / (b[1] - a[1]))


def cycle_segments(links: tuple[Link, ...]) -> tuple[Segment, ...]:
    """The segments of a cycle basis: one cycle for each link that is not in a spanning forest."""
    next_to: Graph = {}
    for number, (a, b, _) in enumerate(links):
        next_to.setdefault(a, []).append((b, number))
        next_to.setdefault(b, []).append((a, number))
    parent: dict[int, tuple[int, int, int]] = {}  # node: depth, node above, link to it
    for root in next_to:
        if root in parent:
            continue
        parent[root] = (0, root, -1)
        queue = deque([root])
        while queue:
            node = queue.popleft()
            for other, number in next_to[node]:
                if other not in parent:
                    parent[other] = (parent[node][0] + 1, node, number)
                    queue.append(other)
    masks = [0] * len(links)
    in_forest = {number for _, _, number in parent.values()}
    bit = 1
    for number, (a, b, _) in enumerate(links):
        if number in in_forest:
            continue
        masks[number] ^= bit
        while a != b:
            if parent[a][0] < parent[b][0]:
                a, b = b, a
            masks[parent[a][2]] ^= bit
            a = parent[a][1]
        bit <<= 1
    return tuple(
        _segment(way[i], way[i + 1], mask)
        for mask, (_, _, way) in zip(masks, links, strict=True)
        if mask
        for i in range(3)
        if way[i][1] != way[i + 1][1]
    )


def _segment(a: Point, b: Point, mask: int) -> Segment:
    if b[1] < a[1]:
        a, b = b, a
    return Segment(a[1], b[1], a[0], (b[0] - a[0]) / (b[1] - a[1]), mask)


def shortest_odd(next_to: Graph, start: int, solids: int) -> list[int]:
    """The discs (nodes from `solids` on) of a closed walk of odd parity from `start` with the fewest of them."""
    came: dict[tuple[int, int], tuple[int, int]] = {}
    cost = {(start, 0): 0}
    queue = deque([(start, 0)])
    while queue:
        state = queue.popleft()
        if state == (start, 1):
            break
        for other, odd in next_to[state[0]]:
            step, price = (other, state[1] ^ odd), int(other >= solids)
            if cost[state] + price < cost.get(step, 1 << 30):
                cost[step], came[step] = cost[state] + price, state
                queue.append(step) if price else queue.appendleft(step)
    state, discs = (start, 1), []
    while state in came and state != (start, 0):
        if state[0] >= solids:
            discs.append(state[0])
        state = came[state]
    return discs

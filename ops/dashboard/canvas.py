"""Pictures out of braille: every cell of the terminal holds two by four dots, nearly square ones, and one colour.

Coordinates are in dots from the upper left corner, x to the right and y down; dot (i, j) covers the square from (i, j)
to (i + 1, j + 1). What is drawn later gives a cell its colour; what lies outside is cut off. Letters replace dots.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from math import ceil, floor, hypot

from rich.text import Text

from ops.dashboard.text import Block

Point = tuple[float, float]
ACROSS, DOWN = 2, 4
"""Dots in a cell."""
BITS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
BRAILLE = 0x2800


class Canvas:
    """`columns` by `rows` cells, empty at first."""

    def __init__(self, columns: int, rows: int) -> None:
        self.columns, self.rows = columns, rows
        self._bits = [[0] * columns for _ in range(rows)]
        self._letters = [[""] * columns for _ in range(rows)]
        self._styles = [[""] * columns for _ in range(rows)]
        self._grounds = [[("", "")] * columns for _ in range(rows)]

    def dot(self, x: int, y: int, style: str) -> None:
        column, row = x // ACROSS, y // DOWN
        if 0 <= column < self.columns and 0 <= row < self.rows:
            self._bits[row][column] |= BITS[y % DOWN][x % ACROSS]
            self._styles[row][column] = style

    def clear(self, x: int, y: int) -> None:
        column, row = x // ACROSS, y // DOWN
        if 0 <= column < self.columns and 0 <= row < self.rows:
            self._bits[row][column] &= ~BITS[y % DOWN][x % ACROSS]

    def line(self, start: Point, end: Point, style: str, every: int = 1) -> None:
        """A straight line, or with `every` > 1 only each such dot of it."""
        x, y = floor(start[0]), floor(start[1])
        dx, dy = floor(end[0]) - x, floor(end[1]) - y
        steps = max(abs(dx), abs(dy))
        for i in range(0, steps + 1, every):
            share = i / steps if steps else 0.0
            self.dot(x + round(dx * share), y + round(dy * share), style)

    def path(self, points: Sequence[Point], style: str, every: int = 1) -> None:
        """Lines from point to point. Dotted ones keep their rhythm round the corners."""
        left = 0.0
        for (x, y), (to_x, to_y) in pairwise(points):
            length = hypot(to_x - x, to_y - y)
            while left <= length:
                share = left / length if length else 0.0
                self.dot(floor(x + (to_x - x) * share), floor(y + (to_y - y) * share), style)
                left += every
            left -= length

    def polygon(self, corners: Sequence[Point], style: str, sparse: bool = False) -> None:
        """An area with its outline; `sparse`: every other dot of the area."""
        edges = list(zip(corners, (*corners[1:], *corners[:1]), strict=True))
        lowest, highest = floor(min(y for _, y in corners)), ceil(max(y for _, y in corners))
        for y in range(max(lowest, 0), min(highest, self.rows * DOWN)):
            crossings = sorted(_crossings(edges, y + 0.5))
            for enter, leave in zip(crossings[::2], crossings[1::2], strict=True):
                for x in self._centres(enter, leave):
                    if not sparse or (x + y) % 2 == 0:
                        self.dot(x, y, style)
        for a, b in edges:
            self.line(_inward(a, corners), _inward(b, corners), style)

    def disc(self, centre: Point, radius: float, style: str) -> None:
        """The dots whose middle is within the radius, and the one in the centre in any case."""
        self.dot(floor(centre[0]), floor(centre[1]), style)
        for y in range(floor(centre[1] - radius), ceil(centre[1] + radius)):
            half2 = radius**2 - (y + 0.5 - centre[1]) ** 2
            if half2 > 0:
                for x in self._centres(centre[0] - half2**0.5, centre[0] + half2**0.5):
                    self.dot(x, y, style)

    def text(self, column: int, row: int, letters: str, style: str) -> None:
        """Letters, each one cell wide, in place of what is there."""
        if 0 <= row < self.rows:
            for i, letter in enumerate(letters, column):
                if 0 <= i < self.columns:
                    self._letters[row][i], self._styles[row][i] = letter, style

    def ground(self, start: Point, end: Point, letter: str, style: str) -> None:
        """A letter in every cell of an area where nothing else is, from its upper left to its lower right corner: in
        the cells whose middle is inside, and in one in any case."""
        for row in _covered(start[1] / DOWN, end[1] / DOWN, self.rows):
            for column in _covered(start[0] / ACROSS, end[0] / ACROSS, self.columns):
                self._grounds[row][column] = letter, style

    def written(self, column: int, row: int) -> bool:
        """Whether there is a letter, or no such cell."""
        inside = 0 <= row < self.rows and 0 <= column < self.columns
        return not inside or bool(self._letters[row][column])

    def block(self) -> Block:
        """The picture as lines of exactly `columns` cells."""
        return [self._row(y) for y in range(self.rows)]

    def _row(self, y: int) -> Text:
        text = Text(end="", no_wrap=True)
        run, style = "", ""
        cells = zip(self._letters[y], self._bits[y], self._styles[y], self._grounds[y], strict=True)
        for letter, bits, tone, ground in cells:
            if not letter and not bits:
                letter, tone = ground
            if tone != style:
                text.append(run, style=style)
                run, style = "", tone
            run += letter or (chr(BRAILLE + bits) if bits else " ")
        text.append(run, style=style)
        return text

    def _centres(self, enter: float, leave: float) -> Iterable[int]:
        """The dots of a row whose middle lies between."""
        return range(max(ceil(enter - 0.5), 0), min(ceil(leave - 0.5), self.columns * ACROSS))


def _covered(low: float, high: float, size: int) -> range:
    """The cells, of so many, whose middle lies between; the one in the middle if there is none."""
    first, last = ceil(low - 0.5), ceil(high - 0.5)
    if first >= last:
        first, last = floor((low + high) / 2), floor((low + high) / 2) + 1
    return range(max(first, 0), min(last, size))


def _crossings(edges: Sequence[tuple[Point, Point]], y: float) -> Iterator[float]:
    """Where a row cuts the edges: an even number of times."""
    for (x1, y1), (x2, y2) in edges:
        if (y1 > y) != (y2 > y):
            yield x1 + (y - y1) * (x2 - x1) / (y2 - y1)


def _inward(corner: Point, corners: Sequence[Point]) -> Point:
    """The corner half a dot towards the middle, so that an outline covers the dots that the area covers."""
    x = sum(x for x, _ in corners) / len(corners) - corner[0]
    y = sum(y for _, y in corners) / len(corners) - corner[1]
    far = hypot(x, y) or 1.0
    return corner[0] + 0.5 * x / far, corner[1] + 0.5 * y / far

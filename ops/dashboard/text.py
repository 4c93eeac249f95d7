"""Lines of exact width. Everything on the screen is a list of such lines, so that nothing can spill over."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from rich.cells import cell_len
from rich.text import Text

Part = str | tuple[str, str] | Text
Block = list[Text]

# For terminals that cannot show more than ASCII.
SIGNS = dict(zip("┌┐└┘├┤┬┴┼─│═░·…✗●○▶→←↑↓✓»━", "+++++++++-|=:.~xo.>><^vv>=", strict=True))
BRAILLE = {chr(0x2800 + bits): " .::+++##"[bits.bit_count()] for bits in range(256)}
PLAIN = str.maketrans(SIGNS | BRAILLE)


@lru_cache(maxsize=4096)
def clean(value: object, limit: int = 600) -> str:
    """Anything as one line of printable characters, each one cell wide: names and texts come from the bus."""
    text = str(value)[:limit]
    return "".join(c if c.isprintable() and cell_len(c) == 1 else " " if c.isspace() else "?" for c in text)


def fit(text: Text, width: int) -> Text:
    """The text cut (with an ellipsis) or padded to exactly `width` cells."""
    if width <= 0:
        return Text("")
    text = text.copy()
    text.no_wrap = True
    text.truncate(width, overflow="ellipsis", pad=True)
    return text


def line(width: int, *parts: Part) -> Text:
    """One line of exactly `width` cells made of strings, (string, style) pairs and texts."""
    return fit(joined(*parts), width)


def joined(*parts: Part) -> Text:
    text = Text(end="")
    for part in parts:
        if isinstance(part, Text):
            text.append_text(part)
        elif isinstance(part, tuple):
            text.append(clean(part[0]), style=part[1])
        else:
            text.append(clean(part))
    return text


def ends(width: int, left: Text, right: Text, fill: tuple[str, str] = (" ", "")) -> Text:
    """`left` and `right` at the two ends of one line; the left one gives way, but not more than half of the line."""
    most = max(width // 2, width - left.cell_len)
    right = right if right.cell_len <= most else fit(right, most)
    room = width - right.cell_len
    start = left.copy()
    if start.cell_len > room:
        return joined(fit(start, room), right)
    gap = room - start.cell_len
    return joined(start, Text(fill[0] * gap, style=fill[1]), right)


def rule(width: int, title: Text, right: Text | None = None, style: str = "dim") -> Text:
    """A section's head: ``── title ───────── right ─``."""
    left = joined(("── ", style), title, " ") if title.plain else Text("")
    tail = joined(" ", right, (" ─", style)) if right is not None and right.plain else Text("")
    return ends(width, left, tail, ("─", style))


def wrapped(text: str, width: int, lines: int) -> list[str]:
    """The text in at most so many lines, broken at blanks; the last one ends in an ellipsis if there was more."""
    out: list[str] = []
    rest = clean(text).strip()
    while rest and len(out) < lines:
        if len(rest) <= width or len(out) == lines - 1:
            out.append(rest)
            break
        cut = rest.rfind(" ", 1, width + 1)
        cut = cut if cut > 0 else width
        out.append(rest[:cut].rstrip())
        rest = rest[cut:].lstrip()
    return [o if len(o) <= width else o[: max(width - 1, 0)] + "…" for o in out] or [""]


def sized(block: Block, width: int, height: int) -> Block:
    """The block with exactly `height` lines of exactly `width` cells."""
    lines = [fit(text, width) for text in block[: max(height, 0)]]
    return lines + [Text(" " * width, end="")] * (height - len(lines))


def beside(blocks: Sequence[Block]) -> Block:
    """Blocks of equal height next to one another."""
    return [joined(*lines) for lines in zip(*blocks, strict=True)]


def boxed(block: Block, width: int, height: int, title: Text, right: Text, style: str) -> Block:
    """The block under a title, with walls left and right; what lies below closes it."""
    inner = sized(block, width - 2, height - 1)
    tail = joined(" ", right, (" ─", style)) if right.plain else Text("─", style=style)
    head = ends(width - 2, joined(("─ ", style), title, " "), tail, ("─", style))
    wall = Text("│", style=style)
    return [joined(("┌", style), head, ("┐", style)), *(joined(wall, text, wall) for text in inner)]

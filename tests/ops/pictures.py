"""The dashboard's pictures for tests: folded from messages, and as a terminal shows them."""

from __future__ import annotations

from collections.abc import Iterable

from rich.cells import cell_len
from rich.console import Console

from bus.messages import Envelope
from bus.scene import Scene
from ops.dashboard import Model, render, update


def folded(messages: Iterable[Scene | Envelope], model: Model | None = None) -> Model:
    model = model or Model()
    for i, message in enumerate(messages):
        model = update(model, message, i * 0.01)
    return model


def picture(model: Model, width: int, height: int, **more: str) -> list[str]:
    """The lines as a terminal of that size shows them; they must fit exactly."""
    text = render(model, width, height, **more)  # type: ignore[arg-type]
    lines = text.plain.split("\n")
    assert len(lines) == height
    assert {cell_len(line) for line in lines} == {width}
    console = Console(width=width, height=height, color_system=None, force_terminal=False)
    with console.capture() as capture:
        console.print(text, end="")
    assert [line.rstrip() for line in capture.get().split("\n")] == [line.rstrip() for line in lines]
    return lines

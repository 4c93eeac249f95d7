"""Ground truth for those who watch: a frame with every body as it is. Agents never see one."""

from __future__ import annotations

from collections.abc import Mapping

from bus.messages import BodyFrame, Frame
from world.truth import Truth


def frame(truth: Truth, doing: Mapping[str, str]) -> Frame:
    """The world now; `doing` says what each robot is at, by its id.

    Positions are in metres in the coordinates of the body's place: cell (x,y) is at x, y, line position p at p,
    height + 1.
    """
    truth.fade()
    at, busy = truth.floor.positions(), doing.get
    bodies = []
    for place, things in truth.places():
        east_m, north_m = truth.layout.origin(place)
        for it in things:
            x_m, y_m = at[it.id]
            x_m, y_m, now = x_m - east_m, y_m - north_m, busy(it.id, "")
            bodies.append(
                BodyFrame(it.id, it.name, it.kind, place, x_m, y_m, 0.0, it.attributes, it.broken, it.partner, now)
            )
    return Frame(truth.tick * truth.scene.dt_s, truth.step, tuple(bodies))


def membership(truth: Truth, step: int) -> dict[str, object]:
    """Who belongs where, and how far each object is, after a step: data of the event of that name."""
    robots: dict[str, list[str]] = {}
    objects: dict[str, dict[str, object]] = {}
    for thing in truth.things.values():
        kind = truth.kind(thing)
        if kind.role == "robot":
            robots[thing.id] = [thing.place, thing.name]
        elif thing.place in truth.layout.spaces:
            objects[thing.id] = {kind.place: truth.line(thing), **thing.attributes}
    return {"step": step, "robots": robots, "objects": objects}

"""A made-up moment in a house of three rooms, for the tests of the dashboard: `told()` yields what the processes say.

The kitchen's two robots carry a pan, the living room's robot has come to the bedroom to help, and a person walks about.
"""

from __future__ import annotations

from collections.abc import Iterator

from bus.messages import Beat, BodyFrame, Envelope, Event, Frame, Status
from bus.scene import Action, Entity, Kind, Scene, Solid, Workspace

KINDS = {
    "robot": Kind("r", "robot", "floor", "at", radius_m=0.25, couples="connected"),
    "thing": Kind("", "object", "floor", "at", radius_m=0.12, grip="grip"),
    "person": Kind("", "person", "floor", "at", radius_m=0.25),
}
ROOMS = (
    Workspace("T1", 8, 8, room="bedroom", clock="elapsed",
              solids=(Solid("bed", ((0, 3.6), (2.15, 3.0), (2.55, 4.2), (0, 5.2))),
                      Solid("wardrobe", ((5.2, 5.4), (6.5, 6.9), (6.0, 7.35), (4.7, 5.85)), tall=True)),
              doors={"living_room": (7, 7, 3, 4), "kitchen": (3, 4, 7, 7)}, store=(5, 7, 0, 3)),
    Workspace("T2", 8, 8, room="kitchen", clock="elapsed",
              solids=(Solid("table", ((3.0, 2.2), (5.8, 2.2), (5.8, 3.8), (3.0, 3.8))),),
              doors={"living_room": (3, 4, 7, 7), "bedroom": (0, 0, 3, 4)}, store=(0, 2, 0, 3)),
    Workspace("T3", 16, 8, room="living_room", clock="elapsed",
              solids=(Solid("sofa", ((4.0, 6.0), (7.2, 5.6), (7.35, 6.8), (4.15, 7.2)), tall=True),
                      Solid("coffee_table", ((5.0, 3.8), (6.4, 3.8), (6.4, 4.5), (5.0, 4.5)))),
              doors={"kitchen": (11, 12, 0, 0), "bedroom": (0, 0, 3, 4)}, store=(13, 15, 2, 5)),
)  # fmt: skip
PLAN = (("goto(r1,1,2)",), ("attach(r1)",), ("goto(r1,6,2)",), ("detach(r1)",))


def scene(rooms: int = 3) -> Scene:
    spaces = ROOMS[:rooms]
    entities = [
        Entity("T1.r1", "T1", "r1", "robot", "(4,6)"),
        Entity("T1.pillow_1", "T1", "pillow_1", "thing", "(1,2)"),
        Entity("T2.r1", "T2", "r1", "robot", "(1,1)"),
        Entity("T2.r2", "T2", "r2", "robot", "(2,1)"),
        Entity("T2.pan", "T2", "pan", "thing", "(1,1)", end="(2,1)"),
        Entity("T2.anna", "T2", "anna", "person", "(6,6)"),
        Entity("T3.r1", "T3", "r1", "robot", "(3,2)"),
        Entity("T3.novel_1", "T3", "novel_1", "thing", "(6,2)"),
    ]
    here = {space.team for space in spaces}
    return Scene("housekeeping", 7, 3.0, 0.02, 10.0, 2, KINDS, {"goto": Action("follow", ("robot", "x", "y"))}, spaces,
                 tuple(e for e in entities if e.team in here), conducted=False, title="three rooms",
                 display={"places": {"bench": "hallway"}})  # fmt: skip


def said(source: str, body: object, at_s: float = 21.0) -> Envelope:
    return Envelope(1, "made-up", source, 1, 1, "i", at_s, body)  # type: ignore[arg-type]


def told(rooms: int = 3) -> Iterator[Scene | Envelope]:
    """The scene, then what everybody says at one moment."""
    yield scene(rooms)
    bodies = (
        BodyFrame("T1.r1", "r1", "robot", "T1", 3.1, 3.4, coupled_to="grip(pillow_1,1)"),
        BodyFrame("T1.pillow_1", "pillow_1", "thing", "T1", 3.1, 3.4),
        BodyFrame("T3.r1", "r2", "robot", "T1", 6.4, 3.9),
        BodyFrame("T2.r1", "r1", "robot", "T2", 1.5, 5.5, coupled_to="grip(pan,1)"),
        BodyFrame("T2.r2", "r2", "robot", "T2", 2.5, 5.5, coupled_to="grip(pan,2)"),
        BodyFrame("T2.pan", "pan", "thing", "T2", 1.5, 5.5),
        BodyFrame("T2.anna", "anna", "person", "T2", 6.2, 5.1),
        BodyFrame("T3.novel_1", "novel_1", "thing", "T3", 6.5, 2.5),
    )
    here = {space.team for space in ROOMS[:rooms]}
    yield said("world", Frame(21.0, 3, tuple(b for b in bodies if b.place in here)))
    yield said("world", Status("world", "moving", 3))
    yield said("coordinator", Status("coordinator", "waiting for the rooms"))
    statuses = {
        "T1": Status("team", "executing step 2", 2, 0, PLAN, elapsed=7, deadline=25, helping="r2 of T3 helps here",
                     ways={"r1": ((1.5, 2.5), (3.1, 3.4), (6.5, 2.5)), "r2": ((7.5, 3.5), (4.5, 6.5))}),
        "T2": Status("team", "executing step 2", 2, 0, PLAN, elapsed=22, deadline=25,
                     ways={"r1": ((1.5, 1.5), (1.5, 7.5)), "r2": ((2.5, 1.5), (2.5, 7.5))}),
        "T3": Status("team", "waiting", 4, 0, PLAN, elapsed=7, helping="r1 helps in the bedroom", finished=True),
    }  # fmt: skip
    for team in sorted(here):
        yield said(team, statuses[team])
        yield said(team, Beat(7, 40, 41))
    yield said("T1", Event("diagnosis", {"text": "T1 finds pillow_1 too heavy", "team": "T1"}))

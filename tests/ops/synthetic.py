"""A made-up run for the tests of recordings and dashboard: the published plan, played without any physics.

`story(teams)` yields what the processes of a run would say: the scene first, then envelopes. In the fourth team the
carrier breaks in step 16; the team suspects two robots, has them inspected and repairs one.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from typing import Any

from bus.messages import Beat, BodyFrame, Envelope, Event, Exchange, Frame, Status
from bus.scene import Action, Entity, Kind, Scene, Workspace
from ops.recording import Recording, SourceCount, Summary, canonical

PERIOD_S = 2.0
WORDS = {
    "effector": {"1": "painter", "2": "waxer", "3": "stamper"},
    "stage": {"0": "raw", "1": "painted", "2": "waxed", "3": "stamped"},
    "places": {"dock": "pit stop"},
}
KINDS = {
    "worker": Kind("w", "robot", "grid", "at", layer=1, attributes=("effector",), glyph="w"),
    "carrier": Kind("c", "robot", "grid", "at", layer=2, couples="attached", glyph="c"),
    "box": Kind("", "object", "line", "line", layer=3, attributes=("stage", "wet"), glyph="b"),
}
ACTIONS = {
    "move": Action("drive", ("robot", "direction")),
    "attach": Action("couple", ("robot", "partner")),
    "workOn": Action("operate", ("robot", "object"), attribute="stage", tool="effector", marks="wet", marks_on=1),
    "lineShift": Action("convey"),
    "giveRobot": Action("depart", ("robot",)),
    "takeRobot": Action("arrive", ("robot", "x", "y")),
}
MOVES = {"left": (-1, 0), "right": (1, 0), "up": (0, 1), "down": (0, -1)}
BOXES = (4, 5, 4, 3)
CREWS = ({"w1": (3, 1)}, {"w1": (3, 1), "w2": (2, 3), "w3": (1, 2)}, {"w1": (3, 1), "w2": (2, 2)}, {"w1": (3, 1)})
PLANS = [
    """wr,s wr,s s o11 wr,s o13 wr - cr,o14 wl wl o12 wl wl,t2 cu,e12 wr,2r o11,a2 wr,p o12,o21 s o13,o22 s o14,o23 s
    o24 s,d s""",
    """wr,3r,cr,s wr,2r,s,a3 2r,p,s p,o11 s,d 2l,cd,o12 wr,o31,a2 3r,p,o13 wr,o21,o32 3l,q,o14 3l,p,s o15,o22,g3 wl wl,q
    wl wl e12 wr,s o13 wr,p o14,o23 s o15,o24 s o25 s,d s""",
    """wr,2r,cr,s wr,2r,cr wr,cr,s o11 2r,cr,s wr,2r,cu,s o14,a2 wl,p o13,o24,d wl,2l o12,o23 wl,2l wl,o22 2l,g1 o21 2l
    e23 2r o21 s o22 s o23 s o24 s s""",
    """wr,s s wr,s wr,s o13 wl,cu o12 wl o11 wl,cr e12 wr o11 wl e13 wr,cu o11,a1 wl,r cd,s,t2,e12 wr,2r o12,a2 wr,p
    o13,o22 s o23,d s s""",
]
NOBODY = {"x": 1, "y": 1, "coupled": "", "broken": False, "stage": 0}
NAMES = {"l": "left", "r": "right", "u": "up", "d": "down"}


def _spelled(short: str) -> str:
    if short[0] in "wc123" and short[1:] in NAMES:
        robot = {"w": "w1", "c": "c1"}.get(short[0], f"w{short[0]}")
        return f"move({robot},{NAMES[short[1]]})"
    first, digits = short[0], short[1:]
    forms = {
        "o": "workOn(w{0},{1})", "a": "attach(c1,w{0})", "e": "swapEndEffector(w{0},{1})", "g": "giveRobot(w{0})",
        "t": "takeRobot(w{0},1,2)", "s": "lineShift", "p": "push(c1)", "q": "pull(c1)", "d": "detach(c1)",
        "r": "repair(c1)",
    }  # fmt: skip
    return forms[first].format(*digits)


def plan(team: int) -> tuple[tuple[str, ...], ...]:
    """The published plan of a team (they repeat after four)."""
    return tuple(tuple(_spelled(a) for a in step.split(",") if a != "-") for step in PLANS[team % 4].split())


def scene(teams: int = 4) -> Scene:
    spaces, entities = [], []
    for i in range(teams):
        team = f"T{i + 1}"
        spaces.append(Workspace(team, 5, 3, 5, 1))
        entities.append(Entity(f"{team}.c1", team, "c1", "carrier", "(1,1)"))
        for name, (y, tool) in CREWS[i % 4].items():
            entities.append(Entity(f"{team}.{name}", team, name, "worker", f"(1,{y})", {"effector": tool}))
        for b in range(1, BOXES[i % 4] + 1):
            entities.append(Entity(f"{team}.{b}", team, str(b), "box", b + 5, {"stage": 0, "wet": 0}))
    return Scene("factory", 7, PERIOD_S, 0.02, 10.0, 2, KINDS, ACTIONS, tuple(spaces), tuple(entities),
                 title="factory/four_teams", display=WORDS)  # fmt: skip


class Story:
    """The made-up run's state. `bodies` by the name a robot was built with."""

    def __init__(self, teams: int) -> None:
        self.scene = scene(teams)
        self.seq: dict[str, int] = {}
        self.now_s, self.round = 0.0, 0
        self.bodies: dict[str, dict[str, Any]] = {}
        for e in self.scene.entities:
            x, y = (int(n) for n in e.place.strip("()").split(",")) if isinstance(e.place, str) else (e.place, 4)
            self.bodies[e.id] = {"name": e.name, "kind": e.kind, "place": e.team, "x": x, "y": y, "broken": False,
                                 "coupled": "", **e.attributes}  # fmt: skip

    def say(self, src: str, body: Any, numbered: bool = False) -> Envelope:
        key = f"{src}/event" if numbered else src
        self.seq[key] = self.seq.get(key, 0) + 1
        number = self.seq[key]
        return Envelope(1, "made-up", src, 1, number, f"{src}-1-{number}", self.now_s, body, round=self.round)

    def event(self, src: str, name: str, text: str, /, **data: object) -> Envelope:
        return self.say(src, Event(name, {"text": text, **data}), numbered=True)

    def frame(self, step: int) -> Envelope:
        out = []
        for id_, b in self.bodies.items():
            attributes = {k: b[k] for k in ("effector", "stage", "wet") if k in b}
            out.append(BodyFrame(id_, b["name"], b["kind"], b["place"], float(b["x"]), float(b["y"]), 0.0, attributes,
                                 b["broken"], b["coupled"]))  # fmt: skip
        return self.say("world", Frame(self.now_s, step, tuple(out)))

    def membership(self, step: int) -> Envelope:
        kinds = self.scene.kinds
        robots = {i: [b["place"], b["name"]] for i, b in self.bodies.items() if kinds[b["kind"]].role == "robot"}
        things = {i: {"stage": b["stage"], "wet": b["wet"]} for i, b in self.bodies.items() if i not in robots}
        return self.event("world", "membership", f"step {step} is over", step=step, robots=robots, objects=things)

    def find(self, team: str, name: str) -> dict[str, Any]:
        # A team without lenders takes a guest that nobody gave: its plan goes on without it.
        return next((b for b in self.bodies.values() if b["place"] == team and b["name"] == name), dict(NOBODY))

    def act(self, team: str, action: str) -> None:
        """The action's effect, without asking whether it is possible."""
        name, *args = re.findall(r"\w+", action)
        if name == "lineShift":
            for b in self.bodies.values():
                if b["kind"] == "box" and b["place"] == team:
                    b["x"] = max(b["x"] - 1, 0)
            return
        if name == "takeRobot":
            lent = next((b for b in self.bodies.values() if b["place"] == "bench"), None)
            if lent is not None:
                lent.update(place=team, name=args[0], x=int(args[1]), y=int(args[2]), effector=3)
            return
        robot = self.find(team, args[0])
        mate = next((b for b in self.bodies.values() if b["place"] == team and b["name"] == robot["coupled"]), None)
        match name:
            case "move":
                dx, dy = MOVES[args[1]]
                robot.update(x=robot["x"] + dx, y=robot["y"] + dy)
            case "push" | "pull":
                for b in (robot, mate):
                    if b is not None:
                        b["y"] += 1 if name == "push" else -1
            case "attach" if not robot["broken"]:
                robot["coupled"] = args[1]
                self.find(team, args[1])["coupled"] = args[0]
            case "detach":
                robot["coupled"] = ""
                if mate is not None:
                    mate["coupled"] = ""
            case "swapEndEffector":
                robot["effector"] = int(args[1])
            case "workOn":
                box = self.find(team, args[1])
                box.update(stage=box["stage"] + 1, wet=1 if box["stage"] == 0 else 0, fresh=1)
            case "giveRobot":
                robot["place"] = "bench"
            case "repair":
                robot["broken"] = False


def story(teams: int = 4, steps: int = 27) -> Iterator[Scene | Envelope]:
    """Everything that is said in the made-up run, in order."""
    s = Story(teams)
    names = [w.team for w in s.scene.workspaces]
    plans = {t: plan(i) for i, t in enumerate(names)}
    exchanges = (Exchange("w3", "T2.w3", "T2", 11, "T1", 13, "w2"), Exchange("w1", "T3.w1", "T3", 13, "T4", 18, "w2"))
    exchanges = tuple(e for e in exchanges if e.giver in names and e.taker in names)
    yield s.scene
    for src in ("world", "coordinator", *names):
        yield s.event(src, "started", f"{src} is up", incarnation=1, role=src, recovered=False)
    yield s.event("coordinator", "search_started", "searching for a shared plan: the run begins", epoch=1, step=0)
    yield s.event("coordinator", "shared_plan", f"shared plan of {steps} steps, optimal", epoch=1, start=0,
                  makespan=steps, proof="optimal", exchanges=[])  # fmt: skip
    for t in names:
        yield s.event(t, "plan_adopted", f"{t} adopted its plan", team=t, epoch=1, start=0, makespan=27, role="alone")
    yield s.membership(-1)
    for k in range(steps):
        s.round += 2
        yield s.say("coordinator", Status("coordinator", f"conducting step {k}", k, bound=27, best=27, questions=31,
                                          exchanges=exchanges))  # fmt: skip
        yield s.say("world", Status("world", f"step {k}", k))
        for t in names:
            yield s.say(t, Status("team", f"executing step {k}", k, 0, plans[t]))
            yield s.event("world", "step_started", f"{t} begins step {k}", team=t, step=k, command=f"{t}-1-{k}",
                          actions=list(plans[t][k]))  # fmt: skip
        if k == 16 and teams >= 4:
            s.find("T4", "c1")["broken"] = True
            yield s.event("world", "fault_injected", "T4.c1 breaks", kind="break", target="T4.c1", args={})
        yield s.frame(k)
        s.now_s += PERIOD_S
        s.round += 1
        for b in s.bodies.values():
            if b["kind"] == "box":
                b["wet"] = 0
        for t in names:
            for action in sorted(plans[t][k], key=lambda a: not a.startswith(("giveRobot", "workOn"))):
                s.act(t, action)
            yield s.event("world", "step_ended", f"{t} ends step {k}", team=t, step=k, command=f"{t}-1-{k}", state={})
        yield s.membership(k)
        yield s.frame(k)
        if k == 16 and teams >= 4:
            yield s.event("T4", "discrepancy", "attached(c1) is none, not w1", team="T4", step=k,
                          differing=["attached(c1)"])  # fmt: skip
            yield s.event("T4", "diagnosis", "either c1 is broken or w1 is", team="T4", step=k,
                          causes=[["broken(c1)"], ["broken(w1)"]])  # fmt: skip
            yield s.event("T4", "inspection", "c1 is broken", team="T4", robot="c1", finding="broken")
            yield s.event("T4", "inspection", "w1 is sound", team="T4", robot="w1", finding="sound")
        if k == 17 and teams >= 4:
            yield s.event("T4", "repair", "c1 is whole again", team="T4", robot="c1")
        for src in ("world", "coordinator", *names):
            yield s.say(src, Beat(1000 + len(src), 40 * k, 41 * k, 0, 0, s.seq.get(f"{src}/event", 0), 0.4, "running"))
    if steps == 27:
        for t in names:
            yield s.say(t, Status("team", "finished", steps, 0, plans[t], finished=True))
            yield s.event(t, "team_finished", f"{t} is done", team=t, step=steps)
        yield s.event("coordinator", "run_over", "everybody is done", goal=True, reason="all teams are done",
                      makespan=steps, replans=1)  # fmt: skip


def recording(teams: int = 4, steps: int = 27) -> Recording:
    """The made-up run as a recording that was closed in good order."""
    said = list(story(teams, steps))
    envelopes = [m for m in said if isinstance(m, Envelope)]

    def of(kind: type) -> tuple[Envelope, ...]:
        return tuple(e for e in envelopes if isinstance(e.body, kind))

    events = tuple(sorted(of(Event), key=canonical))
    return Recording("made-up", next(m for m in said if isinstance(m, Scene)), events, of(Frame), of(Status), of(Beat),
                     summary_of(events), complete=True)  # fmt: skip


def summary_of(events: tuple[Envelope, ...]) -> Summary:
    """What a recorder that missed nothing would say."""
    last = Counter((e.src, e.inc) for e in events)
    return Summary("made-up", tuple(SourceCount(s, i, n, n, n) for (s, i), n in sorted(last.items())))

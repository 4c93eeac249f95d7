"""The fault engine: when each disturbance of the script is due, and how the kinds of `bus.faults` are carried out.

Physical ones happen between two periods. Those of processes and links are passed on, at any time: the supervisor has
the processes, each node its own outgoing mail. They are marked as done in the journal before they are passed on, since
one of them may end this very process.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from msgspec import Struct
from msgspec.structs import replace

from bus.faults import KINDS
from bus.messages import Impair, ProcessFault, Value
from bus.node import NoAnswer, Node
from bus.scene import Fault
from world.mishaps import HAPPENS, Outcome
from world.truth import Truth

SUPERVISOR, EVERYBODY = "supervisor", "*"
ANSWER_S = 30.0
"""Wall seconds in which the supervisor has to do what it is asked."""
LARGEST = 1_000_000
"""No number of a disturbance is larger: the world counts ticks by them, and teams plan with them."""


class SavedFaults(Struct):
    """What must survive this process: faults that were done (by their number in the scene), who is to be
    resumed at which tick, which links are bad, and which teams were stopped for good; and the id of the latest request
    for a disturbance of a process or a link."""

    done: list[int] = []
    resumes: list[tuple[int, str]] = []
    links: list[tuple[str, Impair]] = []
    stopped: list[str] = []
    asked: str = ""


class Faults:
    """Works on the truth and through the world's node."""

    def __init__(self, node: Node, truth: Truth, saved: SavedFaults, participants: tuple[str, ...]) -> None:
        self.saved = saved
        self._node, self._truth, self._participants = node, truth, participants
        for source, impair in saved.links:
            if source == node.name:
                node.impair(impair)
        for team in saved.stopped:
            node.give_up(team)

    # ------------------------------------------------------------ when
    def at_step(self, step: int, actions: set[str], team: str = "") -> Iterator[int]:
        """Numbers of the faults that are due when this step begins with these actions (``TEAM.action``): a global step,
        or that of a team, which other teams have nothing to do with."""
        for number, fault in self._open():
            whose = fault.target.partition(".")[0]
            others = team and whose != team and whose in self._truth.layout.spaces
            begins = fault.at_step is not None and fault.at_step <= step and not others
            if begins or (fault.on_action is not None and fault.on_action.replace(" ", "") in actions):
                yield number

    def at_time(self, *, between: bool) -> Iterator[int]:
        """Numbers of the faults that are due now; `between` two periods also the physical ones."""
        for number, fault in self._open():
            due = fault.at_s is not None and self._tick(fault.at_s) <= self._truth.tick
            if due and (between or not physical(fault.kind)):
                yield number

    def next_tick(self, *, between: bool) -> int | None:
        """When something is due by time alone."""
        ticks = [tick for tick, _ in self.saved.resumes]
        for _, fault in self._open():
            if fault.at_s is not None and (between or not physical(fault.kind)):
                ticks.append(self._tick(fault.at_s))
        return min(ticks, default=None)

    def _open(self) -> Iterator[tuple[int, Fault]]:
        return ((n, fault) for n, fault in enumerate(self._truth.scene.faults) if n not in self.saved.done)

    def _tick(self, at_s: float) -> int:
        return round(at_s / self._truth.scene.dt_s)

    # ------------------------------------------------------------ what
    def wrong(self, kind: str, target: str, args: Mapping[str, Value | float]) -> str:
        """Why this cannot be carried out at all; empty if it can."""
        known = KINDS.get(kind)
        if known is None:
            return f"unknown kind {kind!r}. Supported: {', '.join(KINDS)}"
        for name in known.required:
            if name not in args:
                return f"{kind} needs {name}"
        for name, value in args.items():
            if name not in (*known.required, *known.optional):
                taken = ", ".join((*known.required, *known.optional)) or "nothing"
                return f"{kind} does not take {name}; it takes {taken}"
            if isinstance(value, int | float) and not abs(value) <= LARGEST:
                return f"{name} must be a number of at most {LARGEST:,}"
            if name == "share" and not (isinstance(value, int | float) and 0 <= value <= 1):
                return "share must be a number from 0 to 1"
            if name == "for_s" and not (isinstance(value, int | float) and value > 0):
                return "for_s must be seconds, more than 0"
        if kind == "stop" and target not in self._truth.layout.spaces:
            return f"there is no team {target!r}. There are: {', '.join(self._truth.layout.spaces)}"
        if kind == "stop" and self._truth.scene.conducted:
            return "only a team that acts for itself can be stopped for good: here all others would wait for it"
        if kind == "pause" and target == self._node.name:
            return "the world cannot be paused: nobody would wake it, since its time would stand still"
        processes = (self._node.name, *self._participants)
        ends = ends_of(target) if known.on == "link" else (target,)
        for end in ends if known.on in ("link", "process") else ():
            if end not in processes and not (known.on == "link" and end == EVERYBODY):
                return f"there is no process {end!r}. There are: {', '.join(processes)}"
        return ""

    def happen(self, kind: str, target: str, args: Mapping[str, Value | float]) -> Outcome:
        """A physical disturbance, now."""
        return HAPPENS[kind](self._truth, target, args)

    def pass_on(self, kind: str, target: str, args: Mapping[str, Value | float]) -> str:
        """A disturbance of a process or a link; why it came to nothing, or empty."""
        share, for_s = float(args.get("share", 0.0)), float(args.get("for_s", 0.0))
        match kind:
            case "drop" | "repeat" | "delay":
                source, to = ends_of(target)
                sources = (self._node.name, *self._participants) if source == EVERYBODY else (source,)
                for name in sources:
                    self._impair(name, to, kind, share, for_s)
                return ""
            case "kill" | "pause" | "restart" | "stop":
                reason = self._supervise(ProcessFault(kind, target))
                if kind == "stop" and not reason:
                    self.saved.stopped.append(target)
                    self._node.give_up(target)
                return reason
        return f"{kind} is not supported"

    def plan_resume(self, kind: str, target: str, args: Mapping[str, Value | float]) -> None:
        """Who is about to be paused is resumed later."""
        if kind == "pause":
            self.saved.resumes.append((self._truth.tick + self._tick(float(args["for_s"])), target))

    def resume(self) -> bool:
        """Wake those whose pause is over; whether there were any."""
        due = [(tick, name) for tick, name in self.saved.resumes if tick <= self._truth.tick]
        for entry in due:
            self._supervise(ProcessFault("resume", entry[1]))
            self._node.expect(entry[1])
            self.saved.resumes.remove(entry)
        return bool(due)

    def _supervise(self, fault: ProcessFault) -> str:
        try:
            self._node.ask(SUPERVISOR, fault, ANSWER_S)
        except NoAnswer as error:
            return str(error)
        return ""

    def _impair(self, source: str, to: str, kind: str, share: float, for_s: float) -> None:
        """Impairments of the same link add up: a node knows one for each receiver."""
        links = {(name, impair.to): impair for name, impair in self.saved.links}
        before = links.get((source, to)) or Impair(to, seed=self._truth.scene.seed)
        match kind:
            case "drop":
                now = replace(before, drop=share)
            case "repeat":
                now = replace(before, repeat=share)
            case _:
                now = replace(before, late=share, late_s=for_s)
        links[source, to] = now
        self.saved.links = [(name, impair) for (name, _), impair in links.items()]
        if source == self._node.name:
            self._node.impair(now)
        else:
            self._node.request(source, now)


def physical(kind: str) -> bool:
    return kind in HAPPENS


def ends_of(link: str) -> tuple[str, str]:
    """``T1`` is all that T1 sends, ``T1->T2`` or ``T1>T2`` what it sends to T2."""
    source, _, to = link.replace("->", ">").partition(">")
    return source.strip(), to.strip() or EVERYBODY

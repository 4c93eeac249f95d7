"""The protocol of help: whatever is lost, comes twice or late, and whoever dies or is out of contact, robots come home
and nobody waits for ever."""

from __future__ import annotations

import random
from collections.abc import Callable

from hypothesis import given, settings
from hypothesis import strategies as st

from agents.autonomous import hearing, helping
from agents.autonomous.helping import Help
from bus.messages import Body, HelpAnswer, HelpCall, HelpSettled, HelpStands, RobotSent

TEAMS = ("a", "b", "c")
Mail = tuple[str, str, str, Body, str]
"""From, to, the request's id, the body, and what it is the reply to (or empty)."""


class Team:
    """One team: its state survives it; replies that it has given, too. What it waits for does not."""

    def __init__(self, name: str, house: House) -> None:
        self.name, self.house = name, house
        self.help = Help()
        self.replies: dict[tuple[str, str], Body] = {}
        self.robot = name
        """Where its robot is: a team, or on the way."""
        self.needs = 0

    def send(self) -> list[Mail]:
        """Everything that is still to be told, again."""
        told = helping.pending(self.name, self.name, self.help)
        return [(self.name, to, request, body, "") for request, (to, body) in told.items()]

    def hear(self, source: str, request: str, body: Body, re: str) -> Mail | None:
        if re:
            self._replied(source, re, body)
            return None
        if (source, request) not in self.replies:
            self.replies[source, request] = self._asked(source, body)
        return (self.name, source, f"re.{request}", self.replies[source, request], request)

    def _asked(self, source: str, body: Body) -> Body:
        reply: Body
        match body:
            case HelpCall():
                able = source not in self.house.lost and (self.robot == self.name or body.kind == "offer")
                answer = HelpAnswer(body.number, able and (body.kind == "want" or self.needs > 0), self.name)
                self.help, reply = hearing.heard_call(self.name, self.help, source, body, answer)
            case HelpSettled():
                self.help, reply = hearing.heard_settled(self.name, self.help, source, body)
            case RobotSent():
                self.help, reply = hearing.heard_sent(self.help, source, body)
            case _:
                raise AssertionError(body)
        return reply

    def _replied(self, source: str, request: str, body: Body) -> None:
        told = helping.pending(self.name, self.name, self.help)
        if request not in told:
            return  # nobody waits for it any more
        if isinstance(body, HelpAnswer):
            self.help = hearing.heard_answer(self.name, self.help, source, body)
        elif isinstance(body, HelpStands):
            self.help = hearing.heard_stands(self.help, source, told[request][1], body)

    def act(self) -> None:
        """What the team does itself when nothing is under way."""
        help_, house = self.help, self.house
        match help_.phase:
            case "none" | "refused" if self.needs:
                kind = "want" if help_.kind != "want" or help_.phase == "none" else "offer"
                peers = [t for t in TEAMS if t != self.name and t not in house.lost]
                self.help = helping.call(self.name, help_, kind, 5, False, "", peers)  # type: ignore[arg-type]
            case "called" if self.robot == self.name:
                self.robot = f"to {help_.partner}"
                self.help = helping.left(helping.chosen(help_, f"{self.name}.r", "r"))
            case "underway" if house[help_.partner].robot == f"to {self.name}":
                house[help_.partner].robot = self.name
                self.help = helping.came(help_)
            case "here":
                self.needs -= self.needs > 0
                house[help_.partner].robot = f"to {help_.partner}"
                self.help = helping.left(help_)
            case "coming" if not self.needs:
                self.help = helping.withdraw(help_)
            case "homing" if self.robot.startswith("to "):
                self.robot = self.name
                self.help = helping.home(help_)


class House:
    """Teams and the mail between them, which may be lost, repeated and reordered."""

    def __init__(self, dice: random.Random, loss: float) -> None:
        self.teams = {name: Team(name, self) for name in TEAMS}
        self.mail: list[Mail] = []
        self.lost: set[str] = set()
        self.dice, self.loss = dice, loss

    def __getitem__(self, name: str) -> Team:
        return self.teams[name]

    def post(self, mail: list[Mail]) -> None:
        for one in mail:
            self.mail += [one] * self.dice.choice((0, 1, 2) if self.dice.random() < self.loss else (1,))

    def turn(self) -> None:
        """One thing happens."""
        name = self.dice.choice([n for n in TEAMS if n not in self.lost] or list(TEAMS))
        what = self.dice.random()
        if what < 0.3:
            self.post(self[name].send())
        elif what < 0.5 and name not in self.lost:
            self[name].act()
        elif self.mail:
            source, to, request, body, re = self.mail.pop(self.dice.randrange(len(self.mail)))
            reply = self[to].hear(source, request, body, re) if to not in self.lost else None
            self.post([reply] if reply is not None else [])

    def lose(self, name: str) -> None:
        self.lost.add(name)
        for team in self.teams.values():
            if team.name != name:
                team.help = hearing.lost(team.name, team.help, name)

    def check(self) -> None:
        """At no time do two teams count on the same robot, nor has anybody two partners."""
        askers = [t for t in self.teams.values() if t.help.phase in ("underway", "here")]
        robots = [t.help.robot for t in askers]
        assert len(robots) == len(set(robots))
        for team in askers:
            if team.help.phase == "here":
                assert self[team.help.partner].robot == team.name

    def until(self, condition: Callable[[], bool], turns: int = 6000) -> None:
        for _ in range(turns):
            if condition():
                return
            self.turn()
            self.check()
        raise AssertionError([(t.name, t.needs, t.robot, t.help) for t in self.teams.values()])

    def quiet(self) -> bool:
        return all(
            t.help.phase in ("none", "refused") and not t.help.off and t.robot == t.name and not t.needs
            for t in self.teams.values()
        )


@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 2**32), needs=st.tuples(*[st.integers(0, 2)] * 3), loss=st.sampled_from([0.0, 0.3, 0.6]))
def test_everybody_is_helped_and_every_robot_comes_home(seed: int, needs: tuple[int, ...], loss: float) -> None:
    house = House(random.Random(seed), loss)
    for name, number in zip(TEAMS, needs, strict=True):
        house[name].needs = number
    house.until(house.quiet)


@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 2**32), needs=st.tuples(*[st.integers(0, 1)] * 3), at=st.integers(0, 150))
def test_who_is_out_of_contact_for_a_while_holds_nobody_up(seed: int, needs: tuple[int, ...], at: int) -> None:
    house = House(random.Random(seed), 0.3)
    for name, number in zip(TEAMS, needs, strict=True):
        house[name].needs = number
    for _ in range(at):
        house.turn()
        house.check()
    gone = house.dice.choice(TEAMS)
    house.lose(gone)
    for _ in range(200):
        house.turn()
        house.check()
    others = [house[name] for name in TEAMS if name != gone]
    for team in others:  # who is engaged with the one that is lost has a robot there, or of it
        if team.help.partner == gone:
            assert team.help.phase in ("sending", "lent", "homing", "underway", "here", "returning")
    house.lost.clear()
    house.until(house.quiet)


def test_of_two_who_call_at_the_same_time_the_first_by_name_is_heard() -> None:
    first = helping.call("a", Help(), "want", 5, True, "to carry", ["b"])
    second = helping.call("b", Help(), "want", 5, True, "to carry", ["a"])
    yes = HelpAnswer(1, True, "room")
    _, answer = hearing.heard_call("a", first, "b", HelpCall(1, "want", 5, "room"), yes)
    assert not answer.yes
    assert answer.later
    promised, answer = hearing.heard_call("b", second, "a", HelpCall(1, "want", 5, "room"), yes)
    assert answer.yes
    assert promised.phase == "promised"
    assert promised.off == (("a", "b", 1),)

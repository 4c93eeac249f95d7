"""The protocol of help: whatever is lost, comes twice or late, and whoever dies or is out of contact, robots come home
and nobody waits for ever."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agents.autonomous import hearing, helping
from agents.autonomous.helping import Help
from bus.codec import Refusal, decode, encode
from bus.messages import Body, Envelope, HelpAnswer, HelpCall, HelpSettled, HelpStands, RobotSent

LONG, LONGER = "l" * 30, "l" * 31
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
        self.waited = 0
        """So often it has waited for an asker that is out of contact."""

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
        house = self.house
        for gone in sorted(house.lost):
            self.help = hearing.lost(self.name, self.help, gone)
        help_ = self.help
        self.waited = self.waited + 1 if help_.partner in house.lost else 0
        match help_.phase:
            case "sending" | "lent" if self.waited > help_.term_units:
                self.help = helping.recalled(help_)
            case "recalling" if self.robot != f"to {self.name}":
                self.robot = f"to {self.name}"
            case "recalling":
                self.help = helping.came(help_)
            case "here" if house[help_.partner].robot != self.name:
                self.help = helping.missed(help_)
            case "none" | "refused" if self.needs:
                kind = "want" if help_.kind != "want" or help_.phase == "none" else "offer"
                peers = [t for t in TEAMS if t != self.name and t not in house.lost]
                self.help = helping.call(self.name, help_, kind, 5, False, "", peers)  # type: ignore[arg-type]
            case "called" | "here" if house.dice.random() < 0.1:  # the robot broke
                self.help = helping.withdraw(help_)
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
        """At no time do two teams count on the same robot, nor has anybody two partners. Whose guest was called home
        is told so."""
        told = {(to, caller, call) for t in self.teams.values() for to, caller, call in t.help.off}
        askers = [t for t in self.teams.values() if t.help.phase in ("underway", "here")]
        askers = [t for t in askers if (t.name, t.help.caller, t.help.call) not in told]
        robots = [t.help.robot for t in askers]
        assert len(robots) == len(set(robots))
        for team in askers:
            if team.help.phase == "here":
                assert self[team.help.partner].robot == team.name

    def until(self, condition: Callable[[], bool], turns: int = 30_000) -> None:
        for _ in range(turns):
            if condition():
                return
            self.turn()
            self.check()
        raise AssertionError([(t.name, t.needs, t.robot, t.help) for t in self.teams.values()])

    def quiet(self, but: str = "") -> bool:
        """Is everybody home, but for who is dead?"""
        return all(
            t.help.phase in ("none", "refused")
            and not [to for to, _, _ in t.help.off if to != but]
            and t.robot == t.name
            and not t.needs
            for t in self.teams.values()
            if t.name != but
        )


@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 2**32), needs=st.tuples(*[st.integers(0, 2)] * 3), loss=st.sampled_from([0.0, 0.3, 0.6]))
def test_everybody_is_helped_and_every_robot_comes_home(seed: int, needs: tuple[int, ...], loss: float) -> None:
    house = House(random.Random(seed), loss)
    for name, number in zip(TEAMS, needs, strict=True):
        house[name].needs = number
    house.until(house.quiet)


def bereft(seed: int, needs: tuple[int, ...], at: int) -> tuple[House, str]:
    """A house that has lost contact with one of its teams after so many turns, and which."""
    house = House(random.Random(seed), 0.3)
    for name, number in zip(TEAMS, needs, strict=True):
        house[name].needs = number
    for _ in range(at):
        house.turn()
        house.check()
    gone = house.dice.choice(TEAMS)
    house.lose(gone)
    return house, gone


@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 2**32), needs=st.tuples(*[st.integers(0, 1)] * 3), at=st.integers(0, 150))
def test_who_is_out_of_contact_for_a_while_holds_nobody_up(seed: int, needs: tuple[int, ...], at: int) -> None:
    house, gone = bereft(seed, needs, at)
    for _ in range(200):
        house.turn()
        house.check()
    others = [house[name] for name in TEAMS if name != gone]
    for team in others:  # who is engaged with the one that is lost has a robot there, or of it
        if team.help.partner == gone:
            assert team.help.phase in ("sending", "lent", "recalling", "homing", "underway", "here")
    house.lost.clear()
    house.until(house.quiet)


@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 2**32), needs=st.tuples(*[st.integers(0, 2)] * 3), at=st.integers(0, 150))
def test_who_dies_for_good_keeps_nobodys_robot(seed: int, needs: tuple[int, ...], at: int) -> None:
    house, gone = bereft(seed, needs, at)
    house.until(lambda: house.quiet(but=gone))


def test_a_robot_stays_with_who_is_out_of_contact_as_long_as_it_was_to_stay() -> None:
    lent = Help(phase="lent", kind="want", units=7, caller="b", call=3, partner="b", robot="a.r", name="r")
    assert lent.term_units == 7
    assert Help(phase="lent", units=1).term_units == helping.LEAST_TERM_UNITS
    home = helping.recalled(lent)
    assert (home.phase, home.off) == ("recalling", (("b", "b", 3),))
    told, reply = hearing.heard_settled("b", Help(phase="here", caller="b", call=3, partner="a"), "a", _off(home))
    assert (told, reply) == (Help(), HelpStands(False))
    assert hearing.heard_sent(home, "b", RobotSent("b", 3, "a.r", "r", True))[0].phase == "homing"
    assert helping.came(home).phase == "homing"


def _off(help_: Help) -> Body:
    (body,) = [body for _, body in helping.pending("a", "room", help_).values()]
    return body


def test_a_helper_that_was_away_hears_that_its_robot_was_sent_back() -> None:
    sent_back = hearing.lost("b", Help(phase="returning", caller="b", call=3, partner="a"), "a")
    assert (sent_back.phase, sent_back.off) == ("none", (("a", "b", 3),))
    lent = Help(phase="lent", caller="b", call=3, partner="b", robot="a.r", name="r")
    home, reply = hearing.heard_settled("a", lent, "b", HelpSettled("b", 3, False))
    assert (home.phase, home.off, reply) == ("recalling", (), HelpStands(False))


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


@pytest.mark.parametrize(
    "help_",
    [
        Help("calling", 10**6, asked=(LONG,), caller=LONGER),
        Help("confirming", 10**6, caller=LONGER, call=10**6, partner=LONG),
        Help("sending", caller=LONG, call=10**6, partner=LONG, robot="a.r1", name="r1"),
        Help("returning", caller=LONG, call=10**6, partner=LONG, robot="a.r1", name="r1"),
        Help(off=((LONG, LONGER, 10**6),)),
    ],
    ids=lambda help_: help_.phase,
)
def test_teams_may_have_long_names(help_: Help) -> None:
    """What they tell one another is no message if its id is too long: they would wait for ever."""
    ((request, (_, body)),) = helping.pending(LONGER, "a", help_).items()
    for name, re in ((request, ""), (f"re.{request}", request)):
        sent = Envelope(1, "r", LONGER, 1, 1, name, 0.0, body, re)  # type: ignore[arg-type]
        assert decode(encode(sent)) == sent


def test_each_engagement_has_an_id_of_its_own() -> None:
    off = (("T11", "T1", 12), ("T11", "T11", 2))
    assert {body for _, body in helping.pending("T1", "a", Help(off=off)).values()} == {
        HelpSettled("T1", 12, False),
        HelpSettled("T11", 2, False),
    }


@pytest.mark.parametrize("body", [HelpCall(1, "offer", 2**40, "hall"), HelpAnswer(1, True, "hall", 2**40)])
def test_nobody_plans_with_more_time_than_a_planner_can_count(body: Body) -> None:
    refusal = decode(encode(Envelope(1, "r", "a", 1, 1, "a.1", 0.0, body)))  # type: ignore[arg-type]
    assert isinstance(refusal, Refusal)
    assert refusal.reason == "invalid"


def test_a_newer_call_of_the_same_team_makes_its_older_one_void() -> None:
    yes = HelpAnswer(1, True, "room")
    promised, _ = hearing.heard_call("b", Help(), "a", HelpCall(1, "want", 5, "room"), yes)
    again, answer = hearing.heard_call("b", promised, "a", HelpCall(2, "offer", 7, "room"), yes)
    assert answer.yes
    assert (again.phase, again.call, again.kind, again.units) == ("promised", 2, "offer", 7)


def test_what_is_settled_stays_so_when_an_older_word_comes_late() -> None:
    later, _ = hearing.heard_settled("b", Help(), "a", HelpSettled("a", 5, False))
    late, _ = hearing.heard_settled("b", later, "a", HelpSettled("a", 3, False))
    assert late.settled == {"a": 5}
    for number, heard in ((5, False), (6, True)):
        _, answer = hearing.heard_call("b", late, "a", HelpCall(number, "want", 5, "room"), HelpAnswer(1, True, "room"))
        assert answer.yes is heard

"""A team's mind, message by message. The coordinator is played by the test, the world is a made-up one."""

from __future__ import annotations

from typing import Any

import pytest
from msgspec.structs import replace

from agents.team import Team
from bus import messages as m
from bus.messages import Envelope
from tests.agents.conftest import MakeSystem
from tests.agents.rooms import ALONE, LENDER, PAINTER
from tests.agents.together import System

COORDINATOR, T1 = "coordinator", "T1"


class Stage:
    """One team and a coordinator that the test speaks for."""

    def __init__(self, make_system: MakeSystem, room: Any = ALONE) -> None:
        self.system: System = make_system({T1: room}, puppets=(COORDINATOR, "mallory"))
        self.system.tick()

    @property
    def team(self) -> Team:
        mind = self.system[T1].mind
        assert isinstance(mind, Team)
        return mind

    def ask(self, body: m.Body) -> Any:
        """The team's answer to the coordinator."""
        request = self.system.send(COORDINATOR, T1, body)
        return self.answer(request)

    def answer(self, request: str) -> Any:
        mail = self.system.puppet(COORDINATOR).mail
        self.system.until(lambda: any(e.re == request for e in mail))
        return next(e.body for e in mail if e.re == request)

    def begin(self, epoch: int = 1, within: int = 4, start: int = 0) -> None:
        self.ask(m.Enquire(epoch))
        adopted = self.ask(m.Adopt(epoch, start, m.Question("alone", within)))
        assert adopted.ok, adopted.reason

    @property
    def done(self) -> dict[tuple[str, int], int]:
        return self.system.world.done


@pytest.fixture
def stage(make_system: MakeSystem) -> Stage:
    return Stage(make_system)


def test_a_standing_says_what_is_seen(stage: Stage) -> None:
    standing = stage.ask(m.Enquire(1))
    assert standing == m.Standing(1, T1, 0, False, 3)
    assert stage.team.mind.memory.observed == ALONE


def test_a_team_that_is_done_says_so(make_system: MakeSystem) -> None:
    stage = Stage(make_system, ALONE | {"stage(1)": 3, "line(1)": 0})
    standing = stage.ask(m.Enquire(1))
    assert (standing.finished, standing.lower_bound) == (True, 0)
    assert stage.ask(m.Ask(1, m.Question("alone", 0))).verdict == "yes"


def test_steps_are_taken_and_the_last_one_finishes(stage: Stage) -> None:
    stage.begin()
    outcomes = [stage.ask(m.Go(1, step)).outcome for step in range(4)]
    assert outcomes == ["as_planned"] * 3 + ["finished"]
    assert stage.ask(m.Go(1, 4)).outcome == "finished", "with nothing left to do"
    assert stage.system.world.finished()


def test_a_step_is_taken_once_whoever_asks_for_it_again(stage: Stage) -> None:
    stage.begin()
    first = stage.ask(m.Go(1, 0))
    assert stage.ask(m.Go(1, 0)) == first, "as a coordinator that came back would ask, with an id of its own"
    stage.system.restart(T1)
    assert stage.ask(m.Go(1, 0)) == first
    assert stage.done[T1, 0] == 1


def test_a_step_under_way_survives_its_team(stage: Stage) -> None:
    """The command's id is the step's own, so the world answers to the next life what it did for the one before."""
    stage.begin()
    stage.system["world"].asleep = True
    request = stage.system.send(COORDINATOR, T1, m.Go(1, 0))
    stage.system.until(lambda: stage.team.mind.memory.begun is not None)
    stage.system.restart(T1)
    assert stage.team.mind.memory.begun is not None
    stage.system["world"].asleep = False
    assert stage.answer(request).outcome == "as_planned"
    assert stage.done[T1, 0] == 1


def test_an_enquiry_waits_for_the_end_of_the_step(stage: Stage) -> None:
    stage.begin()
    stage.system["world"].asleep = True
    stage.system.send(COORDINATOR, T1, m.Go(1, 0))
    stage.system.until(lambda: stage.team.mind.memory.begun is not None)
    request = stage.system.send(COORDINATOR, T1, m.Enquire(2))
    for _ in range(5):
        stage.system.tick()
    stage.system["world"].asleep = False
    standing = stage.answer(request)
    assert (standing.epoch, standing.step) == (2, 1)
    assert standing.offer == m.Offer(m.Question("alone", 3))


def test_what_is_refuted_is_offered_with_the_rest_of_the_plan(stage: Stage) -> None:
    stage.ask(m.Enquire(1))
    assert stage.ask(m.Ask(1, m.Question("alone", 3))).verdict == "no"
    assert stage.ask(m.Adopt(1, 0, m.Question("alone", 4))).ok
    stage.ask(m.Go(1, 0))
    standing = stage.ask(m.Enquire(2))
    assert standing.offer == m.Offer(m.Question("alone", 3), (m.Question("alone", 2),))


def test_a_plan_that_starts_later_than_the_team_would_is_offered_as_it_is(stage: Stage) -> None:
    """The others are at step 6 already; a new epoch begins before the first step."""
    stage.ask(m.Enquire(1))
    stage.ask(m.Ask(1, m.Question("alone", 3)))
    assert stage.ask(m.Adopt(1, 6, m.Question("alone", 4))).ok
    standing = stage.ask(m.Enquire(2))
    assert standing.step == 6
    assert standing.offer == m.Offer(m.Question("alone", 4), (m.Question("alone", 3),))


@pytest.mark.parametrize("body", [m.Ask(1, m.Question("alone", 9)), m.Adopt(1, 0, m.Question("alone", 9)), m.Go(1, 0)])
def test_what_belongs_to_another_epoch_changes_nothing(stage: Stage, body: m.Body) -> None:
    stage.begin(1)
    stage.ask(m.Enquire(2))
    before = stage.team.mind.memory
    told = stage.ask(body)
    assert told.epoch == 2
    assert getattr(told, "verdict", "unknown") == "unknown"
    assert not getattr(told, "ok", False)
    assert getattr(told, "outcome", "refused") == "refused"
    assert stage.team.mind.memory == before
    assert not stage.done


def test_an_enquiry_that_comes_late_does_not_lead_back(stage: Stage) -> None:
    stage.begin(5)
    assert stage.ask(m.Enquire(3)).epoch == 5
    assert stage.team.mind.memory.epoch == 5
    assert stage.ask(m.Go(5, 0)).outcome == "as_planned"


def test_of_two_enquiries_the_later_epoch_is_answered(stage: Stage) -> None:
    stage.begin(1)
    stage.system["world"].asleep = True
    newer = stage.system.send(COORDINATOR, T1, m.Enquire(7))
    older = stage.system.send(COORDINATOR, T1, m.Enquire(6))
    for _ in range(5):
        stage.system.tick()
    stage.system["world"].asleep = False
    assert stage.answer(newer) == m.Standing(7, T1, 0, False, 3, stage.answer(newer).offer)
    assert stage.answer(older).epoch == 7


def test_a_look_from_before_a_step_is_not_taken_for_one_after_it(stage: Stage) -> None:
    """The enquiry's look is under way when a step of the old epoch comes after all."""
    stage.begin(1)
    stage.system["world"].asleep = True
    request = stage.system.send(COORDINATOR, T1, m.Enquire(2))
    stage.system.until(lambda: stage.team.answering._look != "T1.1.1")
    looked = stage.team.answering._look
    stage.system.send(COORDINATOR, T1, m.Go(1, 0))
    stage.system.until(lambda: stage.team.mind.memory.begun is not None)
    stage.system["world"].asleep = False
    standing = stage.answer(request)
    assert stage.team.answering._look != looked
    assert (standing.step, standing.offer.question.within) == (1, 3)


def test_the_plan_is_searched_again_after_a_restart(stage: Stage) -> None:
    stage.ask(m.Enquire(1))
    assert stage.ask(m.Ask(1, m.Question("alone", 6))).verdict == "yes"
    stage.system.restart(T1)
    assert stage.ask(m.Adopt(1, 0, m.Question("alone", 6))).ok
    stage.system.restart(T1)
    assert stage.ask(m.Go(1, 0)).outcome == "as_planned"


def test_a_lender_names_the_robot_as_it_was_built(make_system: MakeSystem) -> None:
    stage = Stage(make_system, LENDER)
    stage.ask(m.Enquire(1))
    adopted = stage.ask(m.Adopt(1, 3, m.Question("lend", 5, 0)))
    assert adopted.gave == (m.Hand("worker", 3, "w2", "T1.w2"),)
    stage.ask(m.Go(1, 3))
    assert stage.ask(m.Enquire(2)).gave == (m.Handover("T1.w2", 3, "worker"),)


GIVEN = (("move(w1,right)",), ("workOn(w1,1)",))


def test_a_given_plan_that_ends_too_early_is_not_finished(stage: Stage) -> None:
    stage.ask(m.Enquire(1))
    assert stage.ask(m.Adopt(1, 0, m.Question("alone", 2), "", GIVEN)).makespan == 2
    assert [stage.ask(m.Go(1, step)).outcome for step in range(3)] == ["as_planned", "as_planned", "refused"]
    standing = stage.ask(m.Enquire(2))
    assert (standing.finished, standing.offer, standing.step) == (False, None, 3)
    assert not stage.system.said("team_finished")


def test_an_inspection_is_a_step_and_tells_what_was_found(make_system: MakeSystem) -> None:
    stage = Stage(make_system, PAINTER | {"at(c1)": "(2,2)", "attached(c1)": "none"})
    stage.begin(within=20)
    stage.team.mind.keep(replace(stage.team.mind.memory, open=(blamed("c1"), blamed("w1"))))
    assert set(stage.ask(m.Enquire(2)).inspect) == {"c1", "w1"}
    result = stage.ask(m.Go(2, 0, recover=True))
    assert (result.outcome, result.inspect) == ("recovered", ())
    assert len(stage.system.said("inspection")) == 1
    assert stage.ask(m.Go(2, 1, recover=True)).outcome == "as_planned", "nobody is suspected any more"


def blamed(robot: str) -> m.Diagnosis:
    return m.Diagnosis((f"broken({robot})",))


@pytest.mark.parametrize("body", [m.Enquire(9), m.Ask(1, m.Question("alone", 4)), m.Go(1, 0)])
def test_only_the_coordinator_commands(stage: Stage, body: m.Body) -> None:
    stage.begin()
    before = stage.team.mind.memory
    request = stage.system.send("mallory", T1, body)
    stage.system.until(lambda: stage.system.puppet("mallory").mail)
    (answer,) = stage.system.puppet("mallory").mail
    assert isinstance(answer, Envelope)
    assert (answer.re, answer.body) == (request, m.Ok())
    assert stage.team.mind.memory == before
    assert stage.team.mind.node.post.inbox.refused == {"not_yours": 1}
    assert not stage.done


def test_an_order_is_told_apart_from_a_discrepancy(stage: Stage) -> None:
    stage.begin()
    now = stage.system.world.floors[T1]
    now.line[2], now.stage[2] = 3, 0
    result = stage.ask(m.Go(1, 0))
    assert (result.outcome, result.diagnoses) == ("order_changed", ())
    assert stage.ask(m.Enquire(2)).offer is None

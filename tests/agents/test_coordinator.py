"""The coordinator, message by message. The teams are played by the test."""

from __future__ import annotations

import pytest

from agents.setups import GivenPlan
from bus import messages as m
from tests.agents.conducting import T1, T2, Stage
from tests.agents.conftest import MakeSystem


@pytest.fixture
def stage(make_system: MakeSystem) -> Stage:
    return Stage(make_system)


PHASES = ["enquiring", "asking", "adopting", "stepping", "recovering"]


@pytest.mark.parametrize("phase", PHASES)
def test_who_is_lost_is_not_waited_for(stage: Stage, phase: str) -> None:
    stage.to(phase)
    epoch = stage.epoch
    if phase == "recovering":
        assert stage.hear(T1, m.Go).body.recover
        lost, other = T1, T2
    else:
        lost, other = T2, T1
    stage.contact(lost, "lost_contact")
    if phase == "stepping":
        stage.steps(other)
    stage.offers(other, step=stage.system.coordinator.steps.step)
    assert stage.epoch == epoch + 1
    stage.adopts(other)
    assert stage.hear(other, m.Go).body.epoch == stage.epoch
    assert not [e for e in stage.system.puppet(lost).mail if getattr(e.body, "epoch", 0) == stage.epoch]


@pytest.mark.parametrize("phase", PHASES)
def test_a_coordinator_that_comes_back_asks_everybody_in_a_new_epoch(stage: Stage, phase: str) -> None:
    stage.to(phase)
    epoch = stage.epoch
    stage.system.restart("coordinator")
    assert stage.epoch == epoch + 1
    for team in (T1, T2):
        stage.offers(team, step=1)
    stage.adopts(T1)
    stage.adopts(T2)
    assert stage.hear(T1, m.Go).body.step == 1


@pytest.mark.parametrize("phase", PHASES)
def test_an_order_that_changes_begins_a_new_epoch_between_two_steps(stage: Stage, phase: str) -> None:
    stage.to(phase)
    epoch = stage.epoch
    stage.system["world"].node.request("coordinator", m.Order(T1, ("2",)))  # type: ignore[union-attr]
    stage.system.tick()
    if phase == "recovering":
        stage.steps(T1, "recovered")
    elif phase == "stepping":
        stage.steps(T2)
        assert stage.epoch == epoch, "a step is never cut short"
        stage.steps(T1)
    else:
        stage.system.until(lambda: stage.epoch > epoch)
    assert (stage.epoch, stage.system.coordinator.phase) == (epoch + 1, "enquiring")


def test_who_was_lost_is_not_asked_by_the_next_life_either(stage: Stage) -> None:
    """The world tells once; what it told must not die with who was told."""
    stage.contact(T2, "lost_contact")
    stage.system.restart("coordinator")
    stage.offers(T1)
    stage.adopts(T1)
    stage.contact(T2, "back")
    stage.steps(T1)
    stage.offers(T2)
    assert stage.system.coordinator.members.live == {T1, T2}


def test_a_suspect_whose_team_is_lost_holds_nobody_up(stage: Stage) -> None:
    stage.to("stepping")
    stage.steps(T1, "discrepancy", inspect=("w1",))
    stage.contact(T1, "lost_contact")
    stage.steps(T2)
    stage.offers(T2, step=1)
    stage.adopts(T2)
    stage.steps(T2)
    stage.contact(T1, "back")
    stage.steps(T2)
    stage.stands(T1, inspect=("w1",))
    stage.offers(T2, step=3)
    go = stage.hear(T1, m.Go).body
    assert (go.recover, go.step) == (True, 3), "the inspection is made up for"


def test_answers_to_questions_of_the_past_change_nothing(stage: Stage) -> None:
    old = stage.hear(T1, m.Enquire)
    stage.system.restart("coordinator")
    stage.system.tick()
    stage.reply(T1, old, m.Standing(1, T1, 7, True, 0))
    stage.offers(T1)
    stage.offers(T2)
    assert stage.system.coordinator.steps.step == 0
    assert stage.system.coordinator.phase == "adopting"


@pytest.mark.parametrize("phase", ["enquiring", "asking", "adopting"])
def test_a_team_in_a_later_epoch_is_followed_there(stage: Stage, phase: str) -> None:
    """The coordinator's diary was lost, or somebody made the team believe something."""
    stage.to(phase)
    kind = {"enquiring": m.Enquire, "asking": m.Ask, "adopting": m.Adopt}[phase]
    asked = stage.hear(T1, kind)
    told = {
        "enquiring": m.Standing(40, T1, 0, False, 0),
        "asking": m.Answer(40, m.Question("alone", 4), "unknown"),
        "adopting": m.Adopted(40, T1, False),
    }[phase]
    stage.reply(T1, asked, told)
    assert (stage.epoch, stage.system.coordinator.phase) == (41, "enquiring")


def test_a_step_that_is_refused_begins_a_new_epoch(stage: Stage) -> None:
    stage.to("stepping")
    stage.steps(T1, "refused", reason="its plan is over")
    stage.steps(T2)
    stage.offers(T1, step=0)
    stage.offers(T2, step=1)
    assert stage.epoch == 2
    assert stage.system.coordinator.cause == "T1 left its course"


def test_a_plan_that_nobody_can_adopt_is_not_searched_for_ever(stage: Stage) -> None:
    for _ in range(3):
        stage.offers(T1)
        stage.offers(T2)
        stage.adopts(T1)
        stage.adopts(T2, ok=False, reason="step 3: the checker objects")
    stage.system.until(lambda: stage.system.over)
    over = stage.system.over
    assert over is not None
    assert not over.goal
    assert over.reason == "no plan: T2 cannot adopt its plan: step 3: the checker objects"
    (needed,) = stage.system.said("needs_person")
    assert needed["cause"] == "plan_refused"
    assert over.reason in str(needed["text"])


def test_refusals_of_a_plan_count_from_the_last_one_that_was_adopted(stage: Stage) -> None:
    def refuse() -> None:
        stage.offers(T1)
        stage.offers(T2)
        stage.adopts(T1)
        stage.adopts(T2, ok=False, reason="step 3: the checker objects")

    refuse()
    refuse()
    stage.to("stepping")
    stage.steps(T1, "refused", reason="its plan is over")
    stage.steps(T2)
    refuse()
    refuse()
    assert stage.system.coordinator.phase == "enquiring"
    assert stage.system.over is None


def test_a_given_plan_that_cannot_be_adopted_is_tried_once(make_system: MakeSystem) -> None:
    stage = Stage(make_system, plan=GivenPlan({T1: (("lineShift",),), T2: (("lineShift",),)}))
    stage.stands(T1)
    stage.stands(T2)
    assert stage.hear(T1, m.Adopt).body.plan
    stage.adopts(T2, ok=False)
    stage.offers(T1)
    stage.offers(T2)
    assert not stage.hear(T1, m.Adopt).body.plan


def test_the_run_is_over_when_all_are_found_finished(stage: Stage) -> None:
    stage.to("stepping")
    stage.system.restart("coordinator")
    for team in (T1, T2):
        stage.stands(team, finished=True, lower_bound=0, step=4)
    stage.system.until(lambda: stage.system.over)
    assert stage.system.over == m.RunOver(True, "every team has reached its goal", 4, 0)


def test_teams_that_have_nothing_to_do_from_the_start_agree_on_that(stage: Stage) -> None:
    """A run has a plan before it is over, be it an empty one."""
    for team in (T1, T2):
        stage.stands(team, finished=True, lower_bound=0)
    assert stage.hear(T1, m.Ask).body.question.kind == "alone"
    assert not stage.system.said("run_over")


def test_who_thinks_about_a_question_is_not_asked_again(stage: Stage) -> None:
    stage.to("asking")
    asked = stage.hear(T1, m.Ask)
    stage.reply(T1, asked, m.Answer(stage.epoch, asked.body.question, "no"))
    stage.hear(T1, m.Ask)
    assert len([e for e in stage.system.puppet(T2).mail if isinstance(e.body, m.Ask)]) == 1


def test_after_inspections_a_new_epoch_begins_whatever_they_found(stage: Stage) -> None:
    stage.stands(T1, inspect=("w1",))
    stage.stands(T2)
    assert stage.system.coordinator.phase == "recovering"
    epoch = stage.epoch
    stage.steps(T1, "as_planned")
    assert (stage.epoch, stage.system.coordinator.phase) == (epoch + 1, "enquiring")


def test_the_last_word_is_said_again_by_the_next_life_and_recorded_once(stage: Stage) -> None:
    stage.stands(T1, hopeless="no worker", hopeless_with_guest="no line")
    stage.system["supervisor"].asleep = True
    stage.stands(T2)
    stage.system.until(lambda: stage.system.said("run_over"))
    stage.system.restart("coordinator")
    stage.system["supervisor"].asleep = False
    stage.system.until(lambda: stage.system.over)
    assert stage.system.over is not None
    assert stage.system.over.reason.startswith("no plan: T1 can never finish alone")
    assert [needed["cause"] for needed in stage.system.said("needs_person")] == ["no_plan"]
    assert len(stage.system.said("run_over")) == 1


@pytest.mark.parametrize(
    "body", [m.Contact(T2, "lost_contact"), m.Order(T1, ("9",)), m.Go(1, 0), m.RunOver(True, "", 0, 0)]
)
def test_only_the_world_tells_news(make_system: MakeSystem, body: m.Body) -> None:
    stage = Stage(make_system)
    stage.to("asking")
    before = stage.system.coordinator.diary
    stage.system.send(T1, "coordinator", body)
    for _ in range(3):
        stage.system.tick()
    coordinator = stage.system.coordinator
    assert (coordinator.diary, coordinator.phase, coordinator.members.live) == (before, "asking", {T1, T2})
    assert coordinator.node.post.inbox.refused == {"not_yours": 1}

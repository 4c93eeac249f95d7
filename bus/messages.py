"""The language the processes speak: every message, typed, immutable, units in the names.

A message is an `Envelope` around one *body*. Bodies are grouped by who speaks to whom; a request's
docstring names its reply. A `State` maps a fluent to its value, both written as terms of the
domain's language: ``{"at(w1)": "(1,3)", "effector(w1)": 1, "attached(c1)": "none"}``.

Validation is by type (msgspec): unknown fields, wrong types and unknown tags are refused. Limits that
types cannot say (size, depth, finite numbers) are checked in `bus.codec`.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

SCHEMA_VERSION = 1

Name = Annotated[str, msgspec.Meta(min_length=1, max_length=64)]
Text = Annotated[str, msgspec.Meta(max_length=2000)]
Value = int | str
State = dict[str, Value]
Count = Annotated[int, msgspec.Meta(ge=0)]
Seconds = Annotated[float, msgspec.Meta(ge=0)]
Step = Annotated[int, msgspec.Meta(ge=0)]
Steps = tuple[tuple[str, ...], ...]
Outcome = Literal["as_planned", "finished", "discrepancy", "order_changed", "recovered", "refused"]


class Body(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag=True):
    """Base of everything that travels inside an `Envelope`."""


# ---------------------------------------------------------------- team agent -> world
class SkillCall(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One action of a plan as the world is asked to carry it out.

    `name` and `args` are the action's term, ``move(w1,right)``; `detail` carries what the written
    form leaves out (which end effector a robot is given on its way, which physical robot a guest is).
    """

    name: Name
    args: tuple[Value, ...] = ()
    detail: dict[str, Value] = {}


class Execute(Body, frozen=True):
    """Carry out these actions as the team's discrete step `step`. Reply: `Executed`."""

    team: Name
    step: Step
    calls: tuple[SkillCall, ...] = ()


class Executed(Body, frozen=True):
    """The step is over: what the team's sensors show now.

    `findings` holds what inspections of this step found: ``{"c1": "broken"}`` or ``"sound"``.
    """

    team: Name
    step: Step
    state: State
    findings: dict[str, Literal["broken", "sound"]] = {}


class Observe(Body, frozen=True):
    """Look without acting. Reply: `Observed`."""

    team: Name


class Observed(Body, frozen=True):
    team: Name
    state: State


# ---------------------------------------------------------------- coordinator <-> team agent
class Question(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Can you finish within `within` steps from now: alone / if you lend a worker in step `step` or
    earlier / if you borrow one in step `step` or later? Steps count from 0 at the epoch's start.

    Or ``share``: if you give at least the robots of `gives`, each a kind of robot and the step in which it is given at
    the latest, and take at most those of `takes`, each a kind and the step in which it is taken at the earliest?"""

    kind: Literal["alone", "lend", "borrow", "share"]
    within: Step
    step: Step = 0
    gives: tuple[tuple[Name, Step], ...] = ()
    takes: tuple[tuple[Name, Step], ...] = ()


class Enquire(Body, frozen=True):
    """How do you stand? Asked when a search starts and when a coordinator comes back. Reply: `Standing`."""

    epoch: Count


class Offer(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The rest of a plan that is on course: it finishes in `question.within` steps from now in that role.

    `refuted` are questions known to be answered no, carried over from the plan's own proof.
    """

    question: Question
    refuted: tuple[Question, ...] = ()


class Handover(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A robot, under the name it was built with, that left or joined a team in global step `step`."""

    robot: Name
    step: Step


class Standing(Body, frozen=True):
    """Where a team stands. `step` is the global step that it would execute next; `lower_bound` an
    admissible bound on the steps it still needs; `offer` the rest of its plan when that is on course;
    `inspect` robots that a diagnosis still suspects; `gave` and `took` its exchanges of the whole run.
    `hopeless` says why it can never finish alone, `hopeless_with_guest` why not even with one more robot
    (empty: it may)."""

    epoch: Count
    team: Name
    step: Step
    finished: bool
    lower_bound: Count
    offer: Offer | None = None
    inspect: tuple[Name, ...] = ()
    gave: tuple[Handover, ...] = ()
    took: tuple[Handover, ...] = ()
    hopeless: Text = ""
    hopeless_with_guest: Text = ""


class Ask(Body, frozen=True):
    """One yes/no question of the search for a shared plan. Reply: `Answer`."""

    epoch: Count
    question: Question


class Answer(Body, frozen=True):
    """`yes` comes with a plan that the team keeps; `unknown` means the budget ran out.

    `finish` is the makespan of the plan found and `at` the step of its exchange, which may both be
    better than what was asked.
    """

    epoch: Count
    question: Question
    verdict: Literal["yes", "no", "unknown"]
    finish: Count = 0
    at: Count = 0
    seconds: Seconds = 0.0
    conflicts: Count = 0


class Exchange(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """`worker` leaves team `giver` in step `give_step` and joins `taker` as `known_as` in `take_step`.

    `robot` is the name it was built with (``T2.w3``), which never changes. Steps are global.
    """

    worker: Name
    robot: Name
    giver: Name
    give_step: int
    taker: Name
    take_step: Step
    known_as: Name


class Adopt(Body, frozen=True):
    """Make the plan that answered `question` yours; it starts at global step `start`. Reply: `Adopted`.

    `guest` is the robot that a borrower will take, `plan` a given plan that replaces the search.
    """

    epoch: Count
    start: Step
    question: Question
    guest: str = ""
    plan: Steps = ()


class Adopted(Body, frozen=True):
    """The team has journalled the plan. `at` is the global step of its exchange, `worker` who is exchanged
    under the team's own name for it and, for a lender, `robot` the name it was built with."""

    epoch: Count
    team: Name
    ok: bool
    makespan: Count = 0
    at: int = -1
    worker: str = ""
    robot: str = ""
    reason: Text = ""


class Go(Body, frozen=True):
    """Execute global step `step` of the adopted plan, or, when `recover`, the inspections that the
    diagnosis asked for. Reply: `StepResult`."""

    epoch: Count
    step: Step
    recover: bool = False


class Diagnosis(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One minimal explanation: `causes` are terms such as ``broken(c1)`` or ``moved(w1)``; each has the
    steps at which it may have begun; `happened` are the actions that did happen, per step."""

    causes: tuple[str, ...]
    since: dict[str, tuple[int, ...]] = {}
    happened: Steps = ()


class StepResult(Body, frozen=True):
    epoch: Count
    team: Name
    step: Step
    outcome: Outcome
    differing: tuple[str, ...] = ()
    diagnoses: tuple[Diagnosis, ...] = ()
    inspect: tuple[Name, ...] = ()
    reason: Text = ""


# ---------------------------------------------------------------- world -> coordinator, supervisor
class Contact(Body, frozen=True):
    """A process was lost from sight, or is back. Losing contact is not failing. Reply: `Ok`."""

    name: Name
    state: Literal["present", "lost_contact", "back"]


class Order(Body, frozen=True):
    """Work was added to or taken from a team's order. Reply: `Ok`."""

    team: Name
    added: tuple[Name, ...] = ()
    cancelled: tuple[Name, ...] = ()


class ProcessFault(Body, frozen=True):
    """Ask the supervisor to disturb a process, for `for_s` simulated seconds where that applies. Reply: `Ok`."""

    kind: Literal["kill", "pause", "resume", "restart"]
    target: Name


class RunOver(Body, frozen=True):
    """The coordinator's last word. Reply: `Ok`."""

    goal: bool
    reason: Text
    makespan: Count
    replans: Count


# ---------------------------------------------------------------- anybody
class Inject(Body, frozen=True):
    """Disturb the world, its processes or its links; see `bus.faults` for kinds. Reply: `Injected`."""

    kind: Name
    target: Name
    args: dict[str, Value | float] = {}


class Injected(Body, frozen=True):
    accepted: bool
    reason: Text = ""


class Impair(Body, frozen=True):
    """Make the receiver's outgoing mail to `to` (``*``: everybody) unreliable. Probabilities in [0, 1],
    delay in simulated seconds. Reply: `Ok`."""

    to: Name = "*"
    drop: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    repeat: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    late: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.0
    late_s: Seconds = 0.0
    seed: int = 0


class Ping(Body, frozen=True):
    """Are you there? Reply: `Ok`, from the receiver's node itself."""


class Ok(Body, frozen=True):
    """Done; nothing else to say."""


class EventsFrom(Body, frozen=True):
    """Send your recorded events of incarnation `incarnation` from number `first` again. Reply: `EventsAre`."""

    incarnation: Count
    first: Count


class EventsAre(Body, frozen=True):
    """`packed` are encoded `Envelope`s of `Event`s, at most a few hundred; `last` is the highest number
    that the source has emitted in that incarnation."""

    incarnation: Count
    last: Count
    packed: tuple[bytes, ...]


# ---------------------------------------------------------------- streams
class Event(Body, frozen=True):
    """Something that happened, for the record. `kind` is one of `bus.events.KINDS`."""

    kind: Name
    data: dict[str, object] = {}


class Status(Body, frozen=True):
    """What a process is doing now, for people who watch; the latest value wins.

    `plan` is the team's adopted plan from global step `start`; `bound` and `best` are the coordinator's
    proven lower bound and best makespan so far (-1: none yet).
    """

    role: Literal["team", "coordinator", "world", "supervisor", "recorder"]
    doing: Text
    step: int = -1
    start: int = 0
    plan: Steps = ()
    bound: int = -1
    best: int = -1
    epoch: Count = 0
    questions: Count = 0
    finished: bool = False
    exchanges: tuple[Exchange, ...] = ()


class BodyFrame(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One body of the world as it truly is. `place` is a team's name, ``bench`` or ``gone``; `name` is what
    the team calls it; `id` is the name it was built with; `x_m`, `y_m` count from the place's own origin."""

    id: Name
    name: Name
    kind: Name
    place: Name
    x_m: float
    y_m: float
    heading_rad: float = 0.0
    attributes: dict[str, Value] = {}
    broken: bool = False
    coupled_to: str = ""
    doing: str = ""


class Frame(Body, frozen=True):
    """Ground truth, for recorder and dashboard alone."""

    at_s: Seconds
    step: int
    bodies: tuple[BodyFrame, ...]


class Beat(Body, frozen=True):
    """A sign of life from a process's main loop, with its counters since it started."""

    pid: Count
    sent: Count = 0
    received: Count = 0
    refused: Count = 0
    repeated: Count = 0
    events: Count = 0
    latency_ms: float = 0.0
    doing: str = ""


# ---------------------------------------------------------------- the clock (see bus.clock)
class Join(Body, frozen=True):
    """I take part from now on."""


class Tick(Body, frozen=True):
    """The world's clock. In ``fast`` mode a round: every participant handles the mail of earlier rounds, of
    which `mail[receiver][sender]` were sent in the round before, and says `Done`. In ``realtime`` mode a
    report of the simulated time and its `factor` against wall time."""

    mode: Literal["fast", "realtime"]
    round: Count
    now_s: Seconds
    factor: float = 1.0
    participants: tuple[Name, ...] = ()
    mail: dict[str, dict[str, int]] = {}


class Done(Body, frozen=True):
    """I have handled round `round`, sent that many messages to each, and want to be woken at `wake_at_s`
    (negative: only by mail)."""

    round: Count
    sent: dict[str, int] = {}
    wake_at_s: float = -1.0


class Envelope(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """`v` schema version, `run` the run's name, `src` the sender, `inc` the sender's incarnation, `seq` its
    running number, `id` names a message across repetitions, `re` the id that this answers (or empty),
    `round` the clock's round it was sent in (0 in realtime), `at_s` simulated seconds."""

    v: int
    run: Name
    src: Name
    inc: Count
    seq: Count
    id: Name
    at_s: Seconds
    body: (
        Execute | Executed | Observe | Observed | Enquire | Standing | Ask | Answer | Adopt | Adopted | Go | StepResult
        | Contact | Order | ProcessFault | RunOver | Inject | Injected | Impair | Ping | Ok | EventsFrom | EventsAre
        | Event | Status | Frame | Beat | Join | Tick | Done
    )  # fmt: skip
    re: str = ""
    round: Count = 0

"""Physical disturbances: what people and wear do to bodies, between two periods.

Each gives the reason why it cannot be, or an empty text, or the change of a team's order or deadline that it was.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from bus.messages import Order, Value
from world import disorder
from world.handling import fits
from world.things import BENCH, GONE, Thing
from world.truth import MOST_BODIES, Truth

Args = Mapping[str, Value | float]
Outcome = str | Order


def named(truth: Truth, target: str) -> Thing | None:
    """The thing that is now called so in its team, ``TEAM.NAME``, or else the one that was built with that name."""
    team, _, name = target.partition(".")
    thing = truth.find(team, name) or truth.things.get(target)
    return thing if thing is not None and thing.place != GONE else None


def break_robot(truth: Truth, target: str, args: Args) -> Outcome:
    thing = named(truth, target)
    if thing is None or truth.kind(thing).role != "robot":
        robots = [one for _, things in truth.places() for one in things if truth.kind(one).role == "robot"]
        names = sorted(one.id if one.place in (BENCH, GONE) else f"{one.place}.{one.name}" for one in robots)
        return f"there is no robot {target}. There are: {', '.join(names)}"
    thing.broken = True
    return ""


def set_attribute(truth: Truth, target: str, args: Args) -> Outcome:
    thing, attribute, value = named(truth, target), str(args["attribute"]), args["value"]
    if thing is None or truth.kind(thing).role != "object":
        return f"there is no object {target}"
    if attribute not in thing.attributes:
        return f"{target} has no {attribute}; it has {', '.join(thing.attributes)}"
    if isinstance(value, float) or not fits(thing.attributes[attribute], value):
        return f"{attribute} of {target} cannot be {value}"
    thing.attributes[attribute] = value
    thing.marks.pop(attribute, None)
    periods = [action.marks_periods for action in truth.scene.actions.values() if action.marks == attribute]
    if value and periods:
        truth.mark(thing, attribute, periods[0])
    return ""


def move(truth: Truth, target: str, args: Args) -> Outcome:
    """A person carries a body elsewhere; what it was coupled to stays where it is."""
    thing = named(truth, target)
    if thing is None or thing.place == BENCH:
        return f"there is no {target} in a workspace"
    kind, team = truth.kind(thing), thing.place
    if kind.track == "floor":
        return disorder.move(truth, thing, args)
    others = [other for other in truth.of(team) if other is not thing and truth.kind(other).layer == kind.layer]
    if kind.track == "line":
        position = args.get("to")
        if not isinstance(position, int) or position < 0:
            return f"{target} can be put on a line position: to, 0 or more"
        if position and any(truth.line(other) == position for other in others):
            return f"position {position} is taken"
        truth.lie_on_line(thing, position)
        return ""
    x, y = args.get("x"), args.get("y")
    if not isinstance(x, int) or not isinstance(y, int) or not truth.layout.in_grid(team, x, y):
        return f"{target} can be put on a cell of its workspace: x, y"
    if any(truth.cell(other) == (x, y) for other in others):
        return f"cell ({x},{y}) is taken"
    if thing.partner:
        truth.uncouple(thing)
    truth.floor.put(thing.id, truth.layout.cell(team, x, y))
    truth.floor.brake(thing.id)
    return ""


def bring(truth: Truth, target: str, args: Args) -> Outcome:
    """A person puts something down in a room."""
    return disorder.bring(truth, target, args)


def take(truth: Truth, target: str, args: Args) -> Outcome:
    """A person takes something out of a room."""
    thing = named(truth, target)
    if thing is None or truth.kind(thing).role != "object" or truth.kind(thing).track != "floor":
        return f"there is no {target} in a room"
    return disorder.take(truth, thing)


def order(truth: Truth, target: str, args: Args) -> Outcome:
    """More objects, of the team's last kind, queue up behind all others."""
    number = args["add"]
    space = truth.layout.spaces.get(target)
    if space is None or not isinstance(number, int) or number < 1:
        return f"a team gets at least one more object: {target}, {number}"
    if number > (left := MOST_BODIES - len(truth.things)):
        return f"there is room for {max(left, 0)} more bodies, not for {number}"
    sample = _sample(truth, target)
    if sample is None:
        return "there is nothing on any line here"
    prefix = truth.scene.kinds[sample.kind].prefix
    # Names that were ever given, cancelled ones included, are not given again.
    own = f"{target}."
    known = [thing for thing in truth.things.values() if thing.id.startswith(own) and thing.kind == sample.kind]
    numbers = [int(tail) for thing in known if (tail := thing.id.removeprefix(f"{target}.{prefix}")).isdigit()]
    last = max([space.line_length, *(truth.line(thing) for thing in known if thing.place == target)])
    names = [f"{prefix}{max(numbers, default=0) + i + 1}" for i in range(number)]
    for i, name in enumerate(names):
        thing = Thing(f"{target}.{name}", sample.kind, target, name, dict(sample.attributes))
        truth.enter(thing, truth.layout.line(target, last + i + 1))
    return Order(target, added=tuple(names))


def cancel(truth: Truth, target: str, args: Args) -> Outcome:
    """The objects that are furthest from leaving the line are taken off it."""
    number = args["objects"]
    if target not in truth.layout.spaces or not isinstance(number, int) or number < 1:
        return f"a team loses at least one object: {target}, {number}"
    queue = [thing for thing in truth.of(target) if truth.kind(thing).track == "line" and truth.line(thing) > 0]
    if number > len(queue):
        return f"only {len(queue)} objects of {target} are on the line"
    queue.sort(key=truth.line)
    names = [thing.name for thing in queue[-number:]]
    for thing in queue[-number:]:
        truth.floor.lift(thing.id)
        truth.belongs(thing, GONE, thing.id)
    return Order(target, cancelled=tuple(names))


def deadline(truth: Truth, target: str, args: Args) -> Outcome:
    """A team is to be done earlier or later than it was to be."""
    units, space = args["units"], truth.layout.spaces.get(target)
    if space is None or not space.clock:
        return f"there is no team {target} that keeps deadlines"
    if not isinstance(units, int) or units < 0:
        return f"a deadline is a whole number of units of time, or 0 for none; not {units}"
    passed = -(-truth.tick // truth.period)
    if 0 < units <= passed:
        return f"{passed} units of time have passed already"
    return Order(target, deadline=units)


def _sample(truth: Truth, team: str) -> Thing | None:
    """An object as it is when its team gets it."""
    of_line = [e for e in truth.scene.entities if truth.scene.kinds[e.kind].track == "line"]
    of_line.sort(key=lambda e: e.team == team)
    if not of_line:
        return None
    entity = of_line[-1]
    kind = truth.scene.kinds[entity.kind]
    return Thing(entity.id, entity.kind, team, "", {k: v for k, v in entity.attributes.items() if k in kind.attributes})


HAPPENS: dict[str, Callable[[Truth, str, Args], Outcome]] = {
    "break": break_robot,
    "set": set_attribute,
    "move": move,
    "bring": bring,
    "take": take,
    "order": order,
    "cancel": cancel,
    "deadline": deadline,
}

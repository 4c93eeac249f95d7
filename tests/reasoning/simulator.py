"""A second judge of joint plans, slow and plain, written from the rules of the painting factory alone.

It knows told exchanges and told effectors only. `judge` gives the violated rules by the checker's names, so that both
can be compared violation by violation; `outcome` is what becomes of one team's actions when robots break.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field

from reasoning.checker import Exchange
from reasoning.values import State, Step, Value

Cell = tuple[int, int]
Violated = tuple[str, int, str, str]
SIDES = {"left": (-1, 0), "right": (1, 0), "up": (0, 1), "down": (0, -1)}
ROBOT_ARGUMENTS = {
    "move": 1, "attach": 2, "detach": 1, "push": 1, "pull": 1, "swapEndEffector": 1, "workOn": 1, "giveRobot": 1,
    "takeRobot": 1, "repair": 1, "inspect": 1, "lineShift": 0,
}  # fmt: skip
ARGUMENTS = {**ROBOT_ARGUMENTS, "move": 2, "swapEndEffector": 2, "workOn": 2, "takeRobot": 3}
EXCLUSIVE = {"move", "push", "pull", "giveRobot", "takeRobot", "repair"}


@dataclass
class Floor:
    """One team's workspace as it is now."""

    at: dict[str, Cell] = field(default_factory=dict)
    effector: dict[str, int] = field(default_factory=dict)
    attached: dict[str, str] = field(default_factory=dict)
    line: dict[int, int] = field(default_factory=dict)
    stage: dict[int, int] = field(default_factory=dict)
    wet: set[int] = field(default_factory=set)
    workers: set[str] = field(default_factory=set)

    def tied(self, robot: str) -> bool:
        partner = self.attached.get(robot, "none")
        return partner != "none" or robot in self.attached.values()

    def state(self) -> dict[str, Value]:
        """As sensed."""
        return {
            **{f"at({r})": f"({x},{y})" for r, (x, y) in self.at.items()},
            **{f"effector({w})": tool for w, tool in self.effector.items()},
            **{f"attached({c})": w for c, w in self.attached.items()},
            **{f"line({b})": place for b, place in self.line.items()},
            **{f"stage({b})": stage for b, stage in self.stage.items()},
            **{f"wet({b})": int(b in self.wet) for b in self.line},
        }


def split(action: str) -> tuple[str, list[str]]:
    found = re.fullmatch(r"(\w+)(?:\((.*)\))?", action)
    assert found is not None
    return found[1], found[2].split(",") if found[2] else []


def needed(action: str) -> list[str]:
    """The robots that must be there and in working order for it."""
    name, args = split(action)
    return [] if name in ("takeRobot", "repair", "inspect") else args[: ROBOT_ARGUMENTS.get(name, 0)]


def floor(state: State, steps: Sequence[Step]) -> Floor:
    """The start; robots that the team is to take count as its workers, wherever they are."""
    made = Floor()
    for fluent, value in state.items():
        name, (body,) = split(fluent)
        if name == "at":
            x, y = str(value).strip("()").split(",")
            made.at[body] = int(x), int(y)
        elif name == "effector":
            made.effector[body] = int(value)
            made.workers.add(body)
        elif name == "attached":
            made.attached[body] = str(value)
        elif name == "line":
            made.line[int(body)] = int(value)
        elif name == "stage":
            made.stage[int(body)] = int(value)
        elif name == "wet" and value:
            made.wet.add(int(body))
    taken = {split(a)[1][0] for step in steps for a in step if a.startswith("takeRobot(")}
    made.workers |= taken - made.attached.keys()
    return made


class Judge:
    """`exchanges`: None means that whoever is taken has come."""

    def __init__(
        self,
        size: Cell,
        delay: int,
        exchanges: Sequence[Exchange] | None,
        tools: Mapping[tuple[str, int, str], int],
    ) -> None:
        (self.width, self.height), self.delay, self.exchanges, self.tools = size, delay, exchanges, tools
        self.given: set[tuple[str, str, int]] = set()
        self.found: set[Violated] = set()

    def inside(self, cell: Cell) -> bool:
        return 1 <= cell[0] <= self.width and 1 <= cell[1] <= self.height

    def step(
        self, team: str, now: Floor, time: int, actions: Step, broken: AbstractSet[str] = frozenset()
    ) -> list[str]:
        """Carry out a step and return the actions that had their effect."""
        wrong: dict[str, set[str]] = {a: set(self.alone(team, now, time, a)) for a in set(actions)}
        understood = [a for a in wrong if "unknown" not in wrong[a]]
        for one in understood:
            for other in understood:
                if one != other:
                    wrong[one] |= set(self.together(now, one, other))
        failed = {a for a in understood if broken & set(needed(a))}
        goes = {}
        for action in understood:
            if not wrong[action] and action not in failed:
                goes.update({(action, robot): cell for robot, cell in self.moves(now, action).items()})
        leaving = {split(a)[1][0] for a in understood if a.startswith("giveRobot") and not wrong[a] and a not in failed}
        hindered = self.hinder(now, goes, leaving)
        for action, rules in hindered.items():
            wrong[action] |= rules
        self.found |= {(team, time, action, rule) for action, rules in wrong.items() for rule in rules}
        effective = [a for a in understood if not wrong[a] and a not in failed]
        self.carry_out(team, now, time, effective)
        return effective

    # ---------------------------------------------------------- one action by itself
    def alone(self, team: str, now: Floor, time: int, action: str) -> list[str]:
        name, args = split(action)
        if not self.understood(now, name, args):
            return ["unknown"]
        wrong = ["absent" for r in needed(action) if r not in now.at]
        here = now.at.get(args[0]) if args else None
        match name:
            case "move":
                dx, dy = SIDES[args[1]]
                wrong += ["off_grid"] * (here is not None and not self.inside((here[0] + dx, here[1] + dy)))
                wrong += ["west_or_east"] * (args[0] in now.workers and dy != 0)
                wrong += ["move_tied"] * now.tied(args[0])
            case "attach":
                there = now.at.get(args[1])
                wrong += ["attach_apart"] * (here is not None and there is not None and here != there)
                wrong += ["attach_tied"] * now.tied(args[0])
            case "detach" | "push" | "pull":
                wrong += ["free"] * (not now.tied(args[0]))
                dy = {"detach": 0, "push": 1, "pull": -1}[name]
                wrong += ["off_grid"] * (here is not None and not self.inside((here[0], here[1] + dy)))
            case "swapEndEffector":
                wrong += ["swap_outside"] * (here is not None and here[0] != 1)
                wrong += ["swap_same"] * (now.effector.get(args[0]) == int(args[1]))
            case "workOn":
                wrong += self.work(now, args[0], int(args[1]))
            case "giveRobot":
                wrong += ["give_outside"] * (here is not None and here[0] != 1) + ["give_tied"] * now.tied(args[0])
            case "takeRobot":
                wrong += self.take(team, now, time, args)
            case "repair":
                wrong.append("repair_whole")
        return wrong

    def understood(self, now: Floor, name: str, args: list[str]) -> bool:
        if ARGUMENTS.get(name) != len(args):
            return False
        if name == "takeRobot":
            return all(a.isdigit() for a in args[1:]) and self.inside((int(args[1]), int(args[2])))
        if name == "attach":
            return args[0] in now.attached and args[1] in now.workers
        if name in ("detach", "push", "pull"):
            return args[0] in now.attached
        if name in ("swapEndEffector", "workOn", "giveRobot") and args[0] not in now.workers:
            return False
        if name in ("move", "repair", "inspect") and args[0] not in now.workers | now.attached.keys():
            return False
        last = args[-1] if args else ""
        return {
            "move": last in SIDES,
            "swapEndEffector": last in ("1", "2", "3"),
            "workOn": last.isdigit() and int(last) in now.line,
        }.get(name, True)

    def work(self, now: Floor, worker: str, box: int) -> list[str]:
        wrong, here = [], now.at.get(worker)
        if here is not None:
            wrong += ["work_row"] * (here[1] != self.height) + ["work_pit"] * (here[0] == 1)
            wrong += ["work_column"] * (here[0] != now.line[box])
        tool = now.effector.get(worker)
        wrong += ["work_stage"] * (tool is not None and tool != now.stage[box] + 1)
        return wrong + ["work_wet"] * (box in now.wet)

    def take(self, team: str, now: Floor, time: int, args: list[str]) -> list[str]:
        wrong = ["take_outside"] * (args[1] != "1") + ["take_present"] * (args[0] in now.at)
        if self.exchanges is None:
            return wrong
        mine = [e for e in self.exchanges if (e.taker, e.take_step, e.known_as) == (team, time, args[0])]
        wrong += ["take_nobody"] * (not mine)
        for e in mine:
            wrong += ["take_own"] * (e.giver == team) + ["take_early"] * (time < e.give_step + self.delay)
            wrong += ["take_nobody"] * (0 <= e.give_step < time and (e.giver, e.worker, e.give_step) not in self.given)
            same = [o for o in self.exchanges if (o.giver, o.worker, o.give_step) == (e.giver, e.worker, e.give_step)]
            wrong += ["take_twice"] * (len({(o.taker, o.take_step, o.known_as) for o in same}) > 1)
        return wrong + ["two_robots"] * (len({(e.giver, e.worker, e.give_step) for e in mine}) > 1)

    # ---------------------------------------------------------- two actions of the same step
    def together(self, now: Floor, one: str, other: str) -> list[str]:
        (name, args), (name2, args2) = split(one), split(other)
        wrong = ["busy"] * bool(self.concerned(now, one) & self.concerned(now, other) and {name, name2} & EXCLUSIVE)
        if name == name2 and name in ("attach", "swapEndEffector") and args[0] == args2[0]:
            wrong.append("twice")
        if name == name2 == "workOn" and args[1] == args2[1]:
            wrong.append("work_together")
        if name == "lineShift" and name2 == "workOn":
            wrong.append("shift_at_work")
        return wrong

    def concerned(self, now: Floor, action: str) -> set[str]:
        name, args = split(action)
        robots = set(args[: ROBOT_ARGUMENTS[name]])
        if name in ("detach", "push", "pull") and now.tied(args[0]):
            robots.add(now.attached[args[0]])
        return robots

    # ---------------------------------------------------------- cells
    def moves(self, now: Floor, action: str) -> dict[str, Cell]:
        name, args = split(action)
        if name == "takeRobot":
            return {args[0]: (int(args[1]), int(args[2]))}
        if name not in ("move", "push", "pull"):
            return {}
        dx, dy = SIDES[args[1]] if name == "move" else (0, 1 if name == "push" else -1)
        bodies = self.concerned(now, action)
        return {r: (now.at[r][0] + dx, now.at[r][1] + dy) for r in bodies}

    def hinder(self, now: Floor, goes: Mapping[tuple[str, str], Cell], leaving: set[str]) -> dict[str, set[str]]:
        """Who cannot go: rivals for a cell, exchangers, and, again and again, those who run into one that stays."""

        def rivals(robot: str, other: str) -> bool:
            return robot != other and (robot in now.workers) == (other in now.workers)

        moving = {robot: (action, cell) for (action, robot), cell in goes.items()}
        standing = now.at
        hit: dict[str, set[str]] = {}
        for robot, (action, cell) in moving.items():
            for other, (_, cell2) in moving.items():
                if rivals(robot, other) and cell == cell2:
                    hit.setdefault(action, set()).add("same_cell")
                if rivals(robot, other) and standing.get(other) == cell and standing.get(robot) == cell2:
                    hit.setdefault(action, set()).add("change_cells")
        changed = True
        while changed:
            changed = False
            stays = {r for r in standing if r not in leaving and (r not in moving or moving[r][0] in hit)}
            for robot, (action, cell) in moving.items():
                blocked = any(standing[other] == cell for other in stays if rivals(robot, other))
                if blocked and "cell_taken" not in hit.get(action, set()):
                    hit.setdefault(action, set()).add("cell_taken")
                    changed = True
        return hit

    # ---------------------------------------------------------- what becomes of it
    def carry_out(self, team: str, now: Floor, time: int, actions: Sequence[str]) -> None:
        where = {robot: cell for action in actions for robot, cell in self.moves(now, action).items()}
        painted = set()
        for action in actions:
            name, args = split(action)
            if name == "attach":
                now.attached[args[0]] = args[1]
            elif name == "detach":
                now.attached[args[0]] = "none"
            elif name == "swapEndEffector":
                now.effector[args[0]] = int(args[1])
            elif name == "workOn":
                now.stage[int(args[1])] += 1
                painted |= {int(args[1])} if now.stage[int(args[1])] == 1 else set()
            elif name == "giveRobot":
                del now.at[args[0]], now.effector[args[0]]
                self.given.add((team, args[0], time))
            elif name == "takeRobot":
                now.effector[args[0]] = self.tools[team, time, action]
            elif name == "lineShift":
                now.line = {box: max(place - 1, 0) for box, place in now.line.items()}
        now.at.update(where)
        now.wet = painted

    def goal(self, team: str, now: Floor, time: int) -> None:
        if any(stage != 3 for stage in now.stage.values()):
            self.found.add((team, time, "goal", "goal_stage"))
        if now.line and now.line[max(now.line)] != 0:
            self.found.add((team, time, "goal", "goal_line"))


def judge(
    size: Cell,
    delay: int,
    states: Mapping[str, State],
    plan: Mapping[str, Sequence[Step]],
    exchanges: Sequence[Exchange],
    tools: Mapping[tuple[str, int, str], int],
) -> set[Violated]:
    """Every violated rule as (team, step, action, rule). `tools[team, step, action]` is what a taken worker gets."""
    referee = Judge(size, delay, exchanges, tools)
    floors = {team: floor(state, plan.get(team, ())) for team, state in states.items()}
    last = max(map(len, plan.values()), default=0)
    for time in range(last):
        for team, now in floors.items():
            steps = plan.get(team, ())
            referee.step(team, now, time, tuple(steps[time]) if time < len(steps) else ())
    for team, now in floors.items():
        referee.goal(team, now, last)
    return referee.found


def outcome(
    size: Cell, state: State, steps: Sequence[Step], breaks: Mapping[str, int], tool: int = 3
) -> tuple[State, list[list[str]]]:
    """The state after one team's steps, and the actions of each step that had their effect. `breaks[robot]` is the step
    from which a robot is broken; taken workers come with `tool`."""
    tools = {("", t, a): tool for t, step in enumerate(steps) for a in step}
    referee, now = Judge(size, 0, None, tools), floor(state, steps)
    done = [
        referee.step("", now, time, step, {robot for robot, since in breaks.items() if since <= time})
        for time, step in enumerate(steps)
    ]
    return now.state(), done

"""Disturbances as they take effect: announced, journalled, done, and the coordinator told of a changed order."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import msgspec

from bus.messages import Envelope, Inject, Injected, Order, Value
from bus.node import Node
from world.faults import Faults, physical
from world.truth import Truth

COORDINATOR = "coordinator"


class SavedOrders(msgspec.Struct):
    """Changes of orders that the coordinator has not confirmed yet, and how many it has."""

    untold: list[Order] = []
    told: int = 0


class Disturbances:
    """Script and operator alike. `save` journals the world, `orders` with it."""

    def __init__(self, node: Node, truth: Truth, faults: Faults, orders: SavedOrders, save: Callable[[], None]) -> None:
        self.orders = orders
        self._node, self._truth, self._faults, self._save = node, truth, faults, save
        self._under_way = ""

    # ------------------------------------------------------------ orders
    def tell(self) -> None:
        """Tell the coordinator of changed orders: one after the other, since the latest counts. The id is the order's
        own, the same in every life."""
        if self.orders.untold and not self._under_way:
            name = f"{self._node.name}.order.{self.orders.told + 1}"
            self._under_way = self._node.request(COORDINATOR, self.orders.untold[0], request_id=name)

    def told(self, request: str) -> None:
        """A request was answered."""
        if request == self._under_way:
            del self.orders.untold[0]
            self.orders.told += 1
            self._under_way = ""
            self.tell()

    # ------------------------------------------------------------ disturbances
    def of_script(self, numbers: list[int]) -> None:
        """Carry out faults of the scene."""
        if not numbers:
            return
        later = []
        with self._node.journal.transaction():
            for number in numbers:
                fault = self._truth.scene.faults[number]
                self._faults.saved.done.append(number)
                reason = self._happen(fault.kind, fault.target, fault.args)
                if reason:
                    self._came_to_nothing(fault.kind, fault.target, reason)
                elif not physical(fault.kind):
                    later.append(fault)
            self._save()
        for fault in later:
            if reason := self._faults.pass_on(fault.kind, fault.target, fault.args):
                self._came_to_nothing(fault.kind, fault.target, reason)
        if later:
            self._save()

    def asked_for(self, message: Envelope, body: Inject) -> None:
        """Carry out a disturbance that somebody asked for, and say what came of it. One of a process or a link is
        passed on once, even if this process dies of it before it has answered."""
        if message.id == self._faults.saved.asked:
            self._node.reply(message, Injected(True))
            return
        with self._node.journal.transaction():
            reason = self._happen(body.kind, body.target, body.args)
            if reason or physical(body.kind):
                self._node.reply(message, Injected(not reason, reason))
            else:
                self._faults.saved.asked = message.id
            self._save()
        if not reason and not physical(body.kind):
            reason = self._faults.pass_on(body.kind, body.target, body.args)
            with self._node.journal.transaction():
                self._node.reply(message, Injected(not reason, reason))
                self._save()

    def _happen(self, kind: str, target: str, args: Mapping[str, Value | float]) -> str:
        """Announce a disturbance, and do it if it is a physical one; why it cannot be, or empty."""
        reason = self._faults.wrong(kind, target, args)
        if reason:
            return reason
        outcome = self._faults.happen(kind, target, args) if physical(kind) else ""
        if isinstance(outcome, str) and outcome:
            return outcome
        self._faults.plan_resume(kind, target, args)
        listed = ", ".join(f"{name} {value}" for name, value in args.items())
        text = f"{kind} {target} {listed}".strip()
        self._node.post.emit("fault_injected", text, {"kind": kind, "target": target, "args": dict(args)})
        if isinstance(outcome, Order):
            self._emit(outcome)
            self.orders.untold.append(outcome)
            self.tell()
        return ""

    def _emit(self, order: Order) -> None:
        text, changed = f"the order of {order.team} has changed", {}
        if order.deadline is not None:
            until = f"has until {order.deadline} units of time" if order.deadline else "has no deadline"
            text, changed = f"{order.team} {until} from now on", {"deadline": order.deadline}
        self._node.emit("order", text, team=order.team, added=order.added, cancelled=order.cancelled, **changed)

    def _came_to_nothing(self, kind: str, target: str, reason: str) -> None:
        self._node.emit("refused", f"{kind} {target} came to nothing: {reason}", reason=reason, count=1)

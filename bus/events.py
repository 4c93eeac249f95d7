"""The closed list of events: what is worth recording, and who says so.

Every event carries ``text``, one plain sentence for people, besides the fields named here.
"""

KINDS: dict[str, str] = {
    # any process
    "started": "a process is up: incarnation, role, recovered (true when it came back from a journal)",
    "refused": "messages were refused: reason, count",
    # world
    "step_started": "team, step, command (id of the Execute), actions",
    "step_ended": "team, step, command, state (sensed)",
    "skill_failed": "team, step, action, reason: an action had no physical effect",
    "fault_injected": "kind, target, args",
    "membership": "truth at a step's end: step, robots {id: [place, name]}, objects {id: {attribute: value}}",
    "contact": "name, state: present, lost_contact, back",
    "order": "team, added, cancelled",
    # team agent
    "plan_adopted": "team, epoch, start, makespan, role",
    "discrepancy": "team, step, differing",
    "diagnosis": "team, step, causes (list of lists, sorted)",
    "inspection": "team, robot, finding",
    "repair": "team, robot",
    "team_finished": "team, step",
    "no_plan": "team, reason",
    # coordinator
    "search_started": "epoch, step, reason",
    "question": "epoch, team, role, within, step, verdict",
    "bound": "epoch, lower, best",
    "shared_plan": "epoch, start, makespan, proof, exchanges",
    "exchange": "worker, giver, give_step, taker, take_step, known_as",
    "run_over": "goal, reason, makespan, replans",
    # coordinator, supervisor
    "needs_person": "cause (no_plan, plan_refused, gave_up, too_long): the system cannot go on by itself",
    # supervisor
    "process": "name, state: started, died, restarted, gave_up, stopped; cause",
}

"""The closed list of events: what is worth recording, and who says so.

Every event carries ``text``, one plain sentence for people, besides the fields named here.
"""

KINDS: dict[str, str] = {
    # any process
    "started": "a process is up: incarnation, role, recovered (it came back from a journal); of the world also step",
    "refused": "messages were refused: reason, count",
    # world
    "step_started": "team, step, command (id of the Execute), actions",
    "step_ended": "team, step, command, state (sensed)",
    "skill_failed": "team, step, action, reason: an action had no physical effect",
    "waits_at_door": "team, step, robot: it is not in yet, or not out; said once for each reason",
    "fault_injected": "kind, target, args",
    "membership": "truth at a step's end: step, robots {id: [place, name]}, objects {id: {attribute: value}}",
    "contact": "name, state: present, lost_contact, back, stopped",
    "order": "team, added, cancelled; deadline (units since the run began, 0: none) if that has changed",
    # team agent
    "plan_adopted": "team, epoch, start, makespan, role; of a team that acts for itself also status, proof",
    "discrepancy": "team, step, differing",
    "diagnosis": "team, step, causes (list of lists, sorted)",
    "inspection": "team, robot, finding",
    "repair": "team, robot",
    "team_finished": "team, step; of a team that acts for itself also untidy (things that are left as they are)",
    "no_plan": "team, reason",
    # team agent that acts for itself: causes
    "unknown_object": "team, step, about (the object), robot: something that was not known is in a robot's way",
    "person_in_way": "team, step, about (the person), robot",
    "held_up": "team, step, about (another robot, say), robot",
    "object_not_found": "team, step, about (the object), robot: it is not where it was, or not where it should be",
    "heavy_object": "team, step, about (the object), robot: it takes two robots",
    "robot_broken": "team, step, about (the robot), robot",
    "object_appeared": "team, step, about (the object), robot: it was not known, and is in nobody's way",
    "deadline_at_risk": "team, step, end, deadline: the plan would end too late",
    # team agent that acts for itself: recovery
    "new_way": "team, step, robot: another way from where the robot stands to the plan's next state",
    "waited": "team, step: a unit of time, for a person to go away",
    "safe_state": "team, step, robot: the robot goes to the middle of a cell, from where can be planned",
    "made_way": "team, step, robot, reason: the robot steps aside, so that another one, or a person, gets past it",
    "stays": "team, step, robot: the robot stays between cells, since it does not get to any",
    "plan_dropped": "team, step, reason",
    "final_look": "team, step: the plan is over, and the whole room is looked at again",
    "set_aside": "team, thing, reason: nobody can bring it where it belongs",
    "deadline_missed": "team, step",
    # team agent that acts for itself: help
    "help_wanted": "team, units (expected), about",
    "help_offered": "team, units (until the robot would be there)",
    "help_answered": "team, of (who called), call (want, offer), yes, units, reason",
    "help_confirmed": "team (who called), partner, call",
    "help_released": "team, by (who called)",
    "nobody_helps": "team, about",
    "helper_left": "team, robot, to: it has left its room to help",
    "helper_came": "team, robot, of: it is under the team's orders now",
    "helper_sent_back": "team, robot, to",
    "helper_called": "team, robot, of (who has it): the robot is to come home by itself, for good",
    "helper_gone": "team, step, robot: the robot of another team is under the team's orders no more",
    "helper_returned": "team, robot, of (whom it has helped): it is back where it was",
    # coordinator
    "search_started": "epoch, step, reason",
    "question": "epoch, team, role, within, step, verdict; where sharing is general also gives, takes",
    "bound": "epoch, lower, best",
    "shared_plan": "epoch, start, makespan, status (optimal, feasible, given), proof, exchanges, questions",
    "exchange": "robot (as it was built), worker (its name in the giver), giver, give_step, taker, take_step, known_as",
    "run_over": "goal, reason, makespan, replans",
    # coordinator, supervisor
    "needs_person": "cause (no_plan, plan_refused, gave_up, too_long): the system cannot go on by itself",
    # supervisor
    "process": "name, state: started, died, restarted, gave_up, stopped; cause",
}

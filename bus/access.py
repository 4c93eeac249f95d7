"""Who may do what on the bus, enforced by the router when a run is secure: access control by key and by certificate.

Every process proves its name with a certificate (mutual TLS); the router lets it send only under that name, and lets
nobody but the operator's seats hear the truth. The rules' vocabulary is Zenoh's.

An *identity* is a folder: the authority that everybody trusts, a certificate whose common name is the process's name,
and its private key. The router's also holds the access control.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from bus import keys

OPERATOR = "operator"
"""The name on the certificate of people: ``muster watch`` and ``muster inject``, whose nodes are ``operator-PID``."""
AUTHORITY, CERTIFICATE, PRIVATE_KEY, ACCESS = "authority.pem", "certificate.pem", "key.pem", "access.json"
"""The files of an identity."""
EVERYTHING = "**"
Rule = dict[str, Any]


def access_control(run: str, agents: Sequence[str], *, seats: Sequence[str]) -> dict[str, Any]:
    """Zenoh's ``access_control`` setting: everything is forbidden but what `agents` (coordinator and teams), the world,
    the `seats` (processes of the operator's own, as supervisor and recorder) and operators need."""
    policies = {name: _speaks(run, name) for name in agents}
    policies[keys.WORLD] = [*_speaks(run, keys.WORLD), *_holds_the_truth(run)]
    for name in seats:
        policies[name] = [*_speaks(run, name), *_hears_everything(run)]
    policies[OPERATOR] = [*_speaks(run, OPERATOR, f"{OPERATOR}-$*"), *_hears_everything(run)]
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": [{**rule, "id": f"{name}.{n}"} for name, rules in policies.items() for n, rule in enumerate(rules)],
        "subjects": [{"id": name, "cert_common_names": [name]} for name in policies],
        "policies": [
            {"id": name, "rules": [f"{name}.{n}" for n in range(len(rules))], "subjects": [name]}
            for name, rules in policies.items()
        ],
    }


def _speaks(run: str, owner: str, name: str = "") -> list[Rule]:
    """What every process does: send mail and its own streams under its own name, take its mail, follow the clock."""
    name = name or owner
    own = [keys.done(run, name), keys.join(run, name), keys.event(run, name), keys.beat(run, name)]
    status = keys.status(run, name)
    return [
        *_publish([keys.mail(run, "*", name), *own]),
        *_keep(status),
        *_subscribe([keys.mail(run, name, "*"), keys.tick(run)]),
        _allow("ingress", ["liveliness_token"], [keys.live(run, name)]),
        _allow("ingress", ["liveliness_query"], [keys.NOBODY]),
    ]


def _holds_the_truth(run: str) -> list[Rule]:
    return [
        *_publish([keys.tick(run), keys.truth_frame(run)]),
        *_keep(keys.truth_scene(run)),
        *_subscribe([keys.done(run, "*"), keys.join(run, "*"), keys.beat(run, "*")]),
        *_watch([keys.live(run, "*")]),
    ]


def _hears_everything(run: str) -> list[Rule]:
    everything = [f"muster/{run}/{EVERYTHING}"]
    return [
        *_subscribe(everything),
        *_watch([*everything, f"muster/{run}/{EVERYTHING}/@adv/{EVERYTHING}"]),
        _allow("ingress", ["query"], [*everything, f"muster/{run}/{EVERYTHING}/@adv/{EVERYTHING}"]),
        _allow("egress", ["reply", "declare_queryable"], [*everything, f"muster/{run}/{EVERYTHING}/@adv/{EVERYTHING}"]),
    ]


def _publish(expressions: list[str]) -> list[Rule]:
    # Others' subscriptions must be seen whatever their expression, or a declared publisher silently sends nothing.
    return [
        _allow("ingress", ["put", "delete"], expressions),
        _allow("egress", ["declare_subscriber"], [EVERYTHING]),
    ]


def _keep(key: str) -> list[Rule]:
    """Publish with the latest value kept for those who come late: an advanced publisher."""
    kept = [f"{key}/@adv/{EVERYTHING}"]
    return [
        *_publish([key, *kept]),
        _allow("ingress", ["declare_queryable", "reply"], [key, *kept]),
        _allow("egress", ["query"], [key, *kept]),
        _allow("ingress", ["liveliness_token"], kept),
    ]


def _subscribe(expressions: list[str]) -> list[Rule]:
    return [
        _allow("egress", ["put", "delete"], expressions),
        _allow("ingress", ["declare_subscriber"], expressions),
    ]


def _watch(expressions: list[str]) -> list[Rule]:
    return [
        _allow("egress", ["liveliness_token"], expressions),
        _allow("ingress", ["declare_liveliness_subscriber", "liveliness_query"], expressions),
    ]


def _allow(flow: str, messages: list[str], expressions: list[str]) -> Rule:
    return {"permission": "allow", "flows": [flow], "messages": messages, "key_exprs": expressions}

"""The reference pages of the documentation, made from the code: messages, events, faults, scenario keys, commands.

Pure: `pages` gives the text of every page. ``muster reference`` writes them, a test holds docs/reference against them.
"""

from __future__ import annotations

import argparse
import inspect
import re
from collections.abc import Iterator, Sequence
from typing import Any

import msgspec
from msgspec import inspect as types

from bus import events, faults, keys, messages
from bus.messages import acting, clock, common, envelope, helping, news, sharing, streams
from bus.scene import Fault
from ops import scenario
from ops.cli import parser
from ops.commands import COMMANDS
from ops.faultwords import usage
from reasoning.domain import domains, load
from reasoning.setup_help import reference

Struct = type[msgspec.Struct]

_COMMENT = re.compile(r"\s+# (.+)")
_KEY = re.compile(r'\s+"(\w+)":')
_BY_HAND = "<!-- Made by `muster reference`: change the code, not this page. -->\n"
_GROUPS = (acting, sharing, helping, news, common, streams, clock, envelope)
_TABLES: dict[str, Struct] = {
    table.__name__.lower(): table for table in (scenario.Clock, scenario.Verdict, scenario.Limits, scenario.Record)
}

_MESSAGES = """\
# Messages

Every type of `bus.messages`, schema version {version}. On the wire a message is msgpack: a struct is a map from names
to values, a body has its own name under `type`. Unknown fields, wrong types and infinite numbers are refused.
A *name* has 1 to 64 characters, a *text* at most 2000. A field with a default may be left out.
How the messages play together: [architecture](../architecture.md).

## Keys
"""
_EVENTS = """\
# Events

What is recorded, and what the verdict of a scenario looks at (`eventually`, `never`). Every event has `text`, one
sentence for people, besides the fields named here. In a pattern `source` is the process that said it.
"""
_FAULTS = """\
# Disturbances

The closed vocabulary of `muster inject KIND TARGET NAME=VALUE ...` and of `[[fault]]` in scenario files. What is not
in this table is refused, with the list of what is. A robot, a body and an object are written TEAM.NAME (`T4.c1`,
`T1.2`); a link is a process (all that it sends), FROM>TO, or `*`.
"""
_ARGUMENTS = """\
Exactly one trigger is given. Every other key of the table is an argument of the kind:

```toml
[[fault]]
at_step = 3
kind = "pause"
target = "T1"
for_s = 20.0
```
"""
_SCENARIO = """\
# Scenario files

TOML. Some keys are the same for every domain; the set-up (`[teams.NAME]`, and what else the domain knows) is the
domain's own. How to write a scenario: [how-to](../howto-scenario.md).
"""
_TOP = {
    "story": "what happens here, in a sentence or two",
    "plan": "a plan file to execute first, named from the scenario's folder or the domain's",
}


def pages() -> dict[str, str]:
    """File name -> text."""
    made = [
        ("messages", _messages),
        ("events", _events),
        ("faults", _faults),
        ("scenario", _scenario),
        ("cli", _commands),
    ]
    return {f"{name}.md": _BY_HAND + "\n".join(lines()).rstrip() + "\n" for name, lines in made}


# ---------------------------------------------------------------- messages
def _messages() -> Iterator[str]:
    yield _MESSAGES.format(version=messages.SCHEMA_VERSION)
    functions = [value for value in vars(keys).values() if inspect.isfunction(value) and value is not keys.last]
    called = {function: [name.upper() for name in inspect.signature(function).parameters] for function in functions}
    yield from _table(["key", "carries"], [[f"`{f(*names)}`", _doc(f)] for f, names in called.items()])
    section = ""
    for struct, here in _structs():
        if here != section:
            section = here
            yield f"## {section}\n"
        yield f"### {struct.__name__}\n\n{_doc(struct) or _answers(struct)}\n"
        yield from _table(["field", "type", "default"], [[f"`{n}`", t, _default(d)] for n, t, d in _typed(struct)])


def _structs() -> Iterator[tuple[Struct, str]]:
    """All structs of `bus.messages` in their order, each with the section that it stands in."""
    for group in _GROUPS:
        for struct in vars(group).values():
            own = inspect.isclass(struct) and struct.__module__ == group.__name__
            if own and issubclass(struct, msgspec.Struct):
                yield struct, _doc(group).partition(":")[0].rstrip(".")


def _answers(struct: Struct) -> str:
    """What to say of a reply that has no words of its own."""
    asked = [s.__name__ for s, _ in _structs() if f"Reply: `{struct.__name__}`" in _doc(s)]
    return f"Reply to {', '.join(f'[{name}](#{name.lower()})' for name in asked)}."


def _typed(struct: Struct) -> Iterator[tuple[str, str, str | None]]:
    """Name, type in words and default of every field; None: it must be given."""
    info = types.type_info(struct)
    assert isinstance(info, types.StructType)
    for field in info.fields:
        default = field.default if field.default_factory is msgspec.NODEFAULT else field.default_factory()
        unset = field.required or default is None or isinstance(default, msgspec.Struct)
        plain = "" if unset else msgspec.json.encode(default).decode()
        yield field.encode_name, _words(field.type), None if field.required else plain


def _default(default: str | None) -> str:
    return "required" if default is None else f"`{default}`" if default else "none"


def _words(info: types.Type) -> str:
    """A type in words."""
    match info:
        case types.IntType() | types.FloatType():
            return ("integer" if isinstance(info, types.IntType) else "number") + _limits(info)
        case types.StrType(min_length=1, max_length=64):
            return "name"
        case types.StrType(max_length=2000):
            return "text"
        case types.StrType():
            return "string"
        case types.BytesType():
            return "bytes"
        case types.BoolType():
            return "true or false"
        case types.LiteralType(values=values):
            return ", ".join(f"`{value}`" if value else '`""`' for value in values)
        case types.VarTupleType(item_type=item):
            return f"list of {_words(item)}"
        case types.DictType(key_type=key, value_type=value):
            return f"map from {_words(key)} to {_words(value)}"
        case types.StructType(cls=struct) if hasattr(messages, struct.__name__):
            return f"[{struct.__name__}](#{struct.__name__.lower()})"
        case types.UnionType(types=options):
            return " or ".join(_words(option) for option in options if not isinstance(option, types.NoneType))
        case _:
            return "anything"


def _limits(info: types.IntType | types.FloatType) -> str:
    said = {"at least": info.ge, "more than": info.gt, "at most": info.le, "less than": info.lt}
    bounds = [f"{words} {bound:g}" for words, bound in said.items() if bound is not None]
    return f", {' and '.join(bounds)}" if bounds else ""


# ---------------------------------------------------------------- events and faults
def _events() -> Iterator[str]:
    yield _EVENTS
    rows: dict[str, list[list[str]]] = {}
    source = ""
    for line in inspect.getsource(events).splitlines():  # who says an event stands in comments
        if comment := _COMMENT.match(line):
            source = comment[1]
        elif key := _KEY.match(line):
            rows.setdefault(source, []).append([f"`{key[1]}`", events.KINDS[key[1]]])
    for source, found in rows.items():
        yield f"## Said by: {source}\n"
        yield from _table(["event", "fields"], found)


def _faults() -> Iterator[str]:
    yield _FAULTS
    rows = [[f"`{usage(kind, known)}`", known.help] for kind, known in faults.KINDS.items()]
    yield from _table(["usage", "what happens"], rows)
    yield f"## In a scenario file\n\n{_doc(Fault)}\n"
    fields = [(n, t, "required" if d is None else "a trigger") for n, t, d in _typed(Fault) if n != "args"]
    yield from _table(["key", "type", ""], [[f"`{n}`", t, d] for n, t, d in fields])
    yield _ARGUMENTS


def _scenario() -> Iterator[str]:
    yield f"{_SCENARIO}\n## At the top\n"
    rows = [[f"`{n}`", t, _default(d), _TOP.get(n, "")] for n, t, d in _typed(scenario._File) if n not in _TABLES]
    yield from _table(["key", "type", "default", ""], rows)
    for name, struct in _TABLES.items():
        yield f"## [{name}]\n\n{_doc(struct)}\n"
        yield from _table(["key", "type", "default"], [[f"`{n}`", t, _default(d)] for n, t, d in _typed(struct)])
    yield "## [[fault]]\n\nWhat goes wrong, and when: [disturbances](faults.md).\n"
    for name in domains():
        domain = load(name)
        yield f"## Domain {name}: set-up\n\n{domain.data.story}\n"
        helps = [(h.key, f"{h.type} {h.limits}".strip(), h.default or None, h.help) for h in reference(domain)]
        yield from _table(["key", "type", "default", ""], [[f"`{k}`", t, _default(d), text] for k, t, d, text in helps])
        yield f"## Domain {name}: actions\n\nAs plans and `on_action` write them, and the world's skill behind each.\n"
        rows = [[f"`{n}`", ", ".join(a["args"]), f"`{a['skill']}`"] for n, a in domain.data.actions.items()]
        yield from _table(["action", "arguments", "skill"], rows)
        yield f"## Domain {name}: rules\n\nWhat `muster check` finds. {{0}}, {{1}} ... are bodies and numbers.\n"
        yield from _table(["rule", "what is wrong"], [[f"`{rule}`", text] for rule, text in domain.data.rules.items()])


def _commands() -> Iterator[str]:
    yield f"# Commands\n\n`muster COMMAND --help` says the same.\n\n{parser().epilog}"
    yield from _table(["command", ""], [[f"[{name}](#muster-{name})", text] for name, text in COMMANDS.items()])
    for name, text in COMMANDS.items():
        yield f"## muster {name}\n\n{text[0].upper()}{text[1:]}{'' if text.endswith('?') else '.'}\n"
        subparsers = next(a for a in parser(name)._actions if isinstance(a, argparse._SubParsersAction))
        sub: argparse.ArgumentParser = subparsers.choices[name]
        actions = [action for action in sub._actions if not isinstance(action, argparse._HelpAction)]
        rows = [[f"`{_written(action)}`", (action.help or "") % vars(action)] for action in actions]
        yield from _table(["argument", ""], rows)
        if sub.epilog:
            yield f"```text\n{sub.epilog.rstrip()}\n```\n"


def _written(action: argparse.Action) -> str:
    metavar = str(action.metavar or action.dest.upper()) if action.nargs != 0 else ""
    return " ".join(filter(None, [", ".join(action.option_strings), metavar])) + (" ..." if action.nargs == "*" else "")


# ---------------------------------------------------------------- markdown
def _doc(thing: Any) -> str:
    """A docstring as paragraphs; nothing for one that nobody wrote."""
    own = vars(thing).get("__doc__") if inspect.isclass(thing) else thing.__doc__
    return "\n\n".join(" ".join(part.split()) for part in inspect.cleandoc(own or "").replace("``", "`").split("\n\n"))


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    for row in (head, ["---"] * len(head), *rows) if rows else ():
        yield f"| {' | '.join(cell.replace('|', '&#124;') for cell in row)} |"
    yield ""

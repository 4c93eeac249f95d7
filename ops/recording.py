"""Recordings: an MCAP file a run, JSON inside, one channel a stream. Written by `ops.recorder`, read by everybody else.

Chunks are small and reach the disk as they fill, so a recording that a crash cut off is readable up to its last
chunk. A recorder that had to be restarted goes on in a further part (``run.1.mcap``); `load` reads all parts as one.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec
from mcap.records import Channel, Footer, Message
from mcap.stream_reader import StreamReader
from mcap.writer import Writer as McapWriter
from msgspec import inspect

from bus.messages import Beat, Envelope, Event, Frame, Status
from bus.scene import Scene

CHUNK_BYTES = 32 * 1024
PROFILE = "muster"

# Data of an event that may differ between two runs that are otherwise the same: who ran it, and how long it took.
VOLATILE = frozenset({"incarnation", "pid", "seconds", "command"})


class SourceCount(msgspec.Struct, frozen=True):
    """What became of the events of one source in one incarnation. `sent` is the source's own word for its last
    number (-1: it could not be asked), `received` counts arrivals with repetitions, `recorded` what is in the file."""

    source: str
    incarnation: int
    sent: int
    received: int
    recorded: int
    missing: tuple[int, ...] = ()


class Summary(msgspec.Struct, frozen=True):
    """The recorder's last word; a recording without one was cut off."""

    run: str
    sources: tuple[SourceCount, ...] = ()
    refused: int = 0


STREAMS: dict[str, type] = {
    "event": Event, "status": Status, "frame": Frame, "beat": Beat, "scene": Scene, "summary": Summary
}  # fmt: skip


@dataclass(frozen=True)
class Recording:
    """A run as it was recorded. `events` are in canonical order and without repetitions; the other streams in the
    order of simulated time. `complete` is false when the end is missing, `unreadable` counts records skipped."""

    run: str = ""
    scene: Scene | None = None
    events: tuple[Envelope, ...] = ()
    frames: tuple[Envelope, ...] = ()
    statuses: tuple[Envelope, ...] = ()
    beats: tuple[Envelope, ...] = ()
    summary: Summary | None = None
    complete: bool = False
    unreadable: int = 0

    def everything(self) -> list[Envelope]:
        """All envelopes in the order of simulated time, events first: a state shown is the one after them.

        Without the frames of a world that died before its next life began anew at an earlier moment.
        """
        begins: dict[int, float] = {}
        for frame in self.frames:
            begins[frame.inc] = min(frame.at_s, begins.get(frame.inc, frame.at_s))
        valid = tuple(f for f in self.frames if not any(i > f.inc and at_s <= f.at_s for i, at_s in begins.items()))
        streams = (self.events, self.statuses, self.beats, valid)
        return sorted((e for stream in streams for e in stream), key=lambda e: e.at_s)


def load(path: str | Path) -> Recording:
    """The recording in a directory (all its parts) or in one file.

    Raises FileNotFoundError when there is none. A damaged or cut-off file gives what can be read.
    """
    path = Path(path)
    parts = parts_of(path) if path.is_dir() else [path]
    if not parts or not parts[0].is_file():
        raise FileNotFoundError(f"no recording in {path}: expected run.mcap")
    pile = _Pile()
    complete = [pile.read(part) for part in parts]
    return pile.recording(complete[-1])


def parts_of(directory: Path) -> list[Path]:
    """The files of the recording in a directory, first part first."""
    numbered = [p for p in directory.glob("run.*.mcap") if p.name.split(".")[1].isdigit()]
    first = [p for p in (directory / "run.mcap",) if p.is_file()]
    return first + sorted(numbered, key=lambda p: int(p.name.split(".")[1]))


def event_stream(recording: Recording) -> list[tuple[float, str, str, str]]:
    """The events as (simulated time, source, kind, data), comparable between runs.

    Left out: whatever depends on the machine, and the supervisor, which lives by the wall clock.
    """
    out = []
    for envelope in recording.events:
        event = envelope.body
        if isinstance(event, Event) and event.kind != "process":
            data = {k: v for k, v in event.data.items() if k not in VOLATILE}
            text = msgspec.json.encode(data, order="sorted").decode()
            out.append((envelope.at_s, envelope.src, event.kind, text))
    return out


def canonical(envelope: Envelope) -> tuple[float, int, str, int, int]:
    """The key that puts events into the same order on every run."""
    return envelope.at_s, envelope.round, envelope.src, envelope.inc, envelope.seq


@dataclass
class _Pile:
    """What was read so far, over all parts."""

    envelopes: dict[str, list[Envelope]] = field(default_factory=lambda: {s: [] for s in STREAMS})
    seen: set[tuple[str, int, int]] = field(default_factory=set)
    scene: Scene | None = None
    summary: Summary | None = None
    unreadable: int = 0

    def read(self, path: Path) -> bool:
        """Take in one file; true when its end was reached in good order."""
        with path.open("rb") as stream:
            topics: dict[int, str] = {}
            try:
                for record in StreamReader(stream, validate_crcs=True, record_size_limit=1 << 28).records:
                    if isinstance(record, Channel):
                        topics[record.id] = record.topic.removeprefix("/")
                    elif isinstance(record, Message):
                        self._take(topics.get(record.channel_id, ""), record.data)
                    elif isinstance(record, Footer):
                        return True
            except Exception:  # a torn tail makes the unpackers fail in any way; all before it has been kept
                return False
        return False

    def _take(self, topic: str, data: bytes) -> None:
        try:
            if topic == "scene":
                self.scene = msgspec.json.decode(data, type=Scene)
            elif topic == "summary":
                self.summary = msgspec.json.decode(data, type=Summary)
            elif topic in STREAMS:
                self._keep(topic, msgspec.json.decode(data, type=Envelope))
        except (msgspec.DecodeError, RecursionError):
            self.unreadable += 1

    def _keep(self, topic: str, envelope: Envelope) -> None:
        if topic == "event":
            name = (envelope.src, envelope.inc, envelope.seq)
            if name in self.seen:
                return
            self.seen.add(name)
        if isinstance(envelope.body, STREAMS[topic]):
            self.envelopes[topic].append(envelope)

    def recording(self, complete: bool) -> Recording:
        piles = self.envelopes
        first = next((e for pile in piles.values() for e in pile), None)
        by_time = {s: tuple(sorted(piles[s], key=lambda e: e.at_s)) for s in ("frame", "status", "beat")}
        return Recording(
            run=first.run if first else self.summary.run if self.summary else "",
            scene=self.scene,
            events=tuple(sorted(piles["event"], key=canonical)),
            frames=by_time["frame"],
            statuses=by_time["status"],
            beats=by_time["beat"],
            summary=self.summary if complete else None,
            complete=complete,
            unreadable=self.unreadable,
        )


class Writer:
    """One MCAP file being written. `log_time` is simulated time."""

    def __init__(self, path: Path) -> None:
        """Raises FileExistsError: a recording is never written over."""
        self._file = path.open("xb")
        self._mcap: Any = McapWriter(self._file, chunk_size=CHUNK_BYTES)
        self._mcap.start(profile=PROFILE, library="muster")
        self._channels: dict[str, int] = {}
        self._now_s = 0.0
        for stream, kind in STREAMS.items():
            body = _schema(inspect.type_info(kind)) or {}
            shape = body if stream in ("scene", "summary") else _envelope_schema(body)
            schema = self._mcap.register_schema(f"muster.{kind.__name__}", "jsonschema", msgspec.json.encode(shape))
            self._channels[stream] = self._mcap.register_channel(f"/{stream}", "json", schema)

    def add(self, stream: str, message: Envelope | Scene | Summary) -> None:
        sequence = 0
        if isinstance(message, Envelope):
            self._now_s, sequence = message.at_s, message.seq
        log_time = int(self._now_s * 1e9)
        self._mcap.add_message(
            self._channels[stream], log_time, msgspec.json.encode(message), log_time, sequence & 0xFFFFFFFF
        )

    def flush(self) -> None:
        """Close the chunk in progress: what was added so far survives a crash of this process."""
        self._mcap.flush()

    def close(self) -> None:
        self._mcap.finish()
        self._file.close()


def _envelope_schema(body: dict[str, Any]) -> dict[str, Any]:
    shape = _schema(inspect.type_info(Envelope)) or {}
    properties: dict[str, Any] = shape["properties"]
    return {"type": "object", "title": "Envelope", "properties": {**properties, "body": body}}


def _schema(kind: inspect.Type) -> dict[str, Any] | None:
    """JSON schema in the small subset that Foxglove takes: no references, no alternatives, no arrays of arrays.
    What does not fit is left out of the schema; the data has it all the same."""
    match kind:
        case inspect.StructType(cls=cls, fields=fields):
            known = {f.encode_name: s for f in fields if (s := _schema(f.type)) is not None}
            return {"type": "object", "title": cls.__name__, "properties": known}
        case inspect.VarTupleType(item_type=item) | inspect.ListType(item_type=item):
            items = _schema(item)
            return None if items is None or items["type"] == "array" else {"type": "array", "items": items}
        case inspect.IntType():
            return {"type": "integer"}
        case inspect.FloatType():
            return {"type": "number"}
        case inspect.BoolType():
            return {"type": "boolean"}
        case inspect.StrType():
            return {"type": "string"}
        case inspect.LiteralType(values=values) if all(isinstance(v, str) for v in values):
            return {"type": "string"}
        case inspect.DictType():
            return {"type": "object", "properties": {}}
    return None

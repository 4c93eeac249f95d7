"""Recordings: what is written is read, in canonical order, also from files that were cut off anywhere."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest
from mcap.reader import make_reader

from bus.messages import Envelope, Event
from bus.scene import Scene
from ops.recording import CHUNK_BYTES, Recording, Summary, Writer, canonical, event_stream, load
from tests.ops.synthetic import recording, story

SAID = list(story(4))
STREAM_OF = {"Event": "event", "Status": "status", "Frame": "frame", "Beat": "beat"}


def write(path: Path, said: list[Scene | Envelope], close: bool = True) -> Writer:
    writer = Writer(path)
    for message in said:
        writer.add("scene" if isinstance(message, Scene) else STREAM_OF[type(message.body).__name__], message)
    if close:
        writer.add("summary", Summary("made-up"))
        writer.close()
    return writer


def events_of(said: list[Scene | Envelope]) -> list[Envelope]:
    return [m for m in said if isinstance(m, Envelope) and isinstance(m.body, Event)]


def test_what_was_written_is_read(tmp_path: Path) -> None:
    write(tmp_path / "run.mcap", SAID)
    got, expected = load(tmp_path), recording(4)
    assert got == msgspec_like(expected, got)
    assert got.complete
    assert got.events == tuple(sorted(events_of(SAID), key=canonical))
    assert [e.at_s for e in got.everything()] == sorted(e.at_s for e in got.everything())


def test_a_replay_leaves_out_what_a_world_did_that_died_before_it_counted() -> None:
    run = recording(1, 5)
    first, second = run.frames[:6], [msgspec.structs.replace(f, inc=2) for f in run.frames[4:]]
    again = Recording(frames=(*first, *second)).everything()
    assert again == [*first[:3], *second]


def msgspec_like(expected: Recording, got: Recording) -> Recording:
    """`expected` with the summary of `got`: the two were summed up by different people."""
    return Recording(**{**expected.__dict__, "summary": got.summary})


@pytest.mark.slow
def test_a_file_cut_off_anywhere_is_readable_up_to_there(tmp_path: Path) -> None:
    whole = tmp_path / "run.mcap"
    write(whole, SAID)
    data = whole.read_bytes()
    cut = tmp_path / "cut.mcap"
    counts = []
    everything = events_of(SAID)
    for size in range(0, len(data) + 1, max(len(data) // 60, 1)):
        cut.write_bytes(data[:size])
        got = load(cut)
        assert all(e in everything for e in got.events)
        assert not got.complete
        assert got.summary is None
        counts.append(len(got.events))
    assert counts == sorted(counts)
    assert counts[0] == 0
    assert counts[len(counts) // 2] > 0
    assert counts[-1] > 0.9 * len(events_of(SAID))


def test_a_writer_that_never_closes_loses_at_most_its_last_chunk(tmp_path: Path) -> None:
    writer = write(tmp_path / "run.mcap", SAID, close=False)
    writer.flush()
    got = load(tmp_path)
    assert len(got.events) == len(events_of(SAID))
    assert not got.complete
    bare = write(tmp_path / "run.1.mcap", SAID, close=False)
    unwritten = len(events_of(SAID)) - len(load(tmp_path / "run.1.mcap").events)
    assert unwritten * 60 < 2 * CHUNK_BYTES
    for one in (writer, bare):
        one.close()


def test_garbage_is_skipped_or_ends_the_reading_but_never_raises(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    write(path, SAID)
    data = bytearray(path.read_bytes())
    for place in range(0, len(data), max(len(data) // 50, 1)):
        spoiled = bytearray(data)
        spoiled[place : place + 4] = b"\xff\x00\xff\x00"
        path.write_bytes(spoiled)
        load(path)
    path.write_bytes(b"no recording at all")
    assert load(path) == Recording()


def test_parts_are_read_as_one_and_repetitions_once(tmp_path: Path) -> None:
    half = len(SAID) // 2
    first = write(tmp_path / "run.mcap", SAID[: half + 20], close=False)
    first.flush()
    write(tmp_path / "run.1.mcap", SAID[half:])
    got = load(tmp_path)
    first.close()
    assert got.complete
    assert got.events == tuple(sorted(events_of(SAID), key=canonical))


def test_no_recording_is_said(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"run\.mcap"):
        load(tmp_path)
    write(tmp_path / "run.mcap", [])
    with pytest.raises(FileExistsError):
        Writer(tmp_path / "run.mcap")


def test_event_streams_of_two_runs_are_equal_but_for_what_the_machine_decides() -> None:
    one = recording(4)
    other = Recording(events=tuple(
        msgspec.structs.replace(e, run="again", inc=e.inc + 1, id="x", round=0) for e in one.events
    ))  # fmt: skip
    assert event_stream(one) == event_stream(other)
    fewer = Recording(events=one.events[:-1])
    assert event_stream(one) != event_stream(fewer)


def test_foxglove_finds_schemas_that_it_takes(tmp_path: Path) -> None:
    """A plain reader sees JSON with object schemas, without references, alternatives and arrays of arrays."""
    write(tmp_path / "run.mcap", SAID)
    with (tmp_path / "run.mcap").open("rb") as stream:
        topics = set()
        for schema, channel, message in make_reader(stream).iter_messages():
            topics.add(channel.topic)
            assert (channel.message_encoding, schema and schema.encoding) == ("json", "jsonschema")
            msgspec.json.decode(message.data)
            assert schema is not None
            shape = msgspec.json.decode(schema.data)
            assert shape["type"] == "object"
            assert_simple(shape)
    assert topics == {"/event", "/status", "/frame", "/beat", "/scene", "/summary"}


def assert_simple(shape: dict) -> None:  # type: ignore[type-arg]
    assert not {"$ref", "anyOf", "oneOf", "$defs"} & shape.keys()
    assert shape["type"] in ("object", "array", "string", "integer", "number", "boolean")
    if shape["type"] == "array":
        assert shape["items"]["type"] != "array"
        assert_simple(shape["items"])
    for inner in shape.get("properties", {}).values():
        assert_simple(inner)

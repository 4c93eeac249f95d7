"""``python -m world``: the world's process. Its setup file is a scene (`bus.scene.Scene`) in JSON."""

from __future__ import annotations

import sys

import msgspec

from bus import keys
from bus.clock import run_world
from bus.codec import encode
from bus.node import arguments, open_node
from bus.scene import Scene
from world.simulation import World


def main(argv: list[str] | None = None) -> int:
    """Run the world until it is stopped. Exit codes: 0 stopped, 2 wrong options or setup file."""
    config = arguments(argv, name=keys.WORLD)
    if config.setup is None:
        print("the world needs a scene: --setup FILE", file=sys.stderr)
        return 2
    try:
        scene = msgspec.json.decode(config.setup.read_bytes(), type=Scene)
    except (OSError, msgspec.DecodeError) as error:
        print(f"{config.setup}: {error}", file=sys.stderr)
        return 2
    with open_node(config) as node:
        node.transport.keep(keys.truth_scene(node.run), encode(scene))
        world = World(node, scene)
        run_world(
            node,
            world,
            participants=world.participants,
            mode=config.mode,
            factor=config.factor,
            start_s=world.now_s,
            on_contact=world.on_contact,
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""The terminal dashboard: `watch` a running system; `Feed` and `show` for those who hold a bus already (`muster run`).

`model` folds messages into a value, `layout.render` draws that value, `screen` owns the terminal. All words and
glyphs come from the scene, so a new domain needs nothing in here.
"""

from ops.dashboard.feed import Feed, watch
from ops.dashboard.layout import render
from ops.dashboard.model import Model, update
from ops.dashboard.screen import Picture, show

__all__ = ["Feed", "Model", "Picture", "render", "show", "update", "watch"]

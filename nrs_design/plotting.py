"""The one way in to matplotlib: without a settings file that lies about.

While it is imported, matplotlib reads ``matplotlibrc`` from the working directory, ahead of any
other: in a folder of somebody else's it would read what they wrote, or wait for a pipe. So it is
imported in the folder of its own settings, here, and nowhere else: whoever needs something of it
imports that from this module. python-control, which imports matplotlib, is `control_library`.
"""

from __future__ import annotations

import contextlib
from importlib.util import find_spec
from pathlib import Path

_found = find_spec("matplotlib")
assert _found is not None
assert _found.origin is not None
with contextlib.chdir(Path(_found.origin).with_name("mpl-data")):
    from matplotlib import get_data_path, style
    from matplotlib.collections import QuadMesh
    from matplotlib.colors import to_rgba
    from matplotlib.figure import Figure
    from matplotlib.font_manager import findfont
    from matplotlib.ft2font import FT2Font
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch, Rectangle
    from matplotlib.text import Text
    from matplotlib.ticker import (
        FixedFormatter,
        Formatter,
        LogFormatter,
        MaxNLocator,
        ScalarFormatter,
    )

__all__ = [
    "FT2Font",
    "Figure",
    "FixedFormatter",
    "Formatter",
    "Line2D",
    "LogFormatter",
    "MaxNLocator",
    "Patch",
    "QuadMesh",
    "Rectangle",
    "ScalarFormatter",
    "Text",
    "findfont",
    "get_data_path",
    "style",
    "to_rgba",
]

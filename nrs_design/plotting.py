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

_matplotlib = find_spec("matplotlib")
assert _matplotlib is not None
assert _matplotlib.origin is not None
with contextlib.chdir(Path(_matplotlib.origin).with_name("mpl-data")):
    from matplotlib import get_data_path as get_data_path
    from matplotlib import style as style
    from matplotlib.collections import QuadMesh as QuadMesh
    from matplotlib.colors import to_rgba as to_rgba
    from matplotlib.figure import Figure as Figure
    from matplotlib.font_manager import findfont as findfont
    from matplotlib.ft2font import FT2Font as FT2Font
    from matplotlib.lines import Line2D as Line2D
    from matplotlib.patches import Patch as Patch
    from matplotlib.patches import Rectangle as Rectangle
    from matplotlib.text import Text as Text
    from matplotlib.ticker import FixedFormatter as FixedFormatter
    from matplotlib.ticker import Formatter as Formatter
    from matplotlib.ticker import LogFormatter as LogFormatter
    from matplotlib.ticker import MaxNLocator as MaxNLocator
    from matplotlib.ticker import ScalarFormatter as ScalarFormatter

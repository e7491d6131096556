"""The one way in to matplotlib: without a settings file that lies about."""

from __future__ import annotations

import contextlib
import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path


def load_matplotlib() -> None:
    """Import matplotlib with its own settings, before anything else imports it.

    While it is imported, matplotlib reads ``matplotlibrc`` from the working directory, ahead of
    any other: in a folder of somebody else's it would read what they wrote, or wait for a pipe.
    So it is imported in the folder of its own settings. python-control imports it, too.
    """
    if "matplotlib" in sys.modules:
        return
    spec = find_spec("matplotlib")
    assert spec is not None
    assert spec.origin is not None
    with contextlib.chdir(Path(spec.origin).with_name("mpl-data")):
        import_module("matplotlib")

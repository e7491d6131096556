"""Reports of every verdict and kind, made once for a session."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from nrs_design.pipeline import run_certification, run_evidence
from nrs_design.reporting import Report, build_report
from nrs_design.spec import read_spec

ROOT = Path(__file__).parents[2]
HOSTILE = """<script>alert(1)</script> & "it's" {{ 7*7 }} $x_1$ <b>bold</b>"""

# Dayawansa and Martin (1999): above 3 + 2 sqrt 2 no common quadratic function exists.
INCONCLUSIVE = """\
kind: switched-system
name: no-quadratic
time: continuous
modes:
  - {name: a, A: [[-1, -1], [1, -1]]}
  - {name: b, A: [[-1, -7], ["1/7", -1]]}
switching: arbitrary
"""
_TITLE = HOSTILE.replace("'", "''")
DISCRETE = f"""\
kind: switched-system
name: sampled
title: '{_TITLE}'
time: discrete
modes:
  - {{name: a, A: [["0.8", "0.3"], ["-0.3", "0.7"]]}}
  - {{name: b, A: [["0.5", 0], ["0.1", "-0.4"]]}}
switching: arbitrary
"""
# A rotation by 90 degrees: exactly on the unit circle.
MARGINAL = """\
kind: switched-system
name: rotation
time: discrete
modes:
  - {name: a, A: [["0.5", 0], [0, "0.5"]]}
  - {name: turn, A: [[0, -1], [1, 0]]}
switching: arbitrary
"""


def report_of(path: Path) -> Report:
    """Take a spec all the way to its report."""
    loaded = read_spec(path)
    result = run_certification(loaded)
    return build_report(result, run_evidence(loaded, result.design) if result.design else None)


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Report]:
    """Give the report of a case by its name, each made once."""
    folder = tmp_path_factory.mktemp("specs")
    texts = {"inconclusive": INCONCLUSIVE, "discrete": DISCRETE, "marginal": MARGINAL}
    paths = {
        "proved": ROOT / "specs/neuroboscope/soft-tissue.nrs.yaml",
        "force": ROOT / "specs/neuroboscope/force-limit.nrs.yaml",
        "refuted": ROOT / "docs/examples/thesis-print-error.nrs.yaml",
    }
    for name, text in texts.items():
        paths[name] = folder / f"{name}.nrs.yaml"
        paths[name].write_text(text, encoding="utf-8")
    made: dict[str, Report] = {}

    def get(name: str) -> Report:
        if name not in made:
            made[name] = report_of(paths[name])
        return made[name]

    return get

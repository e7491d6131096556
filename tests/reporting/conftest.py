"""Reports of every verdict and kind, made once for a session."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest

from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_certification
from nrs_design.reporting import Report, build_report, render_html
from nrs_design.search.certification import Limits
from nrs_design.spec import LoadedSpec, read_spec
from tests.support import ROOT, SOFT_TISSUE

HOSTILE = """<script>alert(1)</script> & "it's" {{ 7*7 }} $x_1$ <b>bold</b>"""

# Geromel and Colaneri (2006): proved from 2.751 s on, unstable up to 2.707 s.
_DWELL = """\
time: continuous
modes:
  - {{name: a, A: [[0, 1], [-10, -1]]}}
  - {{name: b, A: [[0, 1], ["-1/10", "-1/2"]]}}
switching: {{dwell_time: {} s}}
"""
# Dayawansa and Martin (1999): no quadratic function above 5.83, unstable from 11.27 on.
_PAIR = """\
time: continuous
modes:
  - {{name: a, A: [[-1, -1], [1, -1]]}}
  - {{name: b, A: [[-1, -{0}], ["1/{0}", -1]]}}
switching: arbitrary
"""
KINDS = {
    "inconclusive": _DWELL.format("2.72"),
    # Nearly the same stays as in a signal that grows, and a mode that is unstable by itself.
    "inconclusive-leaving": """\
time: continuous
modes:
  - {name: a, A: [[1]]}
  - {name: b, A: [[-1]]}
switching: {dwell_time: {b: 1 s}, longest_dwell_time: {a: 1 s}}
""",
    "dwell": _DWELL.format("2.76"),
    "dwell-refuted": _DWELL.format("2.7"),
    "polynomial": _PAIR.format(6),
    "period": _PAIR.format(12),
    # Two shears, whose mean has the eigenvalue 4.
    "mixture": """\
time: continuous
modes:
  - {name: a, A: [[-1, 10], [0, -1]]}
  - {name: b, A: [[-1, 0], [10, -1]]}
switching: arbitrary
""",
    "resets": """\
time: continuous
modes:
  - {name: full, A: [[0, 1], [-3, -1]]}
  - {name: slow, A: [[-1]]}
resets:
  - {from: full, to: slow, map: [["1/2", 0]]}
  - {from: slow, to: full, map: [["1/2"], [0]]}
switching: arbitrary
""",
    "unequal": """\
time: continuous
modes:
  - {name: slow, A: [[-1]]}
  - {name: full, A: [[0, 1], [-3, "0.1"]]}
resets:
  - {from: full, to: slow, map: [["1/2", 0]]}
  - {from: slow, to: full, map: [["1/2"], [0]]}
switching: arbitrary
""",
    # An oscillator whose stiffness is unknown, beyond the 6.98 up to which it may change.
    "parameter": """\
time: continuous
parameters:
  k: {nominal: 5, range: [0, 30], varies: false}
modes:
  - {name: m, A: [[0, 1], [-2 - k, -1]]}
switching: arbitrary
""",
    "blocks": """\
time: continuous
modes:
  - {name: a, A: [[-1, -1, 3, 0], [1, -1, 0, 1], [0, 0, -2, 1], [0, 0, 0, -1]]}
  - {name: b, A: [[-1, -6, 0, 2], ["1/6", -1, 1, 0], [0, 0, -1, 0], [0, 0, 0, -3]]}
switching: arbitrary
""",
    # Above the golden ratio's 0.618 the product of the two grows.
    "word": """\
time: discrete
modes:
  - {name: a, A: [["0.7", "0.7"], [0, "0.7"]]}
  - {name: b, A: [["0.7", 0], ["0.7", "0.7"]]}
switching: arbitrary
""",
}
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
# Left to the slow tests; of each, the default session has a case that is nearly the same.
ALIKE = {"resets", "dwell-refuted"}


def slow(case: str) -> Any:
    return pytest.param(case, marks=pytest.mark.slow)


def cases(names: Iterable[str]) -> list[Any]:
    return [slow(name) if name in ALIKE else name for name in names]


def report_of(path: Path) -> Report:
    loaded = read_spec(path)
    # No case needs more, and the one without a verdict would try them all.
    result = run_certification(loaded, limits=Limits(max_degree=6))
    return build_report(result, run_analysis(result.designed) if result.designed else None)


def recorded(folder: Path, data: str, more: str) -> LoadedSpec:
    """Read the soft tissue with a record of some data behind its stiffness."""
    source = f"{{file: a.csv, sha256: {64 * 'a'}, data: {data}}}"
    told = f"    lever_arm: 0.24 m\n    provenance: [{source}]\n{more}"
    text = SOFT_TISSUE.read_text(encoding="utf-8").replace("    lever_arm: 0.24 m\n", told)
    (folder / "a.nrs.yaml").write_text(text, encoding="utf-8")
    return read_spec(folder / "a.nrs.yaml")


@pytest.fixture(scope="session")
def report(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Report]:
    folder = tmp_path_factory.mktemp("specs")
    texts = {"discrete": DISCRETE, "marginal": MARGINAL} | {
        name: f"kind: switched-system\nname: {name}\n{text}" for name, text in KINDS.items()
    }
    paths = {
        "proved": SOFT_TISSUE,
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


@pytest.fixture(scope="session")
def page(report: Callable[[str], Report]) -> Callable[[str], str]:
    made: dict[str, str] = {}

    def get(name: str) -> str:
        if name not in made:
            made[name] = render_html(report(name))
        return made[name]

    return get

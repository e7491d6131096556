"""Reports of every verdict and kind, made once for a session."""

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
from tests.tables import spec_text, table

HOSTILE = """<script>alert(1)</script> & "it's" {{ 7*7 }} $x_1$ <b>bold</b>"""

KINDS = table(Path(__file__).with_name("kinds.yaml"))
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
MARGINAL = spec_text("rotation")
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

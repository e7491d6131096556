"""What every result can do, and that every result of the library can do it."""

import inspect
import json

import matplotlib.text
import pytest

import nrs_design as nrs
from nrs_design import api
from nrs_design.errors import DesignError
from tests.support import ROOT, SOFT_TISSUE, document_of

# Settings and parts of results, beside what a verb returns.
PARTS = {"AuditCheck", "Counterexample", "FittedRange", "Study"}
RESULTS = {name for name in nrs.__all__ if inspect.isclass(getattr(api, name))} - PARTS
DATA = ROOT / "specs/data"


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    soft, study = nrs.load(SOFT_TISSUE), nrs.load(ROOT / "docs/examples/scenarios.nrs.yaml")
    decision = soft.certify()
    cert = decision.save(folder)
    simulation = study.simulate("shaken")
    log = folder / "run.csv"
    log.write_text(simulation[0].response.to_csv())
    found = [
        decision,
        soft.optimize(),
        simulation,
        simulation[0],
        study.worst_case(),
        soft.export(cert),
        soft.audit(log, cert),
        nrs.verify(cert, SOFT_TISSUE),
        nrs.identify(DATA / "silicone-soft-1.csv"),
        nrs.check_lyapunov([[[0, 1], [-2, -3]]], [[5, 1], [1, 1]]),
    ]
    return {type(one).__name__: one for one in found}


@pytest.mark.parametrize("kind", sorted(RESULTS))
def test_each_is_drawn_shown_and_told(results, kind):
    one = results[kind]
    assert json.dumps(one.to_dict(), allow_nan=False)
    shown = one._repr_html_()
    assert "<p>" in shown
    assert "<script" not in shown
    assert len(repr(one)) < 120
    assert "array(" not in str(one)
    if kind in ("Audit", "LyapunovCheck"):
        assert one.figures == ()
        return
    assert one.plot().get_size_inches()[0] > 5
    narrow = one.plot(width="ieee")
    assert narrow.get_size_inches()[0] == 3.5
    letters = [text.get_fontsize() for text in narrow.findobj(matplotlib.text.Text)]
    assert max(letters) <= 8


def test_a_figure_that_there_is_not(results):
    with pytest.raises(DesignError, match="no figure 'nope'") as caught:
        results["Simulation"].plot("nope")
    assert "shaken" in str(caught.value.remedy)


def test_there_are_two_widths():
    with pytest.raises(DesignError, match="no width 'wide'"):
        nrs.certify([[[-1]]]).plot(width="wide")


def test_what_is_rejected_has_nothing_to_draw(tmp_path):
    cert = nrs.certify([[[-1]]], name="one").save(tmp_path)
    cert.write_text(cert.read_text().replace('"name": "one"', '"name": "two"', 1))
    rejected = nrs.verify(cert)
    assert (rejected.verdict, bool(rejected), rejected.claims) == ("rejected", False, ())
    with pytest.raises(DesignError, match="nothing to draw"):
        rejected.plot()


def test_names_are_escaped_in_a_notebook():
    check = nrs.check_lyapunov({"<script>": [[1]]}, [[1]])
    assert "<script>" not in check._repr_html_()
    assert "&lt;script&gt;" in check._repr_html_()


def test_words_and_units_are_those_of_the_axis():
    """Of one that slides, in whichever verb and whichever method."""
    study = nrs.load(ROOT / "docs/examples/insertion-axis.nrs.yaml")
    worst = study.worst_case()
    assert "mm/s" in worst._repr_html_()
    (run,) = study.simulate()
    assert (run.units["torque"], run.units["depth"]) == ("N", "m")
    labels = [axes.get_ylabel() for axes in run.plot().axes]
    assert labels == ["Torque [N]", "Deflection [mm]", "Velocity [mm/s]"]
    optimum = study.optimize()
    assert optimum.to_dict()["controllers"][0]["units"]["Bt"] == "N*s/m"


RECORDS = [DATA / f"silicone-soft-{i}.csv" for i in (1, 2, 3)]
SCENARIOS = ROOT / "docs/examples/scenarios.nrs.yaml"
RUNS = ("--scenario", "shaken", "--scenario", "withdrawal-switched")


@pytest.mark.parametrize(
    ("ask", "command"),
    [
        (lambda: nrs.load(SOFT_TISSUE).optimize(), ("optimize", SOFT_TISSUE)),
        (lambda: nrs.identify(RECORDS), ("identify", "tissue", *RECORDS)),
        (
            lambda: nrs.load(SCENARIOS).simulate("shaken", "withdrawal-switched"),
            ("simulate", SCENARIOS, *RUNS, "--no-bound"),
        ),
    ],
    ids=["optimize", "identify", "simulate"],
)
def test_facts_are_those_of_the_command(ask, command):
    """But for goals of a certificate, which `optimize` of the library does not look at."""
    said = document_of(*command, cwd=ROOT, code=0)
    assert said.pop("schema")
    assert said.pop("certified", None) is None
    assert json.loads(json.dumps(ask().to_dict())) == said

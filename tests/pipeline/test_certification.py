import importlib
import re
from collections import Counter
from dataclasses import replace

import pytest

from nrs_design import __version__
from nrs_design.errors import CertificateError
from nrs_design.gating.run import Files, run_gate
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_certification, run_design, run_recorded
from nrs_design.search.certify import Limits, Verdict
from nrs_design.search.method import Method
from nrs_design.spec import read_spec
from tests.support import (
    COMMUTING,
    FORCE_LIMIT,
    HARD,
    PRINT_ERROR,
    ROBOT,
    ROOT,
    SOFT_TISSUE,
    holds,
    spec_in,
    write_spec,
)


@pytest.mark.parametrize(
    ("path", "verdict", "modes"),
    [
        (SOFT_TISSUE, Verdict.PROVED, 4),
        (ROBOT / "tissue-and-tool.nrs.yaml", Verdict.PROVED, 8),
        (FORCE_LIMIT, Verdict.PROVED, 3),
        (COMMUTING, Verdict.PROVED, 2),
        (PRINT_ERROR, Verdict.REFUTED, 2),
    ],
)
def test_all_the_way(path, verdict, modes):
    result = run_certification(read_spec(path))
    assert result.certification.verdict is verdict
    assert len(result.certification.system.modes) == modes
    assert holds(result.certification.system, result.certification.evidence)
    certificate = result.certificate
    assert certificate.version == __version__
    assert certificate.spec_sha256 == result.loaded.sha256


def test_a_design_names_its_coordinates():
    assert run_certification(read_spec(SOFT_TISSUE)).certificate.coordinates == "deflection"


def test_given_matrices_have_no_design():
    loaded = read_spec(COMMUTING)
    assert run_design(loaded) is None
    result = run_certification(loaded)
    found = result.certificate
    assert (result.design, found.coordinates, found.gains) == (None, None, {})


def calls_of(monkeypatch, **functions):
    """Count calls of functions of modules, named by where they are looked up."""
    calls = Counter()
    for name, places in functions.items():
        for place in places:
            module = importlib.import_module(f"nrs_design.{place}")
            monkeypatch.setattr(module, name, counting(calls, name, getattr(module, name)))
    return calls


def counting(calls, name, function):
    def counted(*arguments, **options):
        calls[name] += 1
        return function(*arguments, **options)

    return counted


@pytest.mark.slow
def test_a_gated_spec_is_built_once_and_optimized_once(tmp_path, monkeypatch):
    """Its page, too, shows what is at hand."""
    calls = calls_of(
        monkeypatch,
        # It is imported where it is called, so there is one place to look.
        build_plant=("spec.build_plant",),
        optimize_impedance=("design.constrained",),
        design_controllers=("design.analysis",),
    )
    outcome = run_gate([SOFT_TISSUE], Files(folder=tmp_path, html=True))
    assert outcome.severity == 0
    # One plant, and one optimum for each of the two controllers.
    assert calls == {"build_plant": 1, "design_controllers": 1, "optimize_impedance": 2}


def test_what_is_designed_is_assembled_without_a_detour_by_text(monkeypatch):
    calls = calls_of(
        monkeypatch, gains_of=("controllers.gains",), design_from_gains=("controllers.gains",)
    )
    result = run_certification(read_spec(SOFT_TISSUE), limits=Limits(optimize_rate=False))
    assert result.certification.verdict is Verdict.PROVED
    # The certificate quotes gains; only its re-check reads them.
    assert calls == {"gains_of": 1}


def test_the_design_keeps_the_optimum_it_found():
    designed = run_design(read_spec(SOFT_TISSUE))
    found = run_analysis(designed).impedance
    for controller, item in zip(designed.design.controllers, found, strict=True):
        assert item.optimum is controller.optimum
        assert item.optimum.Bt == pytest.approx(item.Bt, rel=5e-3)
        # What runs on the robot is the same, wherever the gains come from.
        assert controller == replace(controller, optimum=None)


def test_gains_that_are_given_have_no_optimum_to_keep(tmp_path):
    text = re.sub("Mt: {.*}", "Mt: 0.01 kg*m^2", SOFT_TISSUE.read_text())
    path = spec_in(tmp_path, re.sub("Bt: {.*}", "Bt: 2.5 N*m*s/rad", text), "fixed")
    designed = run_design(read_spec(path))
    assert [controller.optimum for controller in designed.design.controllers] == [None, None]
    for item in run_analysis(designed).impedance:
        assert (item.optimum.Mt, item.optimum.Bt) == (0.01, 2.5)


def test_no_certificate_without_a_statement(tmp_path):
    spec = write_spec(tmp_path / "eleven.yaml", *HARD)
    result = run_certification(spec, limits=Limits(budget=0.0))
    assert result.certification.verdict is Verdict.INCONCLUSIVE
    assert result.certificate is None


def test_certificate_of_a_remark_without_a_verdict(tmp_path):
    """That no quadratic function exists is worth keeping."""
    spec = write_spec(tmp_path / "eleven.yaml", *HARD)
    result = run_certification(spec, limits=Limits(max_degree=4))
    assert result.certification.verdict is Verdict.INCONCLUSIVE
    assert [item.kind for item in result.certificate.statements] == ["no-common-quadratic"]
    assert (result.certificate.verdict, result.certificate.evidence) == ("inconclusive", None)


@pytest.mark.slow
def test_method_and_progress():
    told = []
    result = run_certification(read_spec(COMMUTING), method=Method.GRADIENT, progress=told.append)
    assert result.certification.method == "gradient"
    assert told == ["design", "suspicious modes", "gradient"]


@pytest.mark.parametrize("path", [SOFT_TISSUE, COMMUTING])
def test_a_certificate_at_hand_takes_the_place_of_the_search(path, monkeypatch):
    """The shipped file claims what a search does, and nothing is searched.

    Its numbers may be others: processors add floats in another order.
    """
    loaded = read_spec(path)
    searched = run_certification(loaded)
    monkeypatch.setattr("nrs_design.search.certify.certify", None)
    recorded = run_recorded(loaded, ROOT / "reports" / f"{loaded.spec.name}.cert.json")
    shipped, found = recorded.certification.evidence, searched.certification.evidence
    assert shipped.kind == found.kind
    assert float(shipped.rate) == pytest.approx(float(found.rate), rel=1e-4)
    assert recorded.certification.verdict is Verdict.PROVED
    assert recorded.certification.rate_limit == searched.certification.rate_limit
    assert recorded.certification.common_quadratic is searched.certification.common_quadratic


def test_a_certificate_of_another_spec_or_altered_is_refused(tmp_path):
    loaded, shipped = read_spec(SOFT_TISSUE), ROOT / "reports"
    with pytest.raises(CertificateError, match="another spec"):
        run_recorded(loaded, shipped / "force-limit.cert.json")
    text = (shipped / "soft-tissue.cert.json").read_text(encoding="utf-8")
    altered = tmp_path / "altered.cert.json"
    altered.write_text(text.replace('"alpha = ', '"beta = ').replace("deflection", "force"))
    with pytest.raises(CertificateError):
        run_recorded(loaded, altered)

import pytest

from nrs_design import __version__
from nrs_design.errors import AssemblyError
from nrs_design.pipeline import run_certification, run_design
from nrs_design.search.certify import Limits, Method, Verdict
from nrs_design.spec import read_spec
from tests.support import (
    COMMUTING,
    FORCE_LIMIT,
    HARD,
    PRINT_ERROR,
    ROBOT,
    SOFT_TISSUE,
    holds,
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
    assert certificate.coordinates == result.coordinates


def test_given_matrices_have_no_design():
    loaded = read_spec(COMMUTING)
    assert run_design(loaded) is None
    result = run_certification(loaded)
    assert (result.design, result.coordinates, result.certificate.gains) == (None, None, {})


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


def test_coordinates_can_be_overridden():
    loaded = read_spec(SOFT_TISSUE)
    assert run_certification(loaded, limits=Limits(optimize_rate=False)).coordinates == "deflection"
    result = run_certification(loaded, coordinates="force", limits=Limits(optimize_rate=False))
    assert result.coordinates == "force"
    assert result.certification.system.states[-1] == "F [N*m]"
    with pytest.raises(AssemblyError, match="coordinates"):
        run_certification(read_spec(COMMUTING), coordinates="force")


def test_method_and_progress():
    told = []
    result = run_certification(read_spec(COMMUTING), method=Method.GRADIENT, progress=told.append)
    assert result.certification.method == "gradient"
    assert told == ["design", "suspicious modes", "gradient"]

"""`nrs-design simulate --worst-case`, as a user types it."""

import pytest

from tests.simulation.interactions import text_of
from tests.support import document_of, run

LAW = {"insertion": "{type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: 2.15 N*m*s/rad}"}
SOFT = {
    "soft": "{model: elastic, stiffness: {nominal: 43 N*m/rad, range: [40 N*m/rad, 46 N*m/rad]}}"
}
RUN = "command: {constant: 8 deg/s}, duration: 0.2 s, surfaces: [{environment: soft, at: 0.1 deg}]"


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "small.nrs.yaml"
    more = "contact: losable\ndisturbances: {command: 8 deg/s}\n"
    path.write_text(text_of(LAW, SOFT, scenario=RUN, more=more))
    return path


@pytest.mark.slow
def test_the_worst_case_beside_limits_and_bounds(spec, tmp_path):
    document = document_of("simulate", spec, "--worst-case", "--out", "runs", cwd=tmp_path, code=0)
    assert document["schema"] == "nrs-design/simulate/1"
    found = {item["output"]: item for item in document["worst_case"]["found"]}
    assert found.keys() == {"force", "velocity", "deflection"}
    for item in found.values():
        assert 0 < item["worst_found"] < item["certified_bound"]
        assert item["bound_over_found"] > 1
    assert found["force"]["exceeds_limit"] == (found["force"]["worst_found"] > 0.3)
    names = {f"small.worst-{name}.{s}" for name in found for s in ("csv", "svg", "png")}
    assert {path.name for path in (tmp_path / "runs").iterdir()} == names
    told = run("simulate", spec, "--worst-case", "--no-bound", cwd=tmp_path).stdout
    assert "worst found" in told
    assert "No bound is certified" in told
    words = run("simulate", spec, "--worst-case", cwd=tmp_path).stdout.splitlines()
    (said,) = (line for line in words if line.startswith(" force "))
    *_, bound, ratio = said.split()
    assert found["force"]["certified_bound"] <= float(bound)
    assert 1 <= float(ratio) / found["force"]["bound_over_found"] < 1.02

import pytest

from nrs_design.reporting.figures.simulated import draw_simulated
from nrs_design.reporting.images import render_png
from tests.simulation.interactions import IMPEDANCE, PLACED, SAMPLED, simulated, text_of
from tests.support import document_of, run, spec_in

RUN = (
    "command: {points: [[0 s, 0 deg/s], [0.5 s, 8 deg/s], [1 s, -8 deg/s]]}, "
    "surfaces: [{environment: soft, at: 1 deg}]"
)


@pytest.fixture
def spec(tmp_path):
    def write(scenario=RUN, more="", **options):
        return spec_in(tmp_path, text_of(scenario=scenario, more=more, **options), "small")

    return write


@pytest.mark.slow
def test_the_same_run_gives_the_same_bytes_and_never_those_of_another_spec(spec, tmp_path):
    path = spec(RUN + ", errors: {force_noise: 0.01 N*m, jitter: 0.2}, seed: 7", SAMPLED)
    for folder in ("a", "b"):
        run("simulate", path, "--out", folder, cwd=tmp_path, code=0)
    first, again = ({f.name: f.read_bytes() for f in (tmp_path / d).iterdir()} for d in "ab")
    assert first == again
    path.write_text(path.read_text().replace("name: small", "name: other"))
    run("simulate", path, "--out", "a", cwd=tmp_path, code=0)
    assert first.items() < {f.name: f.read_bytes() for f in (tmp_path / "a").iterdir()}.items()


def test_a_log_of_the_law_that_ships_can_be_audited(spec, tmp_path):
    """Its columns have names of their own; thesis 6.3.2.1: the law has a velocity as a state."""
    table = simulated(text_of(scenario=RUN, more=SAMPLED), "sampled").response.to_csv()
    (tmp_path / "run.csv").write_text(table)
    names = table.partition("\n")[0].split(",")
    assert len(set(names)) == len(names)
    assert "state-velocity_rad_s" in names
    audited = run("audit", "run.csv", spec(more=SAMPLED), cwd=tmp_path)
    assert audited.returncode in (1, 3), audited.stderr


def test_a_bound_stands_beside_the_peak(spec, tmp_path):
    laws = {name: law.replace("0.01 kg", "0 kg") for name, law in IMPEDANCE.items()}
    path = spec(more="contact: losable\ndisturbances: {command: 8 deg/s}\n", controllers=laws)
    (one,) = document_of("simulate", path, cwd=tmp_path)["runs"]
    force = next(b for b in one["certified_bounds"] if b["output"] == "force")
    assert force["holds_for_this_run"]
    assert one["metrics"]["peak_torque"] < force["level"] < 1
    rate = one["certified_rate"]
    assert rate["rate"] > 1
    assert rate["uncovered"] == ["the command does not come to an end before the run does"]
    told = run("simulate", path, "-v", cwd=tmp_path).stdout
    assert "certified decay once nothing is commanded: " in told
    (unbound,) = document_of("simulate", path, "--no-bound", cwd=tmp_path)["runs"]
    assert unbound["certified_bounds"] == []
    run("certify-switching", path, "--out", "a.cert.json", "-v", cwd=tmp_path, code=0)
    shown = run(
        "simulate", path, "--certificate", "a.cert.json", "--period", "0.002", "-v", cwd=tmp_path
    )
    assert "certified bound on the force" in shown.stdout
    assert "not about this run: the proof is not about the sampled loop" in shown.stdout
    path.write_text(path.read_text().replace("[0.5 s, 8 deg/s]", "[0.5 s, 7 deg/s]"))
    stale = run("simulate", path, "--certificate", "a.cert.json", "-v", cwd=tmp_path, code=2)
    assert "the spec has changed" in stale.stderr


def test_an_outer_period_as_an_option_is_that_of_the_spec(spec, tmp_path):
    written = spec(more="sampling: {period: 2 ms, outer_period: 1 ms, delay: 1}\n")

    def metrics(path, *options):
        document = document_of("simulate", path, "--scenario", "run", *options, cwd=tmp_path)
        return document["runs"][0]["metrics"]

    wanted, plain, option = metrics(written), spec(more=SAMPLED), ("--outer-period", "0.001")
    # Both are the same file, so the first has run before the second is written.
    assert metrics(plain, *option) == wanted != metrics(plain)
    force = spec(controllers=PLACED, more=SAMPLED)
    result = run("simulate", force, *option, cwd=tmp_path, code=2)
    assert "for impedance controllers alone" in result.stderr


def test_a_bound_far_away_is_named_not_drawn():
    response = simulated(text_of(scenario=RUN)).response
    near = draw_simulated(response, 0.3, 0.14, 0.24, (0.6, True))
    far = draw_simulated(response, 0.3, 0.14, None, (60.0, False))
    assert "60 N m" in far.axes[0].get_title()
    assert not near.axes[0].get_title()
    assert render_png(near, 40)[:4] == b"\x89PNG"


ALONE = {"insertion": "{type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: 2.15 N*m*s/rad}"}
RANGED = {
    "soft": "{model: elastic, stiffness: {nominal: 43 N*m/rad, range: [40 N*m/rad, 46 N*m/rad]}}"
}
PRESSED = (
    "command: {constant: 8 deg/s}, duration: 0.2 s, surfaces: [{environment: soft, at: 0.1 deg}]"
)


@pytest.fixture
def bounded(tmp_path):
    more = "contact: losable\ndisturbances: {command: 8 deg/s}\n"
    return spec_in(tmp_path, text_of(ALONE, RANGED, scenario=PRESSED, more=more), "small")


@pytest.mark.slow
def test_the_worst_case_beside_limits_and_bounds(bounded, tmp_path):
    document = document_of(
        "simulate", bounded, "--worst-case", "--out", "runs", cwd=tmp_path, code=0
    )
    assert document["schema"] == "nrs-design/simulate/1"
    found = {item["output"]: item for item in document["worst_case"]["found"]}
    assert found.keys() == {"force", "velocity", "deflection"}
    for item in found.values():
        assert 0 < item["worst_found"] < item["certified_bound"]
        assert item["bound_over_found"] > 1
    assert found["force"]["exceeds_limit"] == (found["force"]["worst_found"] > 0.3)
    names = {f"small.worst-{name}.{s}" for name in found for s in ("svg", "png")}
    assert {path.name for path in (tmp_path / "runs").iterdir()} == names
    told = run("simulate", bounded, "--worst-case", "--no-bound", cwd=tmp_path).stdout
    assert "worst found" in told
    assert "No bound is certified" in told
    words = run("simulate", bounded, "--worst-case", cwd=tmp_path).stdout.splitlines()
    (said,) = (line for line in words if line.startswith(" force "))
    *_, bound, ratio = said.split()
    assert found["force"]["certified_bound"] <= float(bound)
    assert 1 <= float(ratio) / found["force"]["bound_over_found"] < 1.02

"""`nrs-design simulate`, as a user types it."""

import numpy as np
import pytest

from nrs_design.reporting.figures.simulated import draw_simulated
from nrs_design.reporting.images import to_png
from tests.simulation.interactions import IMPEDANCE, PLACED, SAMPLED, simulated, text_of
from tests.support import document_of, run

RUN = (
    "command: {points: [[0 s, 0 deg/s], [0.5 s, 8 deg/s], [1 s, -8 deg/s]]}, "
    "surfaces: [{environment: soft, at: 1 deg}]"
)


STILL = "command: {constant: 1 deg/s}, duration: %s, surfaces: [{environment: soft, at: %s}]"


@pytest.fixture
def spec(tmp_path):
    def write(scenario=RUN, more="", **options):
        path = tmp_path / "small.nrs.yaml"
        path.write_text(text_of(scenario=scenario, more=more, **options))
        return path

    return write


@pytest.mark.slow
def test_metrics_and_files(spec, tmp_path):
    result = run("simulate", spec(), "--out", "runs", "-v", cwd=tmp_path, code=0)
    assert "run: exact engine" in result.stdout
    assert "largest torque" in result.stdout
    names = {path.name for path in (tmp_path / "runs").iterdir()}
    assert names == {f"small.run.{suffix}" for suffix in ("csv", "svg", "png")}
    table = np.genfromtxt(tmp_path / "runs/small.run.csv", delimiter=",", names=True, dtype=None)
    assert (np.diff(table["time_s"]) > 0).all()
    again = run("simulate", spec(), "--out", "runs", "--quiet", "-v", cwd=tmp_path)
    assert (again.returncode, again.stdout, again.stderr) == (0, "", "")


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


def test_a_saturated_command_is_said(spec, tmp_path):
    path = spec(more=SAMPLED)
    path.write_text(path.read_text().replace("2 Hz}", "2 Hz, command: 100 rpm}"))
    saturated = document_of("simulate", path, cwd=tmp_path)["runs"][0]["saturated_samples"]
    assert saturated > 0
    told = run("simulate", path, "-v", cwd=tmp_path).stdout
    assert f"met its limit at {saturated} samples" in told


def test_what_an_engine_leaves_out_is_said(spec, tmp_path):
    path = spec(RUN + ", errors: {force_noise: 0.01 N*m}")
    assert "noise and jitter of the scenario" in run("simulate", path, "-v", cwd=tmp_path).stdout
    result = run("simulate", path, "--engine", "sampled", "-v", cwd=tmp_path)
    assert "noise and jitter" not in result.stdout
    assert "other axes" in result.stdout


def test_controllers_in_force_and_age_of_the_force_are_said(spec, tmp_path):
    path = spec(scenario=None, more="sampling: {period: 2 ms, delay: [0, 1]}\n")
    told = run("simulate", path, "-v", cwd=tmp_path).stdout
    assert "in force: insertion, withdrawal; a sample every 0.002 s" in told
    assert "age of the force in samples: 0 to 1, drawn anew at each\n" in told
    late = run("simulate", path, "--delay", "3", "-v", cwd=tmp_path).stdout
    assert "age of the force in samples: 3\n" in late
    twice = run("simulate", path, "--outer-period", "0.001", "-v", cwd=tmp_path).stdout
    assert "motion loop every 0.002 s, force sample every 0.001 s" in twice


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


@pytest.mark.parametrize(
    ("given", "arguments", "message"),
    [
        ({}, ["--scenario", "ran"], "no scenario 'ran'"),
        ({"scenario": STILL % ("1 s", "-1 deg")}, [], "rests inside 'soft' at the start"),
        ({"scenario": None}, ["--scenario", "a"], "write one of insertion-and-withdrawal"),
        ({}, ["--engine", "exact", "--period", "0.002"], "has no samples"),
        ({}, ["--certificate", "none.json"], "cannot be read"),
        ({}, ["--engine", "foo"], "Invalid value for '--engine': 'foo' is not one of"),
        ({}, ["--period", "1 parsec"], "parsec"),
        (
            {"more": "sampling: {period: 2 ms, outer_period: 0.1 ms, delay: 0}\n"},
            ["--period", "0.00025"],
            "do not meet at common samples",
        ),
    ],
)
def test_wrong_usage(spec, tmp_path, given, arguments, message):
    done = run("simulate", spec(**given), *arguments, cwd=tmp_path, code=2)
    assert (done.stdout, message in done.stderr) == ("", True)


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


def test_a_profile_from_a_file(spec, tmp_path):
    path = spec("command: {csv: hand.csv}, surfaces: [{environment: soft, at: 1 deg}]")
    hand = tmp_path / "hand.csv"
    hand.write_text("time_s,velocity_deg_s\n0,0\n1,5\n2,0\n")
    found = document_of("simulate", path, cwd=tmp_path)["runs"][0]
    assert found["metrics"]["duration"] == 2
    for rows, message in (
        ("0,0\n1,9\n", "beyond the spec's limit"),
        ("0,0\n1,nan\n", "nan"),
        ("", "fewer than two rows"),
        ("0,0\n", "no profile"),
        ("0,0\n2,1\n1,1\n", "no profile"),
    ):
        hand.write_text("time_s,velocity_deg_s\n" + rows)
        assert message in run("simulate", path, "--out", "runs", cwd=tmp_path, code=2).stderr
        checked = run("check", path, cwd=tmp_path)
        assert (checked.returncode, checked.stdout) == (2, "")
        assert message in checked.stderr
        assert not (tmp_path / "runs").exists()


def test_limits_of_a_scenario_stand_beside_its_peaks(spec, tmp_path):
    own = "limits: {torque: 0.25 N*m, deflection: 0.5 deg, velocity: 10 deg/s}"
    result = run("simulate", spec(f"{RUN}, {own}"), "-v", cwd=tmp_path)
    rows = [line.split() for line in result.stdout.splitlines() if "largest" in line]
    assert [row[-1] for row in rows] == ["0.25", "0.5", "10"]
    document = document_of("simulate", spec(f"{RUN}, {own}"), cwd=tmp_path)
    assert document["runs"][0]["limits"]["torque"] == 0.25


def test_a_profile_behind_a_link(spec, tmp_path):
    """Within the folder it is as good as the file; out of it, another machine has another one."""
    path = spec("command: {csv: hand.csv}")
    outside = tmp_path.parent / f"{tmp_path.name}-outside.csv"
    for target in (tmp_path / "real.csv", outside):
        target.write_text("time_s,velocity_deg_s\n0,0\n0.1,0\n")
    link = tmp_path / "hand.csv"
    link.symlink_to("real.csv")
    run("simulate", path, "--quiet", cwd=tmp_path, code=0)
    for target, message in (
        (outside, "leads out of the spec's folder"),
        ("hand.csv", "symbolic links"),
        ("/dev/zero", "leads out of the spec's folder"),
    ):
        link.unlink()
        link.symlink_to(target)
        assert message in run("simulate", path, cwd=tmp_path, code=2).stderr


def test_a_chattering_logic_is_counted(spec, tmp_path):
    """Noise around a command near zero: the signs of 6.3.2 have no bands."""
    noisy = STILL.replace("1 deg/s", "-0.1 deg/s") % ("1 s", "0 deg")
    path = spec(noisy + ", errors: {force_noise: 0.05 N*m}", SAMPLED)
    assert "stays below 10 ms (chatter)" in run("simulate", path, "-v", cwd=tmp_path, code=0).stdout
    document = document_of("simulate", path, cwd=tmp_path)
    assert document["runs"][0]["metrics"]["chatter"] > 20


def test_a_bound_far_away_is_named_not_drawn():
    response = simulated(text_of(scenario=RUN)).response
    near = draw_simulated(response, 0.3, 0.14, 0.24, (0.6, True))
    far = draw_simulated(response, 0.3, 0.14, None, (60.0, False))
    assert "60 N m" in far.axes[0].get_title()
    assert not near.axes[0].get_title()
    assert to_png(near, 40)[:4] == b"\x89PNG"

"""`nrs-design optimize`, as a user types it."""

import pytest

from tests.simulation.interactions import text_of
from tests.support import ROOT, SOFT_TISSUE, document_of, run


def write(tmp_path, text):
    (tmp_path / "written.nrs.yaml").write_text(text)
    return "written.nrs.yaml"


LOADED = text_of(
    {"a": "{type: impedance, environment: soft, Mt: MASS, Bt: DAMPING}"},
    {"soft": "{model: elastic, stiffness: 300 N*m/rad}"},
).replace("time_constant: 0.0351 s", "time_constant: 0.0351 s, load_inertia: 0.3 kg*m^2")
GAINS = (("MASS", "0.01 kg*m^2"), ("DAMPING", "2.15 N*m*s/rad"))


def loaded(*replacements):
    text = LOADED
    for old, new in (*replacements, *GAINS):
        text = text.replace(old, new)
    return text


def test_a_load_is_in_all_that_is_said(tmp_path):
    """What certify-switching proves at 318.6 and refutes at 318.7 N m/rad has the limit 318.68."""
    document = document_of("optimize", write(tmp_path, loaded()), cwd=tmp_path, code=0)
    (found,) = document["controllers"]
    assert found["stiffness_limit"] == pytest.approx(318.6876, abs=1e-3)
    assert found["gain_margin"] > 1
    # Unloaded it ends to be passive at 60.90 rad/s; loaded, Re Y is +0.043 there.
    assert 60.91 < found["passive_up_to_rad_s"] < found["not_passive_at_rad_s"]
    for stiffness, proved in (("318.6", 0), ("318.7", 1)):
        path = write(tmp_path, loaded(("300 N", f"{stiffness} N")))
        run("certify-switching", path, cwd=tmp_path, code=proved)
    said = run("optimize", path, cwd=tmp_path, code=2)
    assert "it is stable below 318.687 N m/rad" in said.stderr  # Rounded down.


@pytest.mark.parametrize(
    ("stiffness", "motor", "said"),
    [
        ("15.7", "", None),
        ("15.8", "", "it is stable below 15.7"),
        # Delay 0 is unstable here, too, and is named first.
        ("43", "", "it is stable below 15.7"),
        (
            "43",
            "{nominal: 0.0351 s, range: [0.035 s, 0.036 s]}",
            "it is stable with the nominal motor below 15.7",
        ),
    ],
)
def test_an_unstable_loop_is_told_the_limit_at_the_worst_age(tmp_path, stiffness, motor, said):
    path = write(
        tmp_path,
        loaded(
            ("DAMPING", "0.4 N*m*s/rad"),
            (", load_inertia: 0.3 kg*m^2", ""),
            ("0.0351 s", motor or "0.0351 s"),
            ("300 N", f"{stiffness} N"),
        )
        + "sampling: {period: 2 ms, delay: [0, 2]}\n",
    )
    assert (said or "") in run("optimize", path, cwd=tmp_path, code=2 if said else 0).stderr


def test_gains_are_sought_where_the_loop_that_is_proved_is_stable(tmp_path):
    """The loop without the load is unstable with all of these gains."""
    bounds = ("MASS", "0.01 kg*m^2"), ("DAMPING", "{min: 2.1 N*m*s/rad, max: 2.2 N*m*s/rad}")
    document = document_of("optimize", write(tmp_path, loaded(*bounds)), cwd=tmp_path, code=0)
    (found,) = document["controllers"]
    assert found["stiffness_limit"] > 300


def test_one_sensitivity_peak_for_one_controller(tmp_path):
    """Withdrawal over soft tissue: 3.75298 is the supremum; the table is rounded up, as warned."""
    result = run("optimize", SOFT_TISSUE, "-v", cwd=tmp_path)
    assert result.stdout.startswith("soft-tissue: G(s) = (0.99739 s + 56.822)")
    row = next(line for line in result.stdout.splitlines() if "withdrawal" in line)
    for value in ("0.01", "1.04", "3.753!"):
        assert value in row
    assert "3.578" not in result.stdout + result.stderr
    assert "the worst of the loop that certify-switching is about" in result.stdout
    document = document_of("optimize", SOFT_TISSUE, cwd=tmp_path)
    for controller in document["controllers"]:
        worst = {goal["goal"]: goal["worst"] for goal in controller["goals"]}
        assert controller["sensitivity_peak"] == worst["max_sensitivity_peak"]
        assert controller["delay_margin_s"] == worst["min_delay_margin"]


GOALS = ROOT / "docs" / "examples" / "gains-with-proof.nrs.yaml"
REDESIGNED = ROOT / "specs" / "neuroboscope" / "soft-tissue-redesigned.nrs.yaml"


def test_gains_with_their_proof_are_written_with_it(tmp_path):
    """The spec that is shipped is what this command writes."""
    new = tmp_path / "soft-tissue-redesigned.nrs.yaml"
    document = document_of("optimize", GOALS, "--out", new, cwd=tmp_path, code=0)
    certified = document["certified"]
    assert certified["decay_rate"] >= 2
    assert certified["binds"] == ["decay_rate", "delay"]
    assert certified["cost"] > certified["free_cost"]
    assert all(goal["met"] for goal in certified["goals"])
    assert new.read_text() == REDESIGNED.read_text()
    shown = run("verify", certified["certificate"], new, cwd=tmp_path, code=0).stdout
    assert shown.startswith("PROVED")
    # What stands is not replaced, and nothing else is written.
    again = run("optimize", GOALS, "--out", new, cwd=tmp_path, code=2)
    assert "exists, and is not replaced" in again.stderr
    assert {path.name for path in tmp_path.iterdir()} == {new.name, "reports"}


def test_line_ends_and_comments_are_kept(tmp_path):
    text = GOALS.read_text(encoding="utf-8").replace("\n", "\r\n")
    (tmp_path / "a.nrs.yaml").write_bytes(text.encode())
    run("optimize", "a.nrs.yaml", "--out", "b.nrs.yaml", "-q", cwd=tmp_path, code=0)
    written = (tmp_path / "b.nrs.yaml").read_bytes()
    assert b"\r\r" not in written
    assert written.count(b"\n") == written.count(b"\r\n")
    inside = GOALS.read_text(encoding="utf-8").replace(
        "Bt: {min: 0.1 N*m*s/rad, max: 20 N*m*s/rad}",
        "Bt:\n      min: 0.1 N*m*s/rad  # low\n      max: 20 N*m*s/rad",
    )
    (tmp_path / "c.nrs.yaml").write_text(inside)
    refused = run("optimize", "c.nrs.yaml", "--out", "d.nrs.yaml", cwd=tmp_path, code=2)
    assert "the comment '# low' would be lost" in refused.stderr
    assert not (tmp_path / "d.nrs.yaml").exists()
    for name, words in (("New.nrs.yaml", "is not a name"), (".nrs.yaml", "name")):
        refused = run("optimize", GOALS, "--out", name, cwd=tmp_path, code=2)
        assert words in refused.stderr
        assert name in refused.stderr

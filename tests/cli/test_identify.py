"""`nrs-design identify`, as a user types it."""

import json
import shutil

import pytest

from nrs_design.models.contact import KelvinVoigt
from tests.identification.support import quick
from tests.identification.unilateral import robot_record
from tests.support import COMMUTING, ROOT, SOFT_TISSUE, run

DATA = ROOT / "specs" / "data"
SOFT = sorted(DATA.glob("silicone-soft-*.csv"))
NOSE = sorted(DATA.glob("nose-*.csv"))
SINUSOIDS = sorted(DATA.glob("actuator-*hz.csv"))


def test_end_to_end(tmp_path):
    """Shipped records into a copy of the soft-tissue spec; the gate proves the whole interval."""
    spec = tmp_path / "soft-tissue.nrs.yaml"
    shutil.copy(SOFT_TISSUE, spec)
    result = run("identify", "tissue", *SOFT, "--write", spec, "--json", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["schema"] == "nrs-design/identify-tissue/1"
    assert document["synthetic"] is True
    assert document["chosen"] == "elastic"
    k = document["ranges"]["k"]
    # Thesis 6.1: three fits and their mean, 747.14 N/m.
    assert all(k["low"] < fit < k["high"] for fit in (768.17, 720.56, 752.69))
    assert k["value"] == pytest.approx(747.14, rel=5e-3)
    assert "data: synthetic" in spec.read_text()
    gate = run("gate", spec, "--json", "--no-reports", cwd=tmp_path)
    assert gate.returncode == 0, gate.stdout + gate.stderr
    check = run("check", spec, cwd=tmp_path).stdout
    assert "silicone-soft-1.csv" in check
    assert "synthetic" in check


def test_tissue_table(tmp_path):
    result = run("identify", "tissue", *SOFT, "--lever-arm", "0.24 m", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert result.stdout.startswith("SYNTHETIC data")
    for law in ("elastic", "kelvin-voigt", "maxwell", "kelvin-boltzmann", "hunt-crossley"):
        assert law in result.stdout
    assert "at the pivot: k = 42.9" in result.stdout
    assert "least BIC" in result.stdout


def test_nose_of_the_thesis(tmp_path):
    """Thesis table 2.4: k1 0.233, k2 0.972, b 23.631; RMSE 0.0216, 0.0165, 0.0062, 0.0111."""
    document = json.loads(run("identify", "tissue", *NOSE, "--json", cwd=tmp_path).stdout)
    assert document["chosen"] == "kelvin-boltzmann"
    model = next(m for m in document["models"] if m["law"] == "kelvin-boltzmann")
    for name, value in (("k1", 0.233), ("k2", 0.972), ("b", 23.631)):
        assert model["parameters"][name]["low"] < value < model["parameters"][name]["high"]
    rmse = [record["rmse"] for record in model["records"]]
    assert rmse == pytest.approx([0.0216, 0.0165, 0.0062, 0.0111], rel=0.05)
    assert model["relaxation_time_s"] == pytest.approx(19.6, rel=0.02)


def test_actuator(tmp_path):
    spec = tmp_path / "copy.nrs.yaml"
    shutil.copy(SOFT_TISSUE, spec)
    arguments = ("identify", "actuator", *SINUSOIDS, "--json", "--write", spec)
    result = run(*arguments, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    document = json.loads(result.stdout)
    fit = document["fits"][-1]
    for key, value in (
        ("gain_rad_s_rpm", 4.8417e-4),
        ("time_constant_s", 0.0351),
        ("friction_rpm", 276.575),
    ):
        assert fit[key]["low"] < value < fit[key]["high"]
    assert document["resistance_ohm"]["value"] == pytest.approx(3.7454, rel=1e-3)
    assert document["range_covers"] == "confidence"
    assert "gain: {nominal: 4.84" in spec.read_text()
    assert "range_covers: confidence" in spec.read_text()
    text = run("identify", "actuator", DATA / "actuator-response.csv", cwd=tmp_path).stdout
    assert text.startswith("SYNTHETIC data")
    assert "ready frequency response" in text


@pytest.mark.parametrize("ending", ["html", "pdf"])
def test_report(tmp_path, ending):
    page = tmp_path / f"page.{ending}"
    result = run("identify", "tissue", *SOFT[:1], "--report", page, "-q", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert page.read_bytes()[:4] in (b"<!DO", b"%PDF")


@pytest.mark.parametrize(
    ("command", "data"), [("tissue", SOFT[0]), ("actuator", DATA / "actuator-response.csv")]
)
def test_a_report_has_the_date_that_is_given_and_no_other(tmp_path, command, data):
    pages = []
    for dates in ([], ["--date", "2026-03-01"]):
        result = run("identify", command, data, "--report", "p.html", *dates, "-q", cwd=tmp_path)
        assert result.returncode == 0, result.stderr
        pages.append((tmp_path / "p.html").read_text())
    dated = '<time datetime="2026-03-01">2026-03-01</time>'
    assert [page.count("<time") for page in pages] == [0, 1]
    assert dated in pages[1]


def test_foreign_columns(tmp_path):
    text = SOFT[0].read_text().replace("deflection_m", "x").replace("force_N", "Fz")
    (tmp_path / "foreign.csv").write_text(text)
    missing = run("identify", "tissue", "foreign.csv", cwd=tmp_path)
    assert missing.returncode == 2
    assert "the columns deflection_m, force_N are missing" in missing.stderr
    assert " --> foreign.csv:2\n" in missing.stderr
    arguments = ("--map", "deflection_m=x", "--map", "force_N=Fz")
    assert run("identify", "tissue", "foreign.csv", *arguments, cwd=tmp_path).returncode == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["tissue", "missing.csv"], "missing.csv: cannot be read"),
        (["tissue", SOFT[0], SOFT[0]], "has the same content"),
        (["tissue", SOFT[0], NOSE[0]], "linear and rotational records are mixed"),
        (["tissue", NOSE[0], "--lever-arm", "0.24 m"], "records are rotational"),
        (["tissue", SOFT[0], "--lever-arm", "24 N"], "is not a length"),
        (["tissue", SOFT[0], "--lever-arm", "0 m"], "not positive"),
        (["tissue", SOFT[0], "--map", "Fz"], "is not a pair"),
        (["tissue", SOFT[0], "--report", "page.docx"], "not a type of report"),
        (["tissue", SOFT[0], "--write", COMMUTING], "has no place for identified values"),
        (["tissue", SINUSOIDS[0]], "are missing"),
        (["actuator", SINUSOIDS[0], SINUSOIDS[0]], "there twice"),
        (["actuator", SOFT[0]], "are missing"),
    ],
)
def test_bad_input_is_one_message(tmp_path, arguments, message):
    result = run("identify", *arguments, cwd=tmp_path)
    assert result.returncode == 2
    assert message in result.stderr
    assert result.stderr.count("error[") == 1
    assert list(tmp_path.iterdir()) == []


def test_a_failed_merge_leaves_the_spec(tmp_path):
    spec = tmp_path / "copy.nrs.yaml"
    shutil.copy(SOFT_TISSUE, spec)
    arguments = ("identify", "tissue", NOSE[0], "--model", "hunt-crossley", "--write", spec)
    result = run(*arguments, cwd=tmp_path)
    assert result.returncode == 2
    assert "--model elastic" in result.stderr
    assert spec.read_text() == SOFT_TISSUE.read_text()


def test_what_is_chosen_for_the_nose_can_be_proved(tmp_path):
    spec = tmp_path / "nose.nrs.yaml"
    shutil.copy(ROOT / "specs/neuroboscope/nose.nrs.yaml", spec)
    result = run("identify", "tissue", *NOSE, "--write", spec, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "model: kelvin-boltzmann" in spec.read_text()
    assert "nose-4.csv" in spec.read_text()
    proved = run("certify-switching", spec, cwd=tmp_path)
    assert proved.returncode == 0
    assert proved.stdout.startswith("nose: PROVED")


def test_writing_a_law_that_fits_worse_warns(tmp_path):
    spec = tmp_path / "copy.nrs.yaml"
    shutil.copy(SOFT_TISSUE, spec)
    arguments = ("identify", "tissue", NOSE[0], "--model", "elastic", "--write", spec, "-q")
    result = run(*arguments, cwd=tmp_path)
    assert result.returncode == 0
    first, *doubts = result.stderr.splitlines()
    assert first.startswith("warning: kelvin-boltzmann describes the records better than elastic")
    assert any("the residual is" in doubt for doubt in doubts)
    gate = run("gate", spec, "--no-reports", cwd=tmp_path)
    assert gate.returncode == 1
    assert "NRS107 missed" in gate.stdout


def robot_csv(folder, sign=1):
    """A record in robot coordinates: 400 N/m at 0.1 m, a tare of -1.3 N, air before contact."""
    data = robot_record(KelvinVoigt(400.0, 3.0), quick(2), 0.05, 2, zero=0.1, tare=-1.3)
    rows = zip(data.motion.time, data.motion.deflection, sign * data.force, strict=True)
    text = "\n".join(f"{t:.3f},{x:.7f},{f:.4f}" for t, x, f in rows)
    path = folder / f"robot{sign}.csv"
    path.write_text(f"time_s,deflection_m,force_N\n{text}\n")
    return path


def test_offsets_and_cuts_are_said(tmp_path):
    path = robot_csv(tmp_path)
    document = json.loads(run("identify", "tissue", path, "--json", cwd=tmp_path).stdout)
    assert document["chosen"] == "kelvin-voigt"
    assert document["ranges"]["k"]["low"] < 400 < document["ranges"]["k"]["high"]
    assert document["caveats"] == []
    (fit,) = next(m for m in document["models"] if m["law"] == "kelvin-voigt")["records"]
    assert fit["offsets"]["zero"]["value"] == pytest.approx(0.1, abs=2e-4)
    assert fit["offsets"]["tare"]["value"] == pytest.approx(-1.3, abs=0.02)
    assert fit["used"] < fit["samples"]
    assert any("at the edge of contact" in cut for cut in fit["cuts"])
    text = run("identify", "tissue", path, "--prony", cwd=tmp_path).stdout
    assert "3 touches" in text
    assert "Prony series of" in text


def test_opposite_signs_stop_the_writing(tmp_path):
    spec = tmp_path / "copy.nrs.yaml"
    shutil.copy(SOFT_TISSUE, spec)
    arguments = ("identify", "tissue", robot_csv(tmp_path, -1), "--write", spec)
    result = run(*arguments, cwd=tmp_path)
    assert "force and deflection have opposite signs" in result.stderr
    assert run(*arguments, "--negate-force", "-q", cwd=tmp_path).stderr == ""
    assert "doubts" not in spec.read_text()


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (("--zero", "3 N"), "--zero: "),
        (("--tare", "3 m"), "--tare: "),
        (("--from", "99"), "lie between --from and --to"),
        (("--skip-cycles", "9"), "9 cycles are to be set apart"),
        (("--covers", "tolerance"), "needs several records"),
        (("--preload", "1 mm..2 mm"), "the same at every preload"),
        (("--preload", "1 N"), "--preload: "),
    ],
)
def test_wrong_options_of_tissue(tmp_path, option, message):
    result = run("identify", "tissue", SOFT[0], *option, cwd=tmp_path)
    assert result.returncode == 2
    assert message in result.stderr


def test_help_has_examples(tmp_path):
    for command in ("tissue", "actuator"):
        assert "Example: nrs-design identify" in run("identify", command, "-h", cwd=tmp_path).stdout


POSES = DATA / "tool-poses.csv"


def test_tool_into_a_spec_that_the_gate_proves(tmp_path):
    spec = tmp_path / "soft-tissue.nrs.yaml"
    shutil.copy(SOFT_TISSUE, spec)
    page = tmp_path / "tool.html"
    result = run(
        "identify", "tool", POSES, "--write", spec, "--report", page, "--json", cwd=tmp_path
    )
    assert result.returncode == 0, result.stderr
    document = json.loads(result.stdout)
    assert document["schema"] == "nrs-design/identify-tool/1"
    assert document["synthetic"] is True
    assert document["mass_kg"]["low"] < 0.797 < document["mass_kg"]["high"]
    for axis, value in zip("xyz", (0.002, -0.004, 0.2), strict=True):
        assert document["center_of_mass_m"][axis]["low"] < value
        assert value < document["center_of_mass_m"][axis]["high"]
    assert "data: synthetic" in spec.read_text()
    assert "Errors in each pose" in page.read_text(encoding="utf-8")
    again = run("identify", "tool", POSES, "--write", spec, cwd=tmp_path)
    assert "center of mass m" in again.stdout
    optimized = json.loads(run("optimize", spec, "--json", cwd=tmp_path).stdout)
    assert set(optimized["sensor"]["parts"]) == {"bias", "mass and center of mass of the tool"}
    assert optimized["controllers"][0]["creep"]["velocity_rad_s"] > 0


def test_wrong_poses(tmp_path):
    result = run("identify", "tool", SOFT[0], cwd=tmp_path)
    assert result.returncode == 2
    assert "missing" in result.stderr
    (tmp_path / "two.csv").write_text("\n".join(POSES.read_text().splitlines()[:4]))
    result = run("identify", "tool", tmp_path / "two.csv", cwd=tmp_path)
    assert result.returncode == 2
    assert "2 poses do not determine a tool" in result.stderr

"""The section about the force signal: parts, sum, and the creep of each controller."""

from nrs_design.pipeline import run_analysis, run_design
from nrs_design.reporting.sections.creep import creep_section
from nrs_design.spec import read_spec
from tests.support import SOFT_TISSUE

SENSOR = """
sensor:
  imu_error: 1 deg
  resolution: 1e-3 N*m
  noise_density: 1e-8 N^2*m^2*s
  tool: {mass: 0.797 kg, center_of_mass: {x: 0 m, y: 0 m, z: 0.2 m}}
  contact: {x: 0 m, y: 0 m, z: 0.24 m}
"""


def section_of(path, more, *changes):
    text = SOFT_TISSUE.read_text(encoding="utf-8")
    for old, new in changes:
        text = text.replace(old, new)
    file = path / "sensed.nrs.yaml"
    file.write_text(text + more, encoding="utf-8")
    designed = run_design(read_spec(file))
    return creep_section(designed, run_analysis(designed))


def test_parts_and_sum_and_creep(tmp_path):
    errors, creep, meaning = section_of(tmp_path, SENSOR).blocks
    assert errors.rows == (
        ("half a step of resolution", "0.0005", "0.002084"),
        ("weight of the tool at the error of the IMU", "0.02730", "0.1138"),
        ("together, F0", "0.02780", "0.1158"),
    )
    (insertion, withdrawal) = creep.rows
    assert insertion[0] == "insertion"
    # 0.0278 N m over 1.04 N m s/rad, of 8 deg/s.
    assert withdrawal[1:3] == ("1.532", "19.1")
    assert withdrawal[3] == "grows as long as it lasts"
    assert float(withdrawal[4]) > 0
    assert any("Noise has no bound" in text for text in meaning.items)


def test_a_spring_gives_an_angle(tmp_path):
    sprung = ("    Bt: {min", "    Kt: 0.5 N*m/rad\n    Bt: {min")
    _, creep, _ = section_of(tmp_path, SENSOR, sprung).blocks
    assert [row[1:4] for row in creep.rows] == [("0", "0", "3.185")] * 2


def test_without_errors_there_is_no_section(tmp_path):
    assert section_of(tmp_path, "") is None
    assert section_of(tmp_path, "sensor: {filter: {cutoff: 60 Hz}}\n") is None

"""Files as other programs write them: read without help, or with `--map`."""

import numpy as np
import pytest

from nrs_design.identification.datasets.records import read_tissue
from nrs_design.identification.errors import DataError
from nrs_design.identification.tables.columns import Name, find_columns, parse_mapping, read_name
from tests.tables import rows

N = 80
TIME = np.arange(N) / 100
DEFLECTION = 0.005 * (1 - np.cos(9 * TIME))
FORCE = 750 * DEFLECTION


def table(separator, scales=(1.0, 1.0, 1.0)):
    lines = (
        separator.join(f"{value * scale:.6f}" for value, scale in zip(row, scales, strict=True))
        for row in zip(TIME, DEFLECTION, FORCE, strict=True)
    )
    return "\n".join(lines) + "\n"


ROS = "%time,/tool.pose.z,/ft_sensor.wrench.force.z\n" + "".join(
    f"{1_700_000_000_000_000_000 + int(t * 1e9)},{d:.6f},{f:.6f}\n"
    for t, d, f in zip(TIME, DEFLECTION, FORCE, strict=True)
)
FROM_ROS = ["time_ns=time", "deflection_m=/tool.pose.z", "force_N=/ft_sensor.wrench.force.z"]
GERMAN = "Zeit;Weg (mm);Kraft\n" + table(";", (1, 1e3, 1))
FROM_GERMAN = ["time_s=Zeit", "deflection_mm=Weg (mm)", "force_N=Kraft"]
QUOTED = '"Time (s)","Deflection (mm)","Force (N)"\n"' + (
    table('","', (1, 1e3, 1)).strip().replace("\n", '"\n"') + '"\n'
)
MARKED = "\ufefftime_s,deflection_um,force_kgf\n" + table(",", (1, 1e6, 1 / 9.80665))
STYLES = {
    "all in quotes": (QUOTED, []),
    "commented header of NumPy": ("# time_s deflection_m force_N\n" + table(" "), []),
    "tabs": ("time_s\tdeflection_m\tforce_N\n" + table("\t"), []),
    "brackets": (
        "# a\nTime [ms], Deflection [µm], Force [kN]\n" + table(",", (1e3, 1e6, 1e-3)),
        [],
    ),
    "semicolons and foreign names": (GERMAN, FROM_GERMAN),
    "a bag": (ROS, FROM_ROS),
    "a byte order mark": (MARKED, []),
}


def check(record):
    assert record.motion.time == pytest.approx(TIME, abs=1e-6)
    assert record.motion.deflection == pytest.approx(DEFLECTION, abs=1e-6)
    assert record.force == pytest.approx(FORCE, abs=2e-3)


@pytest.mark.parametrize("style", STYLES)
def test_text(tmp_path, style):
    text, entries = STYLES[style]
    path = tmp_path / "record.txt"
    path.write_text(text, encoding="utf-8")
    check(read_tissue(path, parse_mapping(entries)))


def test_micro_sign_of_windows(tmp_path):
    path = tmp_path / "record.csv"
    text = "Time [s];Deflection [µm];Force [N]\n" + table(";", (1, 1e6, 1))
    path.write_bytes(text.encode("cp1252"))
    check(read_tissue(path))


@pytest.mark.parametrize(("text", "name"), rows(__file__, "test_names"))
def test_names(text, name):
    assert read_name(text) == (name and Name(*name))


def test_of_two_columns_of_a_quantity_the_user_chooses(tmp_path):
    path = tmp_path / "record.csv"
    body = table(",", (1, 1e3, 1)).replace("\n", ",1\n")
    path.write_text(f"time_s,deflection_mm,force_N,Deflection [mm]\n{body}")
    with pytest.raises(DataError, match="there twice") as caught:
        read_tissue(path)
    assert "--map deflection_m=NAME" in str(caught.value.remedy)
    check(read_tissue(path, parse_mapping(["deflection_mm=deflection_mm"])))


@pytest.mark.parametrize(("name", "factor", "unit"), rows(__file__, "test_factors"))
def test_factors(name, factor, unit):
    """1 kgf = 9.80665 N by definition; 1 rpm = 2 pi/60 rad/s, but a command in rpm is a number."""
    found = read_name(name)
    assert (found.factor, found.read_as) == (pytest.approx(factor, rel=1e-15), unit)


def test_what_is_mapped_decides_between_layouts(tmp_path):
    layouts = [("time", "command", "angle"), ("time", "command", "velocity")]
    names = ["time_s", "command_rpm", "angle_deg", "w"]
    mapping = parse_mapping(["velocity_deg_s=w"])
    assert find_columns(names, layouts, mapping, ())[0] == layouts[1]
    assert find_columns(names, layouts, {}, ())[0] == layouts[0]


@pytest.mark.parametrize(
    ("entry", "remedy"), rows(__file__, "test_a_mapped_column_keeps_the_unit_that_it_says")
)
def test_a_mapped_column_keeps_the_unit_that_it_says(tmp_path, entry, remedy):
    theirs = entry.partition("=")[2]
    with pytest.raises(DataError, match="says") as caught:
        find_columns([theirs], [("time",)], parse_mapping([entry]), ())
    assert remedy in str(caught.value.remedy)


@pytest.mark.parametrize("entry", rows(__file__, "test_a_name_that_does_not_contradict_is_mapped"))
def test_a_name_that_does_not_contradict_is_mapped(entry):
    ours, _, theirs = entry.partition("=")
    quantity = read_name(ours).quantity
    layout, columns = find_columns([theirs], [(quantity,)], parse_mapping([entry]), ())
    assert (layout, columns[quantity].name) == ((quantity,), theirs)

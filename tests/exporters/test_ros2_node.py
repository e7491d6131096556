"""The node of ROS 2, compiled with headers that stand for ROS 2 and run on a clock of the test."""

import subprocess
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from nrs_design.controllers.replica import step
from nrs_design.exporters.export import Execution, export_design
from nrs_design.exporters.formats.ros2_node import FORMAT, render
from nrs_design.exporters.program import program_of
from nrs_design.exporters.write import places, write_files
from nrs_design.spec import read_spec
from tests.exporters.programs import STRICT, built, compiler, run
from tests.support import ROOT, skip_for_want_of

# Each compiles a node, or takes the one that is compiled.
pytestmark = pytest.mark.slow
STUB = Path(__file__).parent / "ros2_stub"
CPP = ("-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wconversion", "-Werror")
T = 2_000_000
STIFFNESS = 43.0
WAITING = "status waiting for measured_js and contact/measured_js"


def exported(name):
    file = ROOT / f"docs/examples/{name}.nrs.yaml"
    execution = Execution(Fraction(1, 500), unproved=True)
    return export_design(read_spec(file), execution=execution)


@pytest.fixture(scope="module")
def package(sampled_export, tmp_path_factory):
    """Write the package of a spec, the sampled one or an example, and compile it, each once."""

    @cache
    def of(name="sampled"):
        export = sampled_export if name == "sampled" else exported(name)
        files = places(FORMAT, export.record.spec.name, tmp_path_factory.mktemp("ros2"))
        write_files(FORMAT, files, render(export))
        folder = files["_ros2/package.xml"].parent
        built_here = folder / "node"
        objects = []
        for source in (folder / "src").glob("*.c"):
            objects.append(source.with_suffix(".o"))
            built(compiler(), *STRICT, "-c", source, "-o", objects[-1])
        node = folder / "src/node.cpp"
        built(compiler("g++"), *CPP, f"-isystem{STUB}", node, *objects, "-o", built_here)
        return export, folder

    return of


def told(folder, lines, code=0):
    """Return what a node publishes and says, line by line, for a script."""
    script = "\n".join(lines) + "\n"
    done = subprocess.run(
        [folder / "node"], input=script, capture_output=True, text=True, check=False, timeout=60
    )
    assert done.returncode == code, done.stderr
    return done.stdout.splitlines(), done.stderr


def commands(lines):
    return [float.fromhex(line.split()[1]) for line in lines if line.startswith("command ")]


def statuses(lines):
    return [line.removeprefix("status ") for line in lines if line.startswith("status ")]


def sample(k, angle, torque, *, late=0, old=0, joint="a"):
    """Return the messages of a sample, and the clock."""
    now = k * T + late
    return [
        f"joint measured_js {k * T} position {joint} {angle!r}",
        f"joint contact/measured_js {k * T - old} effort {joint} {torque!r}",
        f"at {now}",
    ]


def press(count):
    """Angles and torques of a tool that moves in and out of one elastic tissue."""
    angles = 0.004 + 0.0015 * np.sin(0.02 * np.arange(count))
    return [(float(angle), STIFFNESS * float(angle)) for angle in angles]


@pytest.mark.parametrize("name", ["sampled", "ur-like"])
def test_every_command_is_bit_for_bit_that_of_the_replica(package, name):
    """600 samples with a torque of any allowed age, and a velocity that is commanded on the way."""
    export, folder = package(name)
    youngest, oldest = export.record.delay
    law = program_of(export).law
    script, wanted = [], []
    state = {v.name: np.zeros(1, np.float32) for v in law.states}
    run_in = press(600)
    for k, (angle, torque) in enumerate(run_in, 1):
        if k == 100:
            script.append(f"joint servo_jv {k * T} velocity a 0.01")
        # Every other torque is that of the sample before, where it may be younger.
        old = T if oldest and (youngest or (k > 1 and k % 2)) else 0
        torque = run_in[max(k - 2, 0)][1] if old else torque
        script += sample(k, angle, torque, late=(k % 3) * 20_000, old=old)
        velocity = 0.01 if 100 <= k <= 150 else 0.0
        given = {"angle": angle, "torque": torque, "velocity_command": velocity}
        given = {name: np.array([value], np.float32) for name, value in given.items()}
        if k == 1:
            state = {
                v.name: given["angle"] if v.starts_at_angle else state[v.name] for v in law.states
            }
        result = step(law, np.zeros(1, np.uint32), given | state)
        assert result.valid[0]
        state = {name: result.states[name] for name in state}
        wanted.append(float(result.outputs["command"][0]))
    lines, errors = told(folder, script)
    assert errors == ""
    assert statuses(lines) == [WAITING.removeprefix("status "), "running"]
    assert commands(lines) == wanted
    assert len({*wanted}) > 500


def after(folder, script, good=5):
    """Run some good samples, what a test is about, and good samples again."""
    before = [line for k in range(1, good + 1) for line in sample(k, *press(good)[k - 1])]
    behind = [line for k in range(50, 53) for line in sample(k, *press(good)[0])]
    return told(folder, [*before, *script, *behind])


@pytest.mark.parametrize(
    ("script", "why"),
    [
        (
            sample(6, 0.004, 0.172, old=2 * T),
            "DELAY: the torque is 4.000000 ms old, and the proof allows 1",
        ),
        (sample(6, 0.004, 0.172, late=200_000), "the angle is 0.200000 ms old"),
        (sample(7, 0.004, 0.172), "JITTER: "),
        (sample(6, 0.004, 0.35), "FORCE: "),
        (sample(6, float("nan"), 0.172), "INPUT: "),
        (sample(6, 0.004, float("inf")), "FORCE: "),
        (["string mode withdrawal", *sample(6, 0.004, 0.172)], "INPUT: "),
        (sample(6, 0.004, 0.172, old=-T), "a measurement is from the future"),
        (["at 14000000"], "the angle is 4.000000 ms old"),
        (
            ["joint measured_js 12000000 effort a 0.1"],
            "measured_js has no position of the joint",
        ),
        (
            ["joint measured_js 12000000 position a 0.1 position b 0.1"],
            "measured_js has several joints: name one by the parameter joint",
        ),
    ],
    ids=lambda value: value.split(":")[0][:30] if isinstance(value, str) else "script",
)
def test_it_stops_says_why_and_stays_stopped(package, script, why):
    _, folder = package()
    lines, errors = after(folder, script)
    assert [text[:9] for text in statuses(lines)[2:]] == ["stopped: "]
    assert statuses(lines)[2].removeprefix("stopped: ").startswith(why)
    assert errors == f"{statuses(lines)[2]}\n"
    found = commands(lines)
    assert all(command != 0.0 for command in found[1:5])
    assert found[5:] == [0.0] * (len(found) - 5)
    assert len(found) >= 8


def test_without_measurements_it_waits_with_a_command_of_zero(package):
    _, folder = package()
    lines, _ = told(
        folder, ["joint measured_js 2000000 position a 0.1", "at 2000000", "at 4000000"]
    )
    assert lines == [WAITING, "command 0x0p+0", "command 0x0p+0"]


def test_before_it_runs_it_waits_for_what_is_fresh(package):
    """An angle, then a torque, that are too old are no reason to stop what has not begun."""
    _, folder = package()
    stale = [*sample(1, 0.004, 0.172, late=200_000), *sample(2, 0.004, 0.172, old=2 * T)]
    lines, errors = told(folder, [*stale, *sample(3, 0.004, 0.172), *sample(4, 0.005, 0.215)])
    assert (statuses(lines)[1:], errors) == (["running"], "")
    assert commands(lines)[:2] == [0.0, 0.0]
    assert commands(lines)[3] != 0.0


def test_one_joint_of_several_is_named_by_a_parameter(package):
    _, folder = package()
    name = "joint measured_js {} position x 0.9 position b {}"
    script = ["parameter joint b"]
    for k, (angle, torque) in enumerate(press(4), 1):
        script += [name.format(k * T, angle), *sample(k, angle, torque, joint="b")[1:]]
    lines, _ = told(folder, script)
    plain, _ = told(folder, [x for k, row in enumerate(press(4), 1) for x in sample(k, *row)])
    assert commands(lines) == commands(plain)
    assert statuses(lines)[1:] == ["running"]


def test_parameters_say_what_is_accepted_and_wrong_ones_end_the_node(package):
    _, folder = package()
    late = [*sample(1, 0.004, 0.172), *sample(2, 0.004, 0.172, late=200_000)]
    accepted = ["parameter angle_age 0.0003", "parameter jitter 0.0003"]
    lines, _ = told(folder, [*accepted, *late])
    assert statuses(lines)[1:] == ["running"]
    for name, text, most in (
        *(("jitter", text, "1.000000 ms") for text in ("0", "-1", "nan", "0.0011")),
        ("angle_age", "0.0021", "2.000000 ms"),
    ):
        lines, errors = told(folder, [f"parameter {name} {text}"], code=1)
        assert lines == []
        assert f"the parameter {name} must be above 0 s and at most {most}" in errors


def test_the_mode_follows_the_logic_and_positions_start_where_the_joint_is(package):
    """Position control up to 0.27 N m with a command towards the tissue; on the other side."""
    export, folder = package("force-by-threshold")
    law = program_of(export).law
    script, wanted = ["parameter side -1.0"], []
    state = {v.name: np.zeros(1, np.float32) for v in law.states}
    mode, held = law.logic.start, 0
    modes = set()
    for k in range(1, 401):
        angle = float(-0.004 - 0.0025 * np.sin(np.pi * k / 400))
        velocity = -0.02 if k < 300 else 0.02
        torque = STIFFNESS * angle
        script.append(f"joint servo_jv {k * T} velocity a {velocity!r}")
        if k == 50:
            script.append(f"joint servo_jp {k * T} position a -0.005")
            script.append(f"joint servo_jf {k * T} effort a -0.28")
        script += sample(k, angle, torque)
        mode, held = law.logic.step(
            mode, held, {"command": -np.float32(velocity), "torque": -np.float32(torque)}
        )
        modes.add(mode)
        given = {
            "angle": angle,
            "torque": torque,
            "position": -0.005 if k >= 50 else -0.004 - 0.0025 * np.sin(np.pi / 400),
            "wanted_torque": -0.28 if k >= 50 else 0.0,
        }
        given = {v.name: np.array([given[v.name]], np.float32) for v in law.inputs}
        result = step(law, np.array([mode], np.uint32), given | state)
        state = {name: result.states[name] for name in state}
        wanted.append(float(result.outputs["command"][0]))
    lines, errors = told(folder, script)
    assert errors == ""
    assert modes == {0, 1}
    assert commands(lines) == wanted


def test_what_is_missing_in_a_spec_is_said(package):
    """No age of the force: one sample, and it is no proof that allows it."""
    _, folder = package("force-by-threshold")
    page = (folder / "README.md").read_text()
    assert "the spec says nothing of its age: 1 sample is accepted" in page
    assert "UNPROVED" in page
    assert "`mode`" not in page


CMAKE = {
    "rclcpp": "add_library(rclcpp::rclcpp INTERFACE IMPORTED)\n"
    "set_target_properties(rclcpp::rclcpp PROPERTIES INTERFACE_INCLUDE_DIRECTORIES {stub})\n",
    "sensor_msgs": "set(sensor_msgs_TARGETS)\n",
    "std_msgs": "set(std_msgs_TARGETS)\n",
}


@pytest.fixture
def configured(package, tmp_path):
    """Let the real ament_cmake read the package; those of ROS 2 are some that stand for them."""
    cmake = compiler("cmake")
    if not Path("/usr/share/ament_cmake").is_dir():
        skip_for_want_of("ament_cmake")
    _, folder = package()
    for name, text in CMAKE.items():
        config = tmp_path / f"stub/share/{name}/cmake/{name}Config.cmake"
        config.parent.mkdir(parents=True)
        config.write_text(text.format(stub=STUB))
    done = run(
        *(cmake, "-S", folder, "-B", tmp_path / "build", "-DPython3_EXECUTABLE=/usr/bin/python3"),
        *(f"-DCMAKE_PREFIX_PATH={tmp_path}/stub;/usr", f"-DCMAKE_INSTALL_PREFIX={tmp_path}/out"),
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return tmp_path


def test_ament_reads_the_package(configured):
    """Under its name, with the flags of the proof."""
    made = (configured / "build/CMakeFiles/law.dir/flags.make").read_text()
    assert "-ffp-contract=off" in made
    cache_ = (configured / "build/CMakeCache.txt").read_text()
    assert "CMAKE_PROJECT_NAME:STATIC=nrs_soft_tissue\n" in cache_


def test_cmake_builds_and_installs_it(configured):
    for verb in ("--build", "--install"):
        done = run(compiler("cmake"), verb, configured / "build")
        assert done.returncode == 0, done.stdout + done.stderr
    out = configured / "out"
    for file in ("package.xml", "launch/node.launch.py", "config/node.yaml"):
        assert (out / "share/nrs_soft_tissue" / file).is_file()
    assert told(out / "lib/nrs_soft_tissue", ["at 2000000"]) == ([WAITING, "command 0x0p+0"], "")

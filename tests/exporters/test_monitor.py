"""The monitor in C reports first what `audit` finds in the log of the same run."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.exporters.formats.monitor import KINDS, render
from nrs_design.exporters.monitor_limits import monitor_limits
from nrs_design.identification.running.bounds import bounds_of_spec
from nrs_design.identification.running.judge import judge_run
from nrs_design.identification.running.log import read_run
from tests.exporters.monitor_study import sources
from tests.exporters.monitored import Monitor, spec_with
from tests.exporters.programs import (
    LAWS,
    STRICT,
    built,
    check_that_it_calls_nothing,
    check_with_misra,
    compiler,
    emulated,
    run,
    source_file,
    write_formats,
)
from tests.identification import runs
from tests.tables import rows

LAW = LAWS["inertia"]
# Of the checks of `audit`, what the monitor calls them.
SAME = {"dwell times": {"STAY", "ORDER"}, "saturation": {"SATURATION"}, "force": {"FORCE"}}


class Watching(Monitor):
    def watch(self, log):
        steps = np.diff(log.time, prepend=log.time[0] - log.step)
        modes = [LAW.modes.index(log.labels[k]) for k in log.modes]
        columns = (log.columns[name] for name in ("angle", "torque", "command"))
        for time, step, mode, *rest in zip(log.time, steps, modes, *columns, strict=True):
            angle, torque, command = rest
            found = self.step(mode=mode, step=step, angle=angle, torque=torque, command=command)
            if found != "NONE":
                return found, log.begin + float(time)
        return "NONE", None


@pytest.fixture
def monitor(tmp_path, sampled_export):
    return lambda spec: Watching(tmp_path, sources(sampled_export, spec))


def log_of(folder, data):
    path = folder / "run.csv"
    path.write_text(runs.text(*data))
    return read_run(path)


def changed(data, **columns):
    names = ("t", "angle", "torque", "command", "mode")
    return tuple(
        columns[name](values) if name in columns else values
        for name, values in zip(names, data, strict=True)
    )


def peak(at, size):
    return lambda values: values + np.where(np.arange(len(values)) == at, size, 0.0)


@pytest.mark.parametrize(
    ("rules", "data"),
    [
        ("arbitrary", runs.run()),
        ("arbitrary", runs.run(seed=3, noise=0.002)),
        ("arbitrary", runs.run(stiffness=48.0)),
        ("arbitrary", runs.run(stiffness=lambda t: np.where(t > 6, 33.0, runs.STIFFNESS))),
        ("arbitrary", runs.run(stiffness=lambda t: 43.0 + 8.0 * np.sin(9.0 * t))),
        ("arbitrary", runs.run(stiffness=-runs.STIFFNESS)),
        ("arbitrary", runs.run(free=2.0)),
        ("arbitrary", runs.run(free=2.0, noise=0.0)),
        ("arbitrary", changed(runs.run(), torque=peak(3000, 0.3))),
        ("arbitrary", changed(runs.run(), torque=peak(3000, -0.6))),
        ("arbitrary", changed(runs.run(), command=peak(2000, 4000.0))),
        ("{dwell_time: 2 s}", runs.run()),
        ("{dwell_time: 2.503 s}", runs.run()),
        ("{dwell_time: 1 s, longest_dwell_time: 2 s}", runs.run()),
        ("{transitions: [[insertion, withdrawal]]}", runs.run()),
    ],
    ids=lambda value: value if isinstance(value, str) else "run",
)
def test_it_reports_first_what_audit_finds(tmp_path, monitor, rules, data):
    """The same kind at the same time; nothing where nothing is found, whatever the stiffness."""
    spec, log = spec_with(rules), log_of(tmp_path, data)
    found = judge_run(log, replace(bounds_of_spec(spec), saturates=3000.0), proved=True)
    kind, time = monitor(spec).watch(log)
    if found.first is None:
        assert kind == "NONE"
        return
    assert kind in SAME[found.first.name]
    begin = found.first.time
    assert begin <= time <= begin + (2.6 if found.first.name == "dwell times" else 0.0)


def test_one_sample_at_a_time(monitor):
    """What no log of `audit` has: the age of the force, steps of time, what is no number."""
    watching = monitor(spec_with())
    for given, kind in rows(__file__, "test_one_sample_at_a_time"):
        watching.begin()
        assert watching.step(**given) == kind
        assert watching.step() == kind
    watching.begin()
    assert watching.step() == "NONE"


def test_what_is_left_out_is_said(sampled_export):
    files = render(sampled_export)
    words = " ".join(files["_monitor.h"].decode().replace("\n *", " ").split())
    assert "for certain" not in words
    for text in (
        "Not monitored: Stiffness, and whether contact is kept: the spec has no `monitoring`, so "
        "nothing says how far readings are off.",
        "Not monitored: Saturation: the spec has no `limits: command`.",
        "Not monitored: Dead time of the motion",
        "is no part of the proof",
        sampled_export.record.proof.certificate_id,
    ):
        assert text in words
    for kind in KINDS:
        unknown = kind in ("SPEED", "STIFFNESS", "PULL", "FAST", "REGION")
        assert (f"_LEFT_{kind} " in words) == (not unknown)


def test_it_compiles_for_the_processor_and_links_to_nothing(tmp_path, sampled_export):
    for name, text in sources(sampled_export, spec_with()).items():
        (tmp_path / name).write_text(text)
    own = ["nrs_x_monitor_init", "nrs_x_monitor_step"]
    check_that_it_calls_nothing(tmp_path, tmp_path / "x_monitor.c", own)


# The torque is beyond its limit from sample 1000 on; what is told, and when.
PRESS = source_file("press.c")


@pytest.mark.slow
def test_on_an_emulated_processor_it_tells_the_same(tmp_path, sampled_export):
    for name, text in (sources(sampled_export, spec_with()) | {"main.c": PRESS}).items():
        (tmp_path / name).write_text(text)
    files = (tmp_path / "x_monitor.c", tmp_path / "main.c")
    built(compiler(), *STRICT, "-O2", *files, "-o", tmp_path / "here")
    here = run(tmp_path / "here").stdout
    assert emulated(tmp_path, *files) == f"0: {here}"
    kind, sample = here.split(" at ")
    assert int(kind) == [*KINDS].index("FORCE")
    assert 1000 <= int(sample) < 1400


@pytest.mark.slow
def test_cppcheck_with_misra_is_content(tmp_path, sampled_export):
    for name, text in sources(sampled_export, spec_with("{dwell_time: 2 s}")).items():
        (tmp_path / name).write_text(text)
    check_with_misra(tmp_path / "x_monitor.c")


@pytest.mark.parametrize("flag", ["-ffast-math", "-ffinite-math-only"])
def test_a_compiler_that_knows_no_nan_is_refused(tmp_path, sampled_export, flag):
    """It would leave out that a torque is no number: nothing would ever be left."""
    gcc = compiler()
    write_formats(tmp_path, sampled_export, ("c", "monitor"))
    (source,) = tmp_path.glob("*_monitor.c")
    built(gcc, *STRICT, "-c", source, "-o", tmp_path / "o")
    done = run(gcc, "-std=c99", flag, "-c", source, "-o", tmp_path / "o")
    assert done.returncode != 0
    assert "NaN comparisons must be false" in done.stderr


def test_what_is_monitored_is_what_the_spec_says(sampled_export):
    stays = spec_with("{dwell_time: 2.501 s, longest_dwell_time: 5.001 s}")
    limits = monitor_limits(replace(sampled_export, spec=stays), LAW)
    assert limits.dwell_times == ((1251, 2500), (1251, 2500))
    limits = monitor_limits(replace(sampled_export, spec=spec_with()), LAW)
    assert limits.torque <= Fraction(3, 10) < limits.torque * (1 + Fraction(1, 2**22))
    assert (limits.age, limits.command) == ((0, 1), 3000)


def test_rules_that_name_contacts_are_not_followed(sampled_export):
    spec = spec_with("{transitions: [[insertion, withdrawal]]}")
    limits = monitor_limits(replace(sampled_export, spec=spec), LAW)
    assert limits.successors == ((True, True), (False, True))
    rules = spec.switching.model_copy(update={"transitions": (("insertion/a", "withdrawal/b"),)})
    named = replace(sampled_export, spec=spec.model_copy(update={"switching": rules}))
    limits = monitor_limits(named, LAW)
    assert limits.successors == ((True, True), (True, True))
    assert [text for text in limits.left_out if "name contacts" in text]

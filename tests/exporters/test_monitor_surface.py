"""The monitor tells no stiffness inside its range, and every one outside that its header names."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.sector import Sector, sector_of
from nrs_design.exporters.sector_numbers import FACTORS, sector_words
from nrs_design.identification.running.bounds import bounds_of_spec
from nrs_design.identification.running.log import read_run
from nrs_design.identification.running.sector import judge_sector
from tests.exporters.monitor_study import (
    SAMPLING,
    TEXT,
    VISCOUS,
    monitored,
    need_of,
    sources,
    study,
)
from tests.exporters.monitored import Monitor
from tests.exporters.programs import (
    CORTEX,
    STRICT,
    built,
    check_with_misra,
    compiler,
    emulated,
    source_file,
)
from tests.identification import runs

SPEEDS = "  speed: 0.5 rad/s\n"
VISCOUS_TEXT = TEXT.replace("    model: elastic", VISCOUS) + SAMPLING
# Of the damping 0.2 N s/m at 0.24 m.
DAMPING = 0.2 * 0.24**2
CASES = {
    "fixed": (monitored(), 0.0),
    "free": (monitored("free"), 0.0),
    "touched": (monitored("touched", "6 N*mm"), 0.0),
    "drift": (monitored(more="  surface_speed: 1e-3 rad/s\n"), 0.0),
    "skew": (monitored(more=f"{SPEEDS}  skew: 0.2 ms\n"), 0.0),
    "kept": (monitored(contact="kept"), 0.0),
    "viscous": (monitored(more=SPEEDS, text=VISCOUS_TEXT), DAMPING),
}


class Reader(Monitor):
    """A monitor that is fed by readings alone."""

    @property
    def judged(self):
        """What it counted: behind five words and the flags stands `touched`, then `judged`."""
        return self.memory[6], self.memory[7]

    def read(self, angle, torque, age=0):
        return self.step(angle=float(angle), torque=float(torque), age=age)


@pytest.fixture
def monitor(tmp_path, sampled_export):
    return lambda spec: Reader(tmp_path, sources(sampled_export, spec))


def runs_of(folder, export, case, count, seed):
    spec, damping = CASES[case]
    return study(folder, export, spec, damping=damping)(count, seed)


@pytest.mark.parametrize("case", CASES)
def test_no_alarm_while_what_is_told_holds(tmp_path, sampled_export, case):
    """Whatever the stiffness does in its range; the theorem is in docs/exports/monitor.md."""
    found = runs_of(tmp_path, sampled_export, case, 450, 1)
    assert len(found) == 9
    for count, alarms, touched, judged, samples in found.values():
        assert (count, alarms) == (50, 0)
        assert touched > samples / 10
        assert judged > touched / 2


@pytest.mark.nightly
@pytest.mark.parametrize("case", CASES)
def test_no_alarm_in_a_hundred_thousand_runs(tmp_path, sampled_export, case):
    count = 100_000 if case == "fixed" else 20_000
    found = runs_of(tmp_path, sampled_export, case, count, 7)
    assert sum(drawn for drawn, *_ in found.values()) == count
    assert sum(alarms for _, alarms, *_ in found.values()) == 0


@pytest.mark.parametrize("case", ["fixed", "free"])
def test_violations_are_found(tmp_path, sampled_export, case):
    """In half of the runs, noise hides what it can; in the others it is what it is."""
    spec, _ = CASES[case]
    drawn = study(tmp_path, sampled_export, spec)
    for factor in (0.5, 0.8, 1.2, 1.5, 2.0, 4.0):
        need, more = need_of(spec, factor)
        totals = np.sum([*drawn(900, 2, factor, need, more).values()], axis=0)
        strong, found, _, missed = totals.tolist()
        assert missed == 0
        assert found > 0.95 * strong


def hidden(spec, factor, torque, gap):
    sector = sector_of(spec)
    e, a = float(sector.torque_noise), float(sector.angle_noise)
    k = factor * float(sector.high if factor > 1 else sector.low)
    # Contact is certain, just.
    light = 2.002 * e + k * gap
    if factor > 1 and spec.monitoring.surface != "touched":
        first = (-gap - a, e)
    elif factor > 1:
        first = (light / k - a, light + e)
    else:
        first = (light / k + a, light - e)
    way = 1 if factor > 1 else -1
    return [(-0.01, 0.0), (-0.01, 0.0), first, (torque / k + way * a, torque - way * e)]


@pytest.mark.parametrize("case", ["fixed", "free", "touched"])
def test_the_need_is_what_noise_cannot_hide(monitor, case):
    """Told a percent above it, and not a percent below: the formula has nothing to spare."""
    spec, _ = CASES[case]
    watching, sector = monitor(spec), sector_of(spec)
    for factor, gap in product(FACTORS, (0.0, 1e-4)):
        need = float(sector.need(factor, Fraction(gap)))
        for share, kind in ((1.01, "STIFFNESS"), (0.99, "NONE")):
            watching.begin()
            readings = hidden(spec, float(factor), share * need, gap)
            last = [watching.read(1.0 + angle, torque) for angle, torque in readings][-1]
            assert last == kind, (factor, gap, share)


def test_the_need_of_a_known_tissue():
    """Worked by hand: 40 to 50 N m/rad, 1 mN m, no noise of the angle, twice the range.

    2 * 0.001 * (1/40 + 1/50) = 9e-5 rad, over 1/50 - 1/100: 9 mN m.
    """
    zero = Fraction(0)
    sector = Sector(
        *(Fraction(40), Fraction(50), Fraction(1, 1000), zero, zero, "fixed", zero, False, None)
    )
    assert sector.need(Fraction(2)) == Fraction(9, 1000)
    assert sector.need(Fraction(2), Fraction(1, 10**4)) == Fraction(19, 1000)
    # Half of 40: (9e-5 + 2e-3 (1/20 - 1/50)) / (1/20 - 1/40) = 6 mN m.
    assert sector.need(Fraction(1, 2)) == Fraction(6, 1000)
    (words,) = (w for w in sector_words(sector, zero) if w.startswith("c = 2:"))
    assert words.startswith("c = 2: N = 0.00916 N*m")


def leaves_a_surface(sector, readings):
    """Tell in exact numbers whether some surface is left, and by how much, in rad."""
    low, high = -Fraction(10), Fraction(10)
    for angle, torque in readings:
        least, most = torque - sector.torque_noise, torque + sector.torque_noise
        near, far = angle - sector.angle_noise, angle + sector.angle_noise
        if not sector.contact_maintained and most < 0:
            return most
        low = max(low, near - max(most / sector.low, most / sector.high))
        if sector.contact_maintained or least > 0:
            high = min(high, far - min(least / sector.low, least / sector.high))
    return high - low


SAMPLES = st.lists(
    st.tuples(st.floats(-1.0, 1.0), st.floats(0.9, 1.1), st.floats(-1.0, 1.0)),
    min_size=1,
    max_size=12,
)


@pytest.mark.parametrize("case", ["fixed", "kept"])
def test_it_is_the_exact_intersection(monitor, case):
    """Never where a surface is left; always where none is, but for single precision."""
    spec, _ = CASES[case]
    watching, sector = monitor(spec), sector_of(spec)
    ends = (float(sector.low), float(sector.high))

    @given(SAMPLES, st.sampled_from([0.0, 1.0, -3.0]))
    def holds(samples, centre):
        readings = []
        for depth, factor, noise in samples:
            k = factor * ends[noise > 0]
            deep = 0.007 * depth if sector.contact_maintained else max(0.007 * depth, 0.0)
            angle = np.float32(centre + 0.007 * depth + float(sector.angle_noise) * noise)
            torque = np.float32(k * deep - float(sector.torque_noise) * noise)
            readings.append((angle, torque))
        watching.begin()
        told = [watching.read(*reading) for reading in readings][-1]
        exact = [(Fraction(float(a)), Fraction(float(t))) for a, t in readings]
        left = leaves_a_surface(sector, exact)
        if left >= 0:
            assert told == "NONE"
        elif left < -Fraction(4, 10**6):
            assert told in ("STIFFNESS", "PULL")

    holds()


def test_a_pull_a_jump_and_a_wrong_age(monitor):
    skewed, _ = CASES["skew"]
    watching = monitor(skewed)
    for angle, torque, kind in (
        (0.0, -0.0019, "NONE"),
        (0.0, -0.0021, "PULL"),
        (0.0, float("nan"), "FORCE"),
    ):
        watching.begin()
        assert watching.read(angle, torque) == kind
    # 0.5 rad/s for 2 ms, and two readings of the angle.
    for way, kind in ((0.00115, "NONE"), (0.00116, "FAST"), (-0.00116, "FAST")):
        watching.begin()
        assert watching.read(3.0, 0.0) == "NONE"
        assert watching.read(3.0 + way, 0.0) == kind
    watching.begin()
    # Of the first sample, nobody knows the angle of before; an age beyond the spec is told.
    assert watching.read(0.0, 0.2, age=1) == "NONE"
    assert watching.read(0.0, 0.2, age=2) == "DELAY"


def test_an_old_torque_belongs_to_the_angle_of_then(monitor):
    """Pressed from 0 to 5 mrad within a sample: 43 N m/rad with the age, 0 or 86 without."""
    spec, _ = CASES["fixed"]
    watching = monitor(spec)
    for ages, kind in (((0, 1, 1), "NONE"), ((0, 0, 0), "STIFFNESS")):
        watching.begin()
        readings = zip((0.0, 0.005, 0.0075), (0.0, 0.0, 0.215), ages, strict=True)
        assert [watching.read(a, t, age) for a, t, age in readings][-1] == kind


@pytest.mark.parametrize("case", ["fixed", "free", "touched"])
def test_what_is_judged_is_within_the_factor(monitor, case):
    """After samples in range, one beyond the factor is never counted, and one in range is."""
    watching, sector = monitor(CASES[case][0]), sector_of(CASES[case][0])
    low, high = float(sector.low), float(sector.high)
    e, a = float(sector.torque_noise), float(sector.angle_noise)
    for k, some in ((1.501 * high, 0), (low / 1.501, 0), (high, 1), (low, 1)):
        for before, way in product((low, high), (-1.0, 0.0, 1.0)):
            watching.begin()
            for torque in (0.0, 0.0, 0.02):
                watching.read(1.0 + torque / before - way * a, torque + way * e)
            assert watching.judged == (1, 0)
            watching.read(1.0 + 0.25 / k - way * a, 0.25 + way * e)
            assert watching.judged[1] <= some
            assert watching.judged[1] == some or way


@pytest.mark.parametrize(("surface", "kind"), [("fixed", "STIFFNESS"), ("free", "NONE")])
def test_a_surface_that_moves_in_the_air(monitor, surface, kind):
    watching = monitor(monitored(surface))
    for place in (0.0, 0.01):
        for depth in (-0.001, 0.002, 0.004):
            last = watching.read(place + depth, 43.0 * max(depth, 0.0))
    assert last == kind


@pytest.mark.parametrize("surface", ["fixed", "free", "touched"])
@pytest.mark.parametrize("factor", [0.5, 1.0, 1.2, 2.0])
def test_audit_tells_the_same_of_a_log(monitor, tmp_path, surface, factor):
    spec = monitored(surface, text=TEXT + "sampling: {period: 2 ms, delay: 0}\n")
    watching, random = monitor(spec), np.random.default_rng(3)
    t = 0.002 * np.arange(2500)
    depth = 0.001 + 0.003 * np.sin(2 * np.pi * 0.9 * t) + 0.0004 * np.sin(2 * np.pi * 3.1 * t)
    k = np.where(t > 1.5, factor, 1.0) * runs.STIFFNESS
    noise = random.uniform(-1, 1, (2, len(t)))
    torque = k * np.maximum(depth, 0.0) + 0.0019 * noise[0]
    angle = 0.3 + depth + np.radians(0.0043) * noise[1]
    file = tmp_path / "run.csv"
    file.write_text(runs.text(t, angle, torque, np.zeros_like(t), np.full(len(t), "insertion")))
    log = read_run(file)
    columns = zip(log.columns["angle"], log.columns["torque"], strict=True)
    told = [row for row, read in enumerate(columns) if watching.read(*read) != "NONE"][:1]
    first = judge_sector(log, bounds_of_spec(spec))[0][0].time
    assert (first is None) == (told == []) == (factor == 1.0)
    assert first is None or first == pytest.approx(log.time[told[0]])


@pytest.mark.parametrize(
    ("changes", "reason"),
    [({"monitoring": None}, "no `monitoring`"), ({"contact": None}, "does not say by `contact`")],
)
def test_what_is_not_monitored_says_why(sampled_export, changes, reason):
    spec, _ = CASES["fixed"]
    spec = spec.model_copy(update=changes)
    assert reason in sector_of(spec)
    texts = sources(sampled_export, spec)
    header = " ".join(texts["x_monitor.h"].replace("\n *", " ").split())
    assert "Not monitored: Stiffness, and whether contact is kept: " in header
    assert reason in header
    assert "STIFFNESS" not in texts["x_monitor.c"]


def test_tissues_and_ages_that_do_not_fit():
    maxwell = TEXT.replace("    model: elastic", "    model: maxwell\n    damping: 1 N*s/m")
    assert "does not follow from angle" in sector_of(monitored(text=maxwell))
    assert "a tissue has damping" in sector_of(monitored(text=VISCOUS_TEXT))
    old = monitored("free")
    old = old.model_copy(update={"sampling": old.sampling.model_copy(update={"delay": (0, 2)})})
    assert "order of contacts" in sector_of(old)


# The timer of the processor counts the clock of the emulator, 43.008 ticks to an instruction.
COUNT = source_file("count.c")


def test_with_all_other_checks_it_takes_less_than_two_hundred_instructions(
    tmp_path, sampled_export
):
    text = TEXT.replace("bandwidth: 2 Hz", "bandwidth: 2 Hz\n  command: 3000 rpm")
    text = text.replace("switching: arbitrary", "switching: {dwell_time: 60 ms}")
    text = text.replace("range: [720.56 N/m, 768.17 N/m]", "range: [747.1461 N/m, 747.1461 N/m]")
    spec = monitored("free", text=text, more=f"{SPEEDS}  skew: 0.1 ms\n")
    for name, content in (sources(sampled_export, spec) | {"main.c": COUNT}).items():
        (tmp_path / name).write_text(content)
    said = emulated(tmp_path, tmp_path / "x_monitor.c", tmp_path / "main.c", counted=True)
    code, ticks, left, judged = said.replace(":", "").split()
    assert (code, left) == ("0", "0")
    assert int(judged) > 500
    assert 50 < int(ticks) / 43.008 < 200


@pytest.mark.parametrize("case", CASES)
def test_it_compiles_for_the_processor(tmp_path, sampled_export, case):
    for name, text in sources(sampled_export, CASES[case][0]).items():
        (tmp_path / name).write_text(text)
    flags = (*CORTEX, *STRICT, "-O2")
    built(compiler("arm-none-eabi-gcc"), *flags, "-c", tmp_path / "x_monitor.c", "-o", "/dev/null")


@pytest.mark.parametrize("case", ["drift", "skew", "kept"])
def test_cppcheck_with_misra_is_content(tmp_path, sampled_export, case):
    for name, text in sources(sampled_export, CASES[case][0]).items():
        (tmp_path / name).write_text(text)
    check_with_misra(tmp_path / "x_monitor.c")

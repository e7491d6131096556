"""Commands of the hand and of the motor, under disturbances, and runs against the bound."""

import json
from fractions import Fraction
from math import ceil

import numpy as np
import pytest
from flint import fmpq, fmpq_mat

from nrs_design.certificates.bounds import bound_on
from nrs_design.certificates.certificate import dump
from nrs_design.certificates.verify import verify_document
from nrs_design.controllers.float32 import round_float32
from nrs_design.errors import AssemblyError
from nrs_design.pipeline.certification import search_limits
from nrs_design.pipeline.runs import run_certification
from nrs_design.reporting.sections.proof import proof_section
from tests.loop.support import assembled, loaded
from tests.search.support import thesis_robot
from tests.support import SOFT_TISSUE, words_of

TEXT = SOFT_TISSUE.read_text(encoding="utf-8")
Kp, D = Fraction(np.float32(117359.436).item()), Fraction(1_030_000)
SAMPLING = "sampling: {period: 2 ms, delay: 1}\ncontact: kept\n"
# A driver of 10000 rpm, behind an encoder that turns five times as far as the joint.
COMMANDED = "disturbances: {command: 7.5 deg/s}\n"
ERRORS = "disturbances: {command: 8 deg/s, encoder_step: 0.00878906 deg, largest_angle: 20 deg}\n"


def spec_of(disturbances, limit="2000 rpm", sampling=SAMPLING):
    head, _, _ = TEXT.partition("controllers:")
    limits = "bandwidth: 2 Hz\n" + (f"  command: {limit}\n" if limit else "")
    text = (
        f"{head.replace('bandwidth: 2 Hz', limits)}controllers:\n  insertion: {{type: impedance, "
        "environment: soft, Mt: 0.01 kg*m^2, Bt: 2.15 N*m*s/rad}\nswitching: arbitrary\n"
    )
    return loaded(text + sampling + disturbances)


def system_of(disturbances, **limit):
    return assembled(spec_of(disturbances, **limit).text)


def command_of(system):
    return next(o for o in system.outputs if o.name.startswith("motor command"))


def test_rows_hold_every_rounding():
    """``Kp e + D (e - e before)`` with each term off by any share that its roundings allow."""
    system = system_of(COMMANDED)
    output = command_of(system)
    assert (output.name, output.unit, output.limit) == ("motor command", "rpm", 2000)
    rows = [row.fractions()[0] for row in output.rows]
    e, before = system.states.index("e [rad]"), system.states.index("e before [rad]")
    assert all(not any(v for i, v in enumerate(row) if i not in (e, before)) for row in rows)
    middle = [sum(column) / len(rows) for column in zip(*rows, strict=True)]
    assert (middle[e], middle[before]) == (Kp + D, -D)
    rng = np.random.default_rng(3)
    for errors in rng.uniform(-1e-3, 1e-3, (50, 2)):
        now, last = map(np.float32, errors)
        change = np.float32(now - last)
        drive = np.float32(np.float32(Kp) * now) + np.float32(np.float32(D) * change)
        values = [float(row[e]) * float(now) + float(row[before]) * float(last) for row in rows]
        assert min(values) <= float(drive) <= max(values)
        assert max(values) - min(values) < 1e-5 * (abs(float(Kp + D) * now) + abs(float(D) * last))


def test_errors_of_the_sample_are_taken_off_the_limit():
    """An encoder that is half a step off changes the command of the sample by ``Kp + D`` times."""
    system = system_of(ERRORS)
    output = command_of(system)
    assert output.name == "motor command before errors of its sample"
    half = np.radians(0.00878906) / 2
    taken = float(2000 - output.limit)
    assert taken == pytest.approx(float(Kp + D) * half, rel=2e-2)
    assert taken > float(Kp + D) * half
    (text,) = (t for t in words_of(system) if "it does not saturate" in t)
    assert f"less {taken:.5g}"[:8] in text
    # So large an error leaves nothing of the limit, and none is shown.
    small = command_of(system_of(ERRORS, limit="50 rpm"))
    assert small.limit is None


def test_where_it_is_not_asked_for():
    """Without a limit or disturbances, nothing is said of it."""
    for system in (system_of(COMMANDED, limit=None), system_of("")):
        assert all("motor command" not in o.name for o in system.outputs)
        assert "does not saturate" not in " ".join(words_of(system))


def worst_signs(system, mode):
    """Return the direction of a command at each sample that moves the motor most in the end."""
    row = command_of(system).rows[0].floats()[0]
    moved, signs = np.array(system.channels[0].columns[0].floats())[:, 0], []
    for _ in range(300):
        signs.append(np.sign(row @ moved))
        moved = np.array(system.modes[mode].A.floats()) @ moved
    return signs[::-1]


@pytest.mark.slow
@pytest.mark.parametrize(("speed", "level", "kept"), [("7.5", 1936, True), ("8", 2065, False)])
def test_the_numbers_of_the_page(speed, level, kept):
    """docs/certificates/reference.md: proved, and found at two stiffnesses.

    Where the limit is kept, runs in single precision stay below the bound and come near.
    """
    driven = spec_of(f"disturbances: {{command: {speed} deg/s}}\n")
    result = run_certification(driven, limits=search_limits(driven.spec, optimize_rate=False))
    system = result.certification.system
    bound = bound_on(system, result.certification.statements, "motor command")
    assert ceil(bound.level) == level
    claim = next(s for s in result.certificate.statements if "motor" in s.claim(system))
    assert ("The limit of 2000 rpm is kept." in claim.claim(system)) is kept
    assert claim.covers_rounding
    if not kept:
        return
    stiffest = float(driven.spec.environments["soft"].exact_at_pivot()["stiffness"].high)
    for k, mode, found in ((43.0, 0, 1019), (stiffest, -1, 1040)):
        pushes = np.radians(7.5) * np.array([[*worst_signs(system, mode), 0.0]])
        assert int(np.abs(_commands(pushes, bound_law(result), k)).max()) == found
    # An ellipsoid reaches further than what a jump of the command does at once.
    assert found > 0.5 * float(bound.level)
    signs = np.random.default_rng(5).choice([-1.0, 1.0], (500, 60))
    pushes = np.radians(7.5) * np.repeat(signs, 5, axis=1)
    assert np.abs(_commands(pushes, bound_law(result))).max() <= bound.level
    said = str(proof_section(result))
    assert "the driver does not saturate." in said
    assert "saturation of motor or driver." not in said
    assert verify_document(json.loads(dump(result.certificate)), driven).fault is None


def bound_law(result):
    (controller,) = result.designed.design.controllers
    return controller.law.discretize(Fraction(1, 500), "exact").numbers


def _commands(pushes, law, k=43.0):
    """Run the law in single precision, contact kept and the force a sample old."""
    single, T, Km, tau = np.float32, 0.002, 4.8417e-4, 0.0351
    n = len(pushes)
    theta, omega, late = np.zeros(n), np.zeros(n), np.zeros(n, single)
    reference, before, velocity = (np.zeros(n, single) for _ in range(3))
    E, found = np.exp(-T / tau), []
    for push in pushes.T:
        error = reference - theta.astype(single)
        drive = single(Kp) * error + single(D) * (error - before)
        reference = reference + single(law["T"]) * (push.astype(single) - velocity)
        velocity = single(law["a"]) * velocity + single(law["b"]) * late
        before, late = error, (k * theta).astype(single)
        held = Km * drive.astype(float)
        theta = theta + tau * (1 - E) * omega + (T - tau * (1 - E)) * held
        omega = E * omega + (1 - E) * held
        found.append(drive.astype(float))
    return np.array(found)


SOFT = ("41.5", "44.2")


def at_rest(A, B):
    """Solve ``A x + B = 0``."""
    n = len(A)
    left = fmpq_mat(n, n, [fmpq(e.numerator, e.denominator) for row in A for e in row])
    right = fmpq_mat(n, 1, [fmpq(-e.numerator, e.denominator) for (e,) in B])
    x = left.solve(right)
    return [Fraction(int(x[i, 0].p), int(x[i, 0].q)) for i in range(n)]


COMMAND = {"disturbances": "{command: 8 deg/s}"}


@pytest.mark.parametrize("Mt", ["0.01", "0"])
@pytest.mark.parametrize(
    ("tolerance", "load"), [("0", None), ("0.02", None), ("0", "1.213"), ("0.1", "1.213")]
)
def test_a_constant_command_ends_in_the_force_of_the_damping(Mt, tolerance, load):
    """At rest the admittance moves as commanded, ``F = Bt vc``, whatever motor and stiffness are.

    Thesis 6.2; the motor needs an error for that where the contact loads it, but no other force.
    """
    Bt = round_float32(Fraction("2.15"))
    system = thesis_robot(SOFT, ("2.15",), Mt, tolerance, load, **COMMAND)
    (channel,) = system.channels
    force = system.outputs[0]
    ends = {row.fractions()[0][-1] for row in force.rows}
    assert ends == {Fraction("41.5"), Fraction("44.2")}
    assert len(channel.columns) == len(system.modes) + len(system.contact.free)
    for mode, B in zip(system.modes, channel.columns, strict=False):
        rest = at_rest(mode.A.fractions(), B.fractions())
        stiffness = Fraction("41.5") if "k-min" in mode.name else Fraction("44.2")
        assert stiffness * rest[-1] == Bt


def test_a_free_axis_follows_the_command():
    """``omega = vc`` at rest; the error is what the motor needs to turn at that speed."""
    system = thesis_robot(SOFT, ("2.15",), "0.01", "0.02", "1.213", **COMMAND)
    for mode, B in zip(system.contact.free, system.channels[0].columns[-4:], strict=True):
        A = [row[:-1] for row in mode.A.fractions()[:-1]]
        assert at_rest(A, B.fractions()[:-1])[1] == 1


def test_a_spring_is_refused():
    """The command adds up to a position that the loop does not hold as a state."""
    gains = "2.15 N*m*s/rad, Kt: 0.5 N*m/rad, desired_impedance: 2"
    with pytest.raises(AssemblyError, match="the spring Kt draws the robot to"):
        thesis_robot(SOFT, (gains,), "0.01", **COMMAND)

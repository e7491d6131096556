"""The axes of an arm that takes torques, at once: motions by the equations of motion."""

from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.errors import AssemblyError, SpecError
from nrs_design.models.contact.elastic import Elastic
from nrs_design.models.contact.environment import Environment
from nrs_design.models.drive import torque_drive
from nrs_design.models.interval import Interval
from nrs_design.pipeline import run_certification
from nrs_design.spec import read_spec
from nrs_design.switched.mobility import Mobility, push_of

T = 0.001
LOW, HIGH = 0.8, 1.25
# Axes that are not alike: inertia, friction, range of the stiffness, (stiffness, damping) of laws.
AXES = {
    "turn": (0.2, 0.5, (30, 45), [(30, 3), (60, 5)]),
    "light": (0.05, 0.2, (5, 8), [(6, 0.5), (9, 0.7)]),
    "slide": (3.0, 6.0, (700, 900), [(500, 60), (900, 80)]),
}
SPEC = """\
kind: task-space
name: arm
common:
  coupling: {{mobility: [{LOW}, {HIGH}]}}
  switching: arbitrary
  sampling: {{period: 1 ms, delay: 0}}
  contact: kept
axes:
"""
AXIS = """\
  {name}:
    axis: {axis}
    torque_interface: {{inertia: {J} {kg}, friction: {B} {Ns}}}
    limits: {{velocity: {v}, torque: 3 {N}, bandwidth: 2 Hz}}
    environments:
      tissue:
        model: elastic
        stiffness: {{nominal: {low} {Nm}, range: [{low} {Nm}, {high} {Nm}]}}
    controllers:
"""
LAW = """\
      {name}:
        type: torque-impedance
        environment: tissue
        stiffness: {K} {Nm}
        damping: {D} {Ns}
"""
UNITS = {
    "rotary": {"kg": "kg*m^2", "Ns": "N*m*s/rad", "N": "N*m", "Nm": "N*m/rad", "v": "8 deg/s"},
    "prismatic": {"kg": "kg", "Ns": "N*s/m", "N": "N", "Nm": "N/m", "v": "30 mm/s"},
}


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "arm.nrs.yaml"
    text = SPEC.format(LOW=LOW, HIGH=HIGH)
    for name, (J, B, (low, high), laws) in AXES.items():
        axis = "prismatic" if name == "slide" else "rotary"
        units = UNITS[axis]
        text += AXIS.format(name=name, axis=axis, J=J, B=B, low=low, high=high, **units)
        text += "".join(
            LAW.format(name=f"law{i}", K=K, D=D, **units) for i, (K, D) in enumerate(laws)
        )
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def proofs(arm):
    """Q over the multiplier, and the rate, of each axis."""

    @cache
    def prove(name):
        found = run_certification(read_spec(f"{arm}#{name}")).certification
        assert found.verdict == "proved"
        named = [state.partition(" [")[0] for state in found.system.states]
        assert named == ["omega", "e before", "delta"]
        shown = found.evidence
        (multiplier,) = (m for m in shown.multipliers if m.fact.startswith("coupling"))
        assert multiplier.fact == "coupling 1"
        return np.array(shown.nodes[0].form, float) / multiplier.value, float(shown.rate)

    return {name: prove(name) for name in AXES}


def turned(rng, n):
    """Return a symmetric matrix with eigenvalues in the range, the ends preferred."""
    U = np.linalg.qr(rng.normal(size=(n, n)))[0]
    values = np.where(rng.random(n) < 0.7, rng.choice([LOW, HIGH], n), rng.uniform(LOW, HIGH, n))
    return U @ np.diag(values) @ U.T


def moved(rng, omega, delta, u, J, B, ks, pieces=4):
    """Move all axes over a period in which the arm and what is touched change a few times."""
    n, root = len(J), np.sqrt(J)
    state, alone = (np.concatenate([omega, delta, u, [0.0]])[: 3 * n] for _ in range(2))
    s = float(Mobility(Fraction(str(LOW)), Fraction(str(HIGH)), "").middle)
    for share in rng.dirichlet(np.ones(pieces)):
        k = np.array([rng.choice(ends) for ends in ks])
        for S, which in ((turned(rng, n), 0), (s * np.eye(n), 1)):
            W = np.diag(1 / root) @ S @ np.diag(1 / root)
            A = np.zeros((3 * n, 3 * n))
            A[:n] = np.hstack([-W @ np.diag(B), -W @ np.diag(k), W])
            A[n : 2 * n, :n] = np.eye(n)
            step = expm(A * T * share)
            if which:
                alone = step @ alone
            else:
                state = step @ state
    return state[:n], state[n : 2 * n], alone[:n], alone[n : 2 * n]


@pytest.mark.parametrize(("ranged", "near"), [(False, 0.6), (True, 0.25)])
def test_no_period_goes_beyond_its_bound(ranged, near):
    """For every axis its own bound; what is summed over the axes is within what is summed."""
    rng = np.random.default_rng(2)
    mobility = Mobility(Fraction(str(LOW)), Fraction(str(HIGH)), "")
    s = float(mobility.middle)
    J, B = (np.array([row[i] for row in AXES.values()]) for i in range(2))
    ks = [(low, high if ranged else low) for _, _, (low, high), _ in AXES.values()]
    pushes = []
    for (inertia, friction, *_), (low, high) in zip(AXES.values(), ks, strict=True):
        drive = torque_drive(*(Interval.point(Fraction(str(v))) for v in (inertia, friction)))
        stiffness = Interval(Fraction(low), Fraction(low), Fraction(high))
        tissue = Environment("tissue", Elastic, (stiffness,))
        pushes.append(push_of(mobility, drive, (tissue,), Fraction("0.001")))
    closest = 0.0
    for _ in range(1000):
        omega, delta = rng.normal(size=3) / np.sqrt(J), rng.normal(size=3) * rng.choice([0, 0.03])
        u = rng.normal(size=3) * np.sqrt(J) * rng.choice([0, 3, 100])
        # The mean of the stiffness over the period is not told; any value of the range will do.
        k = np.array([rng.uniform(*ends) for ends in ks])
        speed, way, own_speed, own_way = moved(rng, omega, delta, u, J, B, ks)
        pushed, seen = 0.0, 0.0
        for i, push in enumerate(pushes):
            a = s * (u[i] - B[i] * omega[i] - k[i] * delta[i]) / J[i]
            pushed += J[i] * ((speed[i] - own_speed[i]) / float(push.on_speed)) ** 2
            pushed += J[i] * ((way[i] - own_way[i]) / float(push.on_way)) ** 2
            seen += J[i] * (float(push.acceleration) * a) ** 2
            seen += J[i] * (float(push.speed) * omega[i]) ** 2
            seen += J[i] * (float(push.deflection) * delta[i]) ** 2
        assert pushed <= seen
        closest = max(closest, pushed / seen)
    # The bound is not far from what a motion does.
    assert closest > near


@pytest.mark.slow
def test_axes_that_are_not_alike_decrease_together(arm, proofs):
    """The sum of J V/tau falls by the worst rate in every step, whatever arm and tissue do."""
    rng = np.random.default_rng(5)
    J, B = (np.array([row[i] for row in AXES.values()]) for i in range(2))
    ks = [row[2] for row in AXES.values()]
    laws = [row[3] for row in AXES.values()]
    rate = max(rho for _, rho in proofs.values())
    forms = [J[i] * Q for i, (Q, _) in enumerate(proofs.values())]
    for _ in range(40):
        x = rng.normal(size=(3, 3)) * np.array([1, 0.05, 0.05]) / np.sqrt(J)[:, None]
        for _ in range(100):
            V = sum(row @ Q @ row for row, Q in zip(x, forms, strict=True))
            e = -x[:, 2]
            K, D = np.array([law[rng.integers(2)] for law in laws]).T
            u = K * e + D / T * (e - x[:, 1])
            speed, way, *_ = moved(rng, x[:, 0], x[:, 2], u, J, B, ks)
            x = np.column_stack([speed, e, way])
            assert sum(row @ Q @ row for row, Q in zip(x, forms, strict=True)) <= rate**2 * V


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("mobility: [0.8, 1.25]", "mobility: [1.25, 0.8]", "ends at '0.8', below its start"),
        ("mobility: [0.8, 1.25]", "mobility: [0, 1.25]", "positive"),
        ("mobility: [0.8, 1.25]", "mobility: [0.8, 1.25], axes: 3", "axes is for axes with a"),
        ("contact: kept", "contact: losable", "contact"),
        ("delay: 0}", "delay: 0, latency: 0.3 ms}", "take effect at their sample"),
        ("friction: 0.5 N*m*s/rad", "friction: {nominal: 0.5 N*m*s/rad, range: [0.4 N*m*s/rad, "
         "0.6 N*m*s/rad], varies: false}", "may change at every sample"),
        ("inertia: 0.2 kg*m^2", "inertia: {nominal: 0.2 kg*m^2, range: [0.1 kg*m^2, 0.3 kg*m^2]}",
         "said twice: by its range, and by the mobility"),
    ],
)  # fmt: skip
def test_what_is_refused(arm, tmp_path, old, new, said):
    text = arm.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "arm.nrs.yaml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(SpecError, match=said):
        read_spec(f"{path}#turn")


def test_a_range_that_is_stretched_stays_positive():
    mobility = Mobility(Fraction("0.5"), Fraction("1.5"), "")
    assert mobility.scaled(Fraction(1)) == mobility
    with pytest.raises(AssemblyError, match="does not stay positive"):
        mobility.scaled(Fraction(2))

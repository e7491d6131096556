"""Constants of drives and times: sets of corners, and the proof at values that lie between."""

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.errors import SpecError
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.runs import run_certification, run_design
from nrs_design.spec import parse_spec, read_spec
from tests.support import spec_in, words_of
from tests.tables import spec_text

TORQUES, LATE = spec_text("constant-inertia"), spec_text("constant-latency")


def read(tmp_path, text):
    return read_spec(spec_in(tmp_path, text, "one"))


def test_constants_of_two_contacts_of_one_drive_are_refused(tmp_path):
    """Within a period it may go from one to the other: what is called one end would be both."""
    text = TORQUES.replace(
        "45 N*m/rad]}}",
        "45 N*m/rad], varies: false}}\n  firm: {model: elastic, stiffness: 9 N*m/rad}",
    ).replace("    type:", "    contacts: [tissue, firm]\n    type:")
    with pytest.raises(SpecError, match="the load may go from one to another"):
        read(tmp_path, text)


def test_an_inertia_that_stays_is_proved(tmp_path):
    """At every inertia and stiffness between, the true map decreases the function of that value."""
    result = run_certification(read(tmp_path, TORQUES))
    found = result.certification
    assert found.verdict == "proved"
    (evidence,) = (s for s in found.statements if s.kind == "constants-quadratic")
    assert "For every constant value of torque_interface.inertia" in evidence.claim(found.system)
    low, high = (np.array(P, float) / 2.0**evidence.denominator_log2 for P in evidence.functions)
    rho, T, B = float(evidence.rate), 0.001, 0.5
    rng = np.random.default_rng(4)
    assert found.system.states == ("omega [rad/s]", "e before [rad]", "delta [rad]")
    for J, k in zip(rng.uniform(0.05, 0.6, 60), rng.uniform(17, 45, 60), strict=True):
        share = (1 / J - 1 / 0.05) / (1 / 0.6 - 1 / 0.05)
        P = (1 - share) * low + share * high
        E = expm(np.array([[-B / J, -k / J, 1 / J], [1, 0, 0], [0, 0, 0]]) * T)
        for K, D in ((30, 3), (60, 5)):
            law = np.array([0.0, -D / T, -K - D / T])
            A = np.array([[E[0, 0], 0, E[0, 1]], [0, 0, -1.0], [E[1, 0], 0, E[1, 1]]])
            A += np.outer([E[0, 2], 0, E[1, 2]], law)
            gap = rho**2 * P - A.T @ P @ A
            assert np.linalg.eigvalsh(gap).min() > -1e-9 * np.abs(P).max()


def test_an_inertia_that_jumps_is_refuted(tmp_path):
    """Light for 29 steps and heavy for 117, the firm controller makes the joint grow by 1.0043."""
    jumping = TORQUES.replace(", varies: false", "")
    weak = jumping.replace("damping: 3 N", "damping: 1 N").replace("damping: 5 N", "damping: 1.5 N")
    assert run_certification(read(tmp_path, weak)).certification.verdict == "refuted"


def test_values_of_a_drive_are_enclosed_and_refute_nothing(tmp_path):
    loaded = read(tmp_path, TORQUES)
    system = assemble_spec(loaded, run_design(loaded))
    (said,) = system.switching.fixed_parameters
    assert (said.name, said.unit, said.inverse) == ("torque_interface.inertia", "kg*m^2", True)
    assert said.enclosed
    for low, high in system.switching.fixed_ends:
        assert low.replace("J-min", "J-max") == high


def test_a_constant_latency_is_what_is_left_of_the_period(tmp_path):
    """All that a known motor does follows from it: its corners are the points of the curve."""
    loaded = read(tmp_path, LATE)
    system = assemble_spec(loaded, run_design(loaded))
    (said,) = system.switching.fixed_parameters
    assert (said.name, float(said.low), float(said.high)) == ("sampling.latency", 0.0024, 0.0036)
    assert said.enclosed
    (points,) = system.switching.fixed_ends
    assert points == tuple(f"only/soft/flow-{k}" for k in range(4))
    varying = read(
        tmp_path, LATE.replace("{range: [2.4 ms, 3.6 ms], varies: false}", "[2.4 ms, 3.6 ms]")
    )
    other = assemble_spec(varying, run_design(varying))
    assert other.modes == system.modes
    assert not other.switching.fixed_ends
    texts = " ".join(words_of(system))
    assert "by a time that is unknown from 0.0024 s to 0.0036 s, but always the same" in texts


def test_a_range_that_varies_may_say_so():
    both = (
        LATE.replace("{range: [2.4 ms, 3.6 ms], varies: false}", new)
        for new in ("[2.4 ms, 3.6 ms]", "{range: [2.4 ms, 3.6 ms]}")
    )
    one, other = map(parse_spec, both)
    assert one.sampling.latency == other.sampling.latency

"""Parts and modes for python-control, beside the exact matrices and the formulas of the thesis."""

from dataclasses import replace
from fractions import Fraction

import control
import numpy as np
import pytest

import nrs_design as nrs
from nrs_design.errors import DesignError
from nrs_design.exporters.state_space import design_state_spaces, mode_state_spaces
from nrs_design.loop.assemble import assemble
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import parse_spec
from tests.exporters.conftest import CONTINUOUS
from tests.support import ROOT

S = 1j * np.logspace(-1, 3, 9)


@pytest.fixture(scope="module")
def parts():
    return nrs.load(CONTINUOUS).state_spaces()


def test_actuator_and_motion_loop(parts):
    """Thesis 4.1 and 4.28 with the published numbers; Kp = Kd z."""
    Km, tau, Kd, z = 4.8417e-4, 0.0351, 2060.0, 56.9706
    assert parts.actuator(S) == pytest.approx(Km / (S * (tau * S + 1)), rel=1e-9)
    PD = Kd * Km * (S + z)
    assert parts.motion_loop(S) == pytest.approx(PD / (tau * S**2 + S + PD), rel=1e-6)


def test_admittances(parts):
    """Thesis 6.8, subtracted from the command: Mt = 0.01, Bt = 2.15 and 1.04."""
    for name, Bt in (("insertion", 2.15), ("withdrawal", 1.04)):
        law = parts.controllers[name]
        assert law(S) == pytest.approx(-1 / (0.01 * S + Bt), rel=1e-6)
        assert (law.name, law.input_labels, law.output_labels) == (name, ["force"], ["velocity"])


def test_a_spring_and_a_law_without_inertia(continuous):
    """Thesis 2.2.6.2: 1/(Mt s + Bt + Kt/s), and 1/Bt with Mt = 0."""
    designed = run_design(continuous)
    insertion, withdrawal = designed.design.controllers
    sprung = replace(insertion, law=replace(insertion.law, Kt=Fraction(3)))
    static = replace(withdrawal, law=replace(withdrawal.law, Mt=Fraction(0)))
    design = replace(designed.design, controllers=(sprung, static))
    found = design_state_spaces(replace(designed, design=design)).controllers
    Mt, Bt = float(insertion.law.Mt), float(insertion.law.Bt)
    assert found["insertion"](S) == pytest.approx(-1 / (Mt * S + Bt + 3 / S), rel=1e-9)
    assert found["insertion"].nstates == 2
    assert found["withdrawal"](S) == pytest.approx(np.full(9, -1 / float(withdrawal.law.Bt)))
    assert found["withdrawal"].nstates == 0


def test_force_and_position_controllers():
    study = nrs.load(ROOT / "specs/neuroboscope/force-limit.nrs.yaml")
    position, force = study.state_spaces().controllers.values()
    _, law = (controller.law for controller in study.design().controllers)
    assert position.D == [[0.0]]
    assert [[-float(law.Kp)]] == force.D
    assert force.output_labels == ["position"]


def test_modes_are_those_of_the_proof(continuous_export, sampled_export):
    for export in (continuous_export, sampled_export):
        system = export.certificate.system
        spaces = mode_state_spaces(system)
        assert list(spaces) == [mode.name for mode in system.modes]
        for mode in system.modes:
            rows = [[float(entry) for entry in row] for row in mode.A.fractions()]
            assert np.array_equal(spaces[mode.name].A, rows)
            assert spaces[mode.name].dt == float(system.sample_time or 0)


def test_disturbances_are_inputs(sampled):
    text = f"{sampled.text}disturbances: {{command: 8 deg/s, force_step: 0.01 N*m}}\n"
    designed = run_design(replace(sampled, spec=parse_spec(text)))
    system = assemble(designed.spec, designed.plant, designed.design)
    assert len(system.channels) == 2
    for index, space in enumerate(mode_state_spaces(system).values()):
        for column, channel in enumerate(system.channels):
            exact = [float(row[0]) for row in channel.columns[index].fractions()]
            assert list(space.B[:, column]) == exact


def test_the_loop_closes_to_the_mode(parts, continuous_export):
    """Command through the motion loop, its integral on the spring, and back through the law."""
    system = continuous_export.certificate.system
    poles = np.linalg.eigvals(mode_state_spaces(system)["insertion/soft/k-min"].A)
    stiffness = 720.56 * 0.24**2
    loop = control.ss(control.tf([stiffness], [1, 0])) * parts.motion_loop
    closed = control.feedback(loop, parts.controllers["insertion"], sign=1)
    assert np.sort_complex(closed.poles()) == pytest.approx(np.sort_complex(poles), rel=1e-6)


def test_matrices_have_no_parts():
    study = nrs.load(ROOT / "specs/examples/ando-shih.nrs.yaml")
    with pytest.raises(DesignError, match="no actuator"):
        study.state_spaces()
    spaces = study.certify().state_spaces()
    assert {space.dt for space in spaces.values()} == {True}
    assert nrs.certify(spaces).verdict == "proved"

"""One law, one record: the thesis's parameters come back."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.tissue import output_error
from nrs_design.identification.tissue.output_error import fit_record
from nrs_design.identification.tissue.problem import LeastSquaresProblem, Point
from nrs_design.identification.tissue.trial import prepare
from nrs_design.models.contact import (
    AbstractLinearLaw,
    Elastic,
    HuntCrossley,
    KelvinBoltzmann,
    KelvinVoigt,
    Maxwell,
)
from nrs_design.models.contact.motion import Motion
from tests.identification import synthetic
from tests.identification.support import holds, quick, record, slow, source
from tests.identification.unilateral import robot_record

# Thesis 6.1, and tables 2.4 and 2.5 (a Maxwell law that relaxes within the record).
KNOWN = [
    (Elastic(768.17), quick(1), 0.0969, synthetic.COUNT),
    (Elastic(1079.6), quick(2), 0.1519, synthetic.COUNT),
    (KelvinVoigt(0.574, 0.957), slow(3), 0.0114, 0.0),
    (Maxwell(1.129, 20.0), slow(4), 0.0135, 0.0),
    (synthetic.NOSE, slow(5), 0.0062, 1e-4),
    (synthetic.CONCHA, slow(6), 0.0055, 1e-4),
    (HuntCrossley(0.28, 15.328, 1.2), slow(7), 0.0096, 0.0),
]


@pytest.mark.parametrize(("law", "motion", "noise", "resolution"), KNOWN)
def test_parameters_of_the_thesis_are_in_their_intervals(law, motion, noise, resolution):
    fit = fit_record(type(law), record(law, motion, noise, 11, resolution))
    assert all(holds(fit.estimates, law.values))
    assert fit.law.values == pytest.approx(law.values, rel=0.12)
    # Rounding of the deflection adds to the noise: at most k q / sqrt(12).
    assert noise * 0.9 < fit.rmse < 1.15 * noise + resolution * law.values[0] / 3
    assert fit.doubts == ()


# Without air, the zero of a power law is all but undetermined beside its exponent.
@pytest.mark.parametrize(
    "law", [law for law, *_ in KNOWN[1:] if isinstance(law, AbstractLinearLaw)]
)
def test_exact_without_noise(law):
    motion = slow(1) if law.values[0] < 100 else quick(1)
    fit = fit_record(type(law), record(law, motion))
    assert fit.law.values == pytest.approx(law.values, rel=1e-5)


def test_long_records_are_searched_thinned_and_fitted_whole(monkeypatch):
    data = record(synthetic.NOSE, slow(3), 0.01, 3)
    whole = fit_record(type(synthetic.NOSE), data)
    monkeypatch.setattr(output_error, "COARSE", 300)
    thin = fit_record(type(synthetic.NOSE), data)
    assert thin.law.values == pytest.approx(whole.law.values, rel=1e-6)


@pytest.mark.slow
def test_a_touch_that_only_grazes_the_tissue():
    # All its samples are at the edge of contact, so that none of them is used.
    time = np.arange(0, 16, 0.01)
    depth = np.choose((time // 4).astype(int), [1.0, 0.8, 0.296, 0.9])
    motion = Motion(time, 0.01 * depth * np.sin(np.pi * time / 4) ** 2)
    trial = prepare(robot_record(KelvinVoigt(300.0, 3.0), motion, 0.002, 1))
    assert len(trial.unrested) < len(replace(trial, fit_mask=np.ones_like(trial.fit_mask)).unrested)
    fit = fit_record(KelvinBoltzmann, trial)
    assert fit.fitted.shape == trial.force.shape
    error = (trial.force - fit.fitted)[trial.fit_mask]
    assert float(np.sqrt(np.mean(error**2))) == pytest.approx(fit.rmse)


@pytest.mark.parametrize("law", [Maxwell(1.129, 20.0), synthetic.CONCHA])
def test_derivatives_of_stretches_that_do_not_begin_at_rest(law):
    """Of the law and of what fades from the beginning of each touch, at constants that stay."""
    problem = LeastSquaresProblem(type(law), prepare(robot_record(law, slow(1), 0.005, 1)))
    point = Point(problem, np.log(law.values) + 0.1)
    values = point.best[problem.offsets.shape[1] :]
    assert len(values) > 1

    def force(x):
        return Point(problem, x).force + Point(problem, x).states @ values

    steps = 1e-5 * np.eye(len(point.values))
    slopes = [(force(point.values + h) - force(point.values - h)) / 2e-5 for h in steps]
    assert point.sensitivities == pytest.approx(np.column_stack(slopes), abs=1e-8)


LAW = KelvinBoltzmann(400.0, 900.0, 2000.0)
TIME = np.arange(2000) / 20


def measured(motion, force, noise, seed):
    error = noise * np.random.default_rng(seed).standard_normal(len(force))
    return TissueRecord(source(f"{seed}"), motion, force + error, False)


def test_stress_relaxation():
    motion = Motion(TIME, 0.005 * np.clip((TIME - 2) / 0.5, 0, 1))
    fit = fit_record(KelvinBoltzmann, measured(motion, LAW.simulate(motion), 0.01, 1))
    assert all(holds(fit.estimates, LAW.values))
    assert fit.doubts == ()

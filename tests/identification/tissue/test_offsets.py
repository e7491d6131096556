"""Position of contact and tare: the true stiffness comes back whatever they are."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.tissue.identify import identify_tissue
from nrs_design.identification.tissue.output_error import fit_record
from nrs_design.identification.tissue.settings import Preparation
from nrs_design.identification.tissue.trial import prepare
from nrs_design.models.contact import Elastic, HuntCrossley, KelvinBoltzmann, KelvinVoigt
from nrs_design.models.contact.motion import Motion
from tests.identification import synthetic
from tests.identification.support import holds, quick, record, slow, source
from tests.identification.unilateral import robot_record

# As a robot records: 400 N/m and 3 N s/m behind 0.1 m.
VOIGT = KelvinVoigt(400.0, 3.0)


def shifted(zero=0.0, tare=0.0, sign=1):
    data = record(VOIGT, quick(1), 0.05, 1)
    motion = Motion(data.motion.time, data.motion.deflection + zero)
    return TissueRecord(source("shifted"), motion, sign * (data.force + tare), False)


def chosen(data, **options):
    found = identify_tissue([data], preparation=Preparation(**options))
    (fit,) = found.model.fits
    return found, fit, fit.offsets


@pytest.mark.parametrize(("zero", "tare"), [(0.0, 0.0), (0.1, 0.0), (0.0, -1.3), (-2.0, 4.0)])
def test_offsets_do_not_touch_the_stiffness(zero, tare):
    found, fit, offsets = chosen(shifted(zero, tare))
    assert found.model.law.name == "kelvin-voigt"
    assert holds(fit.estimates, VOIGT.values) == [True, True]
    assert found.caveats == ()
    # Without air, the record tells the position of contact only if the tare is known.
    assert offsets == {"zero": pytest.approx(zero - tare / 400, abs=1e-4)}


@pytest.mark.parametrize("side", [1, -1])
def test_air_before_contact_tells_both(side):
    data = robot_record(VOIGT, quick(2), 0.05, 2, air=0.57, zero=0.1, tare=-1.3, side=side)
    found, fit, offsets = chosen(data)
    assert holds(fit.estimates, VOIGT.values) == [True, True]
    assert found.caveats == ()
    assert offsets["zero"] == pytest.approx(0.1, abs=1e-4)
    assert offsets["tare"] == pytest.approx(-1.3, abs=0.02)
    assert "3 touches" in fit.trial.remarks[0]
    assert any("at the edge of contact" in cut for cut in fit.trial.cuts)


def test_the_power_law_finds_its_zero():
    law = HuntCrossley(1500.0, 3000.0, 1.2)
    fit = fit_record(HuntCrossley, robot_record(law, quick(3), 0.01, 3, zero=0.2))
    assert fit.offsets["zero"] == pytest.approx(0.2, abs=1e-4)
    assert all(holds(fit.estimates, law.values))


def test_opposite_signs_are_named():
    found, _, _ = chosen(shifted(sign=-1))
    assert any("force and deflection have opposite signs" in doubt for doubt in found.caveats)
    found, fit, _ = chosen(shifted(sign=-1), negate=True)
    assert found.caveats == ()
    assert fit.estimates[0].covers(400.0)


def test_elastic_tissue_in_air_has_no_memory():
    fit = fit_record(Elastic, robot_record(Elastic(750.0), quick(5), 0.05, 5))
    assert fit.estimates[0].covers(750.0)
    assert not any("has not come back" in cut for cut in fit.trial.cuts)


def data(drift, seed=1):
    return robot_record(Elastic(400.0), quick(seed), 0.03, seed, tare=-1.3, drift=drift)


@pytest.mark.parametrize("drift", [0.02, 0.0])
def test_a_drift_is_fitted_where_air_shows_it(drift):
    """One too small to be seen, too: left out, it would move the tare at the start."""
    fit = fit_record(Elastic, data(drift, 2))
    assert fit.offsets["drift"] == pytest.approx(drift, abs=1e-3)
    assert fit.offsets["tare"] == pytest.approx(-1.3, abs=0.01)
    assert fit.estimates[0].covers(400.0)
    assert "moving in proportion to time" in "; ".join(fit.trial.remarks)


def test_a_soft_start_of_one_touch_is_none():
    """Seen in texture analysis of meat: the force creeps up before the tissue resists."""
    time = np.arange(300) / 10
    x = 0.0005 * time
    force = 0.02 * time + 4000 * np.maximum(x - 0.008, 0.0)
    force += 0.02 * np.random.default_rng(1).standard_normal(300)
    assert not prepare(TissueRecord(source("soft"), Motion(time, x), force, False)).drift


def creeping(bend, seed=1):
    """A relaxing tissue without air, and a tare that moves by a tenth of the range of the force."""
    still = record(synthetic.NOSE, slow(seed), 0.0165, seed)
    time = still.motion.time
    part = (time - time[0]) / (time[-1] - time[0])
    return replace(still, force=still.force + 0.1 * np.ptp(still.force) * bend(part))


@pytest.mark.parametrize("bend", [np.sqrt, np.square, np.positive])
def test_without_air_a_drift_that_fits_better_is_a_doubt(bend):
    fit = fit_record(KelvinBoltzmann, creeping(bend))
    assert fit.law.k1 > 2 * synthetic.NOSE.k1
    assert any("a tare that moves with time fits better" in doubt for doubt in fit.doubts)


def test_without_drift_there_is_no_doubt():
    for seed in range(1, 6):
        assert fit_record(KelvinBoltzmann, creeping(np.zeros_like, seed)).doubts == ()


def test_a_drift_that_fades_as_the_tissue_does_passes_for_relaxation_and_that_is_said():
    """A known limit, told in the docs: the stiffness at rest comes out three times as large."""
    fit = fit_record(KelvinBoltzmann, creeping(lambda part: 1 - np.exp(-3 * part)))
    assert fit.law.k1 > 2.5 * synthetic.NOSE.k1
    assert fit.doubts == ()
    assert any("would pass for relaxation" in remark for remark in fit.trial.remarks)

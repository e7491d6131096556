"""Position of contact and tare: the true stiffness comes back whatever they are."""

import pytest

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.tissue.identify import identify_tissue
from nrs_design.identification.tissue.output_error import fit_record
from nrs_design.identification.tissue.trial import Preparation
from nrs_design.models.contact import Elastic, HuntCrossley, KelvinVoigt, Motion
from tests.identification.support import holds, quick, record, source
from tests.identification.unilateral import robot_record

# As a robot records: 400 N/m and 3 N s/m behind 0.1 m.
VOIGT = KelvinVoigt(400.0, 3.0)


def shifted(zero=0.0, tare=0.0, sign=1):
    data = record(VOIGT, quick(1), 0.05, 1)
    motion = Motion(data.motion.time, data.motion.deflection + zero)
    return TissueRecord(source("shifted"), motion, sign * (data.force + tare), False)


def chosen(data, **options):
    found = identify_tissue([data], preparation=Preparation(**options))
    (fit,) = found.chosen.fits
    return found, fit, {offset.name: offset for offset in fit.offsets}


@pytest.mark.parametrize(("zero", "tare"), [(0.0, 0.0), (0.1, 0.0), (0.0, -1.3), (-2.0, 4.0)])
def test_offsets_do_not_touch_the_stiffness(zero, tare):
    found, fit, offsets = chosen(shifted(zero, tare))
    assert found.chosen.law.name == "kelvin-voigt"
    assert holds(fit.estimates, VOIGT.values) == [True, True]
    assert found.caveats == ()
    # Without air, the record tells the position of contact only if the tare is known.
    assert offsets["zero"].provided == "if the tare is 0"
    assert offsets["zero"].estimate.covers(zero - tare / 400)


@pytest.mark.parametrize("side", [1, -1])
def test_air_before_contact_tells_both(side):
    data = robot_record(VOIGT, quick(2), 0.05, 2, air=0.57, zero=0.1, tare=-1.3, side=side)
    found, fit, offsets = chosen(data)
    assert holds(fit.estimates, VOIGT.values) == [True, True]
    assert found.caveats == ()
    assert offsets["zero"].estimate.value == pytest.approx(0.1, abs=1e-4)
    assert offsets["tare"].estimate.value == pytest.approx(-1.3, abs=0.02)
    assert offsets["zero"].provided == ""
    assert "3 touches" in fit.trial.remarks[0]
    assert any("at the edge of contact" in cut for cut in fit.trial.cuts)


def test_the_power_law_finds_its_zero():
    law = HuntCrossley(1500.0, 3000.0, 1.2)
    fit = fit_record(HuntCrossley, robot_record(law, quick(3), 0.01, 3, zero=0.2))
    offsets = {offset.name: offset.estimate for offset in fit.offsets}
    assert offsets["zero"].covers(0.2)
    assert all(holds(fit.estimates, law.values))


def test_a_wrong_offset_is_doubted():
    found, _, _ = chosen(shifted(0.1, -1.3), zero=0.1, tare=0.0)
    assert found.caveats
    (voigt,) = (model for model in found.models if model.law.name == "kelvin-voigt")
    assert any("a fit with a free offset is better" in doubt for doubt in voigt.doubts)


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

"""What of a record is used."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.identification.tissue.identify import identify_tissue
from nrs_design.identification.tissue.output_error import fit_record
from nrs_design.identification.tissue.settings import Preparation
from nrs_design.identification.tissue.trial import prepare
from nrs_design.models.contact import Elastic, KelvinVoigt, Maxwell
from nrs_design.models.contact.motion import Motion
from tests.identification import synthetic
from tests.identification.support import holds, quick, record, slow

DATA = record(Elastic(750.0), quick(1), 0.1, 1)


def test_a_part_of_the_record():
    trial = prepare(DATA, Preparation(start=5.0, end=10.0))
    assert (trial.motion.time[0], trial.motion.time[-1]) == pytest.approx((5.0, 10.0))
    assert trial.record is DATA
    assert "outside start and end" in trial.cuts[0]
    assert trial.cuts[0].startswith(f"{len(DATA.force) - len(trial.force)} samples")
    assert fit_record(Elastic, trial).estimates[0].covers(750.0)


@pytest.mark.parametrize("law", [Maxwell(1.129, 20.0), synthetic.CONCHA], ids=lambda x: x.name)
def test_a_record_cut_while_the_tissue_relaxes(law):
    """What it holds of the motion before the cut is fitted, too."""
    trial = prepare(record(law, slow(2), 0.01, 2), Preparation(start=3.0))
    fit = fit_record(type(law), trial)
    assert all(holds(fit.estimates, law.values))
    assert fit.uncertainty.whiteness > 0.01
    assert trial.unrested
    assert not prepare(trial.record, Preparation(start=0.0)).unrested


def test_a_short_contact_in_a_long_record_is_left_when_it_is_thinned():
    """Of a million rows one in 500 was kept, and none of a contact of 300."""
    trial = prepare(DATA)
    rows = np.arange(len(trial.force))
    short = replace(trial, fit_mask=(rows > 100) & (rows < 400))
    assert sum(short.thinned(2).fit_mask) >= 200
    assert len(trial.thinned(1000).force) <= 1000 < len(trial.force)


def conditioned():
    """The first of three cycles is 30 % stiffer, as a tissue that is loaded the first time."""
    motion = quick(2)
    first = motion.time < 5.0
    force = np.where(first, 1.3, 1.0) * KelvinVoigt(750.0, 3.0).simulate(motion)
    force += 0.05 * np.random.default_rng(2).standard_normal(len(force))
    return type(DATA)(DATA.source, motion, force, False)


def test_the_first_cycle_is_doubted_and_set_apart():
    found = identify_tissue([conditioned()], "kelvin-voigt")
    (said,) = (doubt for doubt in found.caveats if "first loading cycle is" in doubt)
    assert "--set start=5.39 sets it apart" in said
    preparation = Preparation(start=5.0)
    found = identify_tissue([conditioned()], "kelvin-voigt", preparation)
    (fit,) = found.model.fits
    assert fit.estimates[0].covers(750.0)
    assert found.caveats == ()
    assert "outside start and end" in "; ".join(fit.trial.remarks)


def test_a_record_whose_begin_a_pause_cut_off_need_not_begin_at_rest():
    """What happens in a pause is not recorded: the tissue relaxes on, and the probe moves."""
    law, motion = KelvinVoigt(0.574, 0.957), slow(3)
    whole = record(law, motion, 0.01, 3)
    rest = replace(
        whole,
        motion=Motion(motion.time[700:], motion.deflection[700:]),
        force=whole.force[700:],
        pauses="1 pause in the record: its longest stretch is used",
    )
    found = identify_tissue([rest])
    assert found.model.law.name == law.name
    assert found.caveats == ()
    assert all(holds(found.model.ranges, law.values))
    assert found.remarks == ("record-3: 1 pause in the record: its longest stretch is used",)
    assert found.model.fits[0].trial.unrested

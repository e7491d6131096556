import pytest
from matplotlib.figure import Figure

from nrs_design.thesis.gallery import agility, force_limit, hands, impedance, two_contacts
from nrs_design.thesis.gallery.figures import draw_counterparts


@pytest.fixture(scope="session")
def counterparts():
    """All runs and statements, with empty figures: drawing takes longer than all the rest."""
    with pytest.MonkeyPatch.context() as patch:
        for topic in (agility, force_limit, hands, impedance, two_contacts):
            patch.setattr(topic, "draw_panels", lambda columns: Figure())
        patch.setattr(force_limit, "draw_root_locus", lambda *arguments: Figure())
        return draw_counterparts()


@pytest.fixture(scope="session")
def by_figure(counterparts):
    return {figure: one for one in counterparts for figure in one.shows}

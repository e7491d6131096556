"""What is kept claims nothing that nothing shows."""

import pytest

from nrs_design.sweeps.claims import claims_in, is_shown
from tests.tables import rows


@pytest.mark.parametrize("document", rows(__file__, "test_claims"))
def test_claims(document):
    assert list(claims_in(document))
    assert not is_shown(document, {})
    assert is_shown(document, document)
    assert not is_shown(document, {"verdict": "inconclusive"})


@pytest.mark.parametrize(
    "document",
    [
        {"verdict": "inconclusive"},
        {"claim": None, "proved": False, "goals": [{"proved": False}]},
        {"Mt": 0.01, "text": "not proved"},
    ],
)
def test_no_claims(document):
    assert list(claims_in(document)) == []
    assert is_shown(document, {})


def test_beside_what_is_shown_nothing_more_may_be_claimed():
    assert is_shown({"verdict": "proved", "method": "lmi"}, {"verdict": "proved"})
    assert not is_shown({"verdict": "proved", "cost": 1.0}, {"verdict": "proved"})
    assert not is_shown({"verdict": "proved", "proved_scale": 1.0}, {"verdict": "proved"})
    assert not is_shown({"cost": 1.0}, {"verdict": "proved"})

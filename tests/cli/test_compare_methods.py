"""`nrs-design compare-methods`, as a user types it."""

from tests.support import COMMUTING, document_of


def test_json(tmp_path):
    lmi, *iterations = document_of("compare-methods", COMMUTING, cwd=tmp_path, code=0)["runs"]
    assert (lmi["method"], lmi["updates"], lmi["history"]) == ("lmi", None, [])
    assert len(iterations) == 6
    for found in iterations:
        assert found["verdict"] == "proved"
        assert found["history"][0][-1][0] == found["updates"]
        assert 0 < found["decay_rate"] <= found["decay_rate_limit"]
        assert found["condition"] >= 1

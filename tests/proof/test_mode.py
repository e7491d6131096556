from nrs_design.proof.mode import Time


def test_times_by_name():
    assert [str(time) for time in Time] == ["continuous", "discrete"]

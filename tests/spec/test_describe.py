from nrs_design.spec.describe import si_unit


def test_units_of_a_dimension() -> None:
    assert si_unit((0,) * 8) == "1"
    assert si_unit((0, 0, -1, 0, 0, 0, 0, 0)) == "1/s"
    assert si_unit((1, 2, -2, -1, 0, 0, 0, 0)) == "kg*m^2/s^2/rad"

"""The variables of a co-simulation model: each of the law, once, with its unit."""

import pytest

from nrs_design.exporters.fmu_variables import Variables
from tests.exporters.programs import LAWS


@pytest.mark.parametrize("shape", LAWS)
def test_every_value_of_the_law_is_a_variable(shape):
    law, reals = LAWS[shape], Variables.of(LAWS[shape]).reals
    assert [v.reference for v in reals] == list(range(len(reals)))
    assert len({v.name for v in reals}) == len(reals) == len(law.values) + len(law.outputs)
    units = {v.name: (v.causality, v.unit, v.place) for v in reals}
    for value in law.inputs:
        assert units[value.name] == ("input", value.unit, f"in.{value.name}")
    for value in law.states:
        place = f"state.{value.name}"
        assert units[place] == ("local", value.unit, place)
    for name, unit in law.units.items():
        assert units[name] == ("output", unit, f"out.{name}")
    assert all(v.meaning for v in reals)


def test_inputs_come_first():
    """The program tells by the number what may be set."""
    reals = Variables.of(LAWS["mixed"]).reals
    causes = [v.causality for v in reals]
    assert causes == sorted(causes, key=["input", "output", "local"].index)

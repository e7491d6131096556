"""A law sample by sample is bit for bit the replica, and so the exported C."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.replica import step
from nrs_design.controllers.shipped import shipped_law
from nrs_design.design.design import design_controllers
from nrs_design.simulation.step_program import StepProgram
from nrs_design.spec import parse_spec
from nrs_design.spec.build_plant import build_plant
from tests.simulation.interactions import FORCE, IMPEDANCE, PLACED, text_of

MIXED = IMPEDANCE | {"force": FORCE}
LIMITED = ("bandwidth: 2 Hz", "bandwidth: 2 Hz, command: 300 rpm")
FILTERED = "sensor: {filter: {order: 2, cutoff: 20 Hz}}\n"
IDLE = "idle_states: {decay: 20 1/s}\n"


@pytest.mark.parametrize(
    ("controllers", "more"), [(IMPEDANCE, ""), (IMPEDANCE, FILTERED), (PLACED, ""), (MIXED, IDLE)]
)
def test_every_bit_is_that_of_the_replica(controllers, more):
    spec = parse_spec(text_of(controllers, more=more).replace(*LIMITED))
    law = shipped_law(spec, design_controllers(spec, build_plant(spec)), Fraction(1, 500))
    program, rng = StepProgram(law), np.random.default_rng(0)
    count = 400
    sizes = 10.0 ** rng.uniform(-9, 7, (len(law.values), count)) * rng.choice([-1, 1], count)
    sizes[:, :5] = np.nan, np.inf, 0.0, -0.0, 1e-42
    given = {v.name: row.astype(np.float32) for v, row in zip(law.values, sizes, strict=True)}
    mode = rng.integers(0, len(law.modes), count).astype(np.uint32)
    wanted = step(law, mode, given)
    assert 0 < wanted.valid.sum() < count
    for i in range(count):
        outputs, states, valid = program.step(int(mode[i]), [given[v.name][i] for v in law.values])
        assert valid == wanted.valid[i]
        pairs = [*zip(outputs, law.outputs, strict=True)]
        bits = [np.float32(value).view(np.uint32) for value in [*outputs, *states]]
        both = [wanted.outputs[name][i] for _, name in pairs]
        both += [wanted.states[state.name][i] for state in law.states]
        assert bits == [value.view(np.uint32) for value in both]

"""A new law of contact is named by its spec alone, and keeps its own words."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from nrs_design.models.contact import HuntCrossley
from nrs_design.pipeline.runs import run_certification, run_design
from nrs_design.pipeline.scenarios import Runs, run_scenarios
from nrs_design.spec import read_spec
from nrs_design.spec.environment import HuntCrossleySpec
from tests.support import ROBOT


@dataclass(frozen=True)
class Stiffening(HuntCrossley):
    """Three times as stiff as what it is not."""

    name = "stiffening"

    def push(self, deflection, velocity):
        return 3 * super().push(deflection, velocity)


class StiffeningSpec(HuntCrossleySpec):
    """A law within a preload, as a spec writes it."""

    nonlinear = Stiffening
    model: Literal["stiffening"]


def written(file, model):
    """A spec of the repository whose only environment has another law, which a spec knows."""
    loaded = read_spec(file)
    ((name, environment),) = loaded.spec.environments.items()
    fields = {key: getattr(environment, key) for key in type(environment).model_fields}
    law = model.__pydantic_fields__["model"].annotation.__args__[0]
    environments = {name: model.model_construct(**fields | {"model": law})}
    return replace(loaded, spec=loaded.spec.model_copy(update={"environments": environments}))


CONCHA = ROBOT / "concha.nrs.yaml"


def test_a_law_keeps_its_words_from_spec_to_run():
    loaded = written(CONCHA, StiffeningSpec)
    result = run_certification(loaded)
    assert result.certification.verdict == "proved"
    said = {item.id for item in result.certification.system.assumptions}
    assert "preload.stiffening" in said
    assert "preload.hunt-crossley" not in said
    assert result.designed.plant.environment("concha").nonlinear is Stiffening
    wanted = Runs(engine="sampled")
    own, other = (
        next(run_scenarios(run_design(one), wanted)) for one in (loaded, read_spec(CONCHA))
    )
    (surface,) = own.scenario.surfaces
    assert type(surface.law) is Stiffening
    torque = [np.abs(one.run.response["torque"]).max() for one in (own, other)]
    assert torque[0] > 1.2 * torque[1] > 0

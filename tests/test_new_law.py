"""A law of contact that a table lacks is refused; one that all tables have keeps its own words."""

from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

import numpy as np
import pytest

from nrs_design.errors import InternalError
from nrs_design.models import contact
from nrs_design.models.contact import Elastic, HuntCrossley
from nrs_design.models.plant import build_plant
from nrs_design.pipeline import run_certification, run_design
from nrs_design.pipeline.scenarios import Runs, run_scenarios
from nrs_design.spec import read_spec
from nrs_design.spec.environment import ElasticSpec, HuntCrossleySpec
from nrs_design.switched.assumptions import preload_texts
from tests.support import ROBOT, SOFT_TISSUE


class StiffeningSpec(HuntCrossleySpec):
    """A law within a preload, as a spec writes it."""

    model: Literal["stiffening"]


class SpringySpec(ElasticSpec):
    """A linear law, as a spec writes it."""

    model: Literal["springy"]


class TakenForElasticSpec(SpringySpec):
    """One that says which linear law stands for it, although none is known of its own."""

    @property
    def linear_model(self):
        return "elastic"


class RememberingSpec(SpringySpec):
    remembers = True


@dataclass(frozen=True)
class Stiffening(HuntCrossley):
    """Three times as stiff as what it is not."""

    name = "stiffening"
    title = "a stiffening law"

    def push(self, deflection, velocity):
        return 3 * super().push(deflection, velocity)


@dataclass(frozen=True)
class Springy(Elastic):
    name = "springy"


def written(file, model):
    """A spec of the repository whose only environment has another law, which a spec knows."""
    loaded = read_spec(file)
    ((name, environment),) = loaded.spec.environments.items()
    fields = {key: getattr(environment, key) for key in type(environment).model_fields}
    law = model.__pydantic_fields__["model"].annotation.__args__[0]
    environments = {name: model.model_construct(**fields | {"model": law})}
    return replace(loaded, spec=loaded.spec.model_copy(update={"environments": environments}))


CONCHA = ROBOT / "concha.nrs.yaml"


@pytest.mark.parametrize(
    ("file", "model"),
    [(CONCHA, StiffeningSpec), (SOFT_TISSUE, SpringySpec), (SOFT_TISSUE, TakenForElasticSpec)],
)
def test_a_law_in_the_spec_alone_is_refused(file, model):
    """Neither proved nor simulated as another one, and not under its words."""
    loaded = written(file, model)
    for refused in (run_design, run_certification, lambda one: build_plant(one.spec)):
        with pytest.raises(
            InternalError, match=r"no law of contact '(stiffening|springy)'|no linear law 'springy'"
        ):
            refused(loaded)
    with pytest.raises(InternalError, match="no law of contact"):
        [*preload_texts(loaded.spec, 1)]


def known(monkeypatch, table, law):
    more = MappingProxyType({**getattr(contact, table), law.name: law})
    monkeypatch.setattr(contact, table, more)


def test_a_law_in_the_tables_keeps_its_words_from_spec_to_run(monkeypatch):
    known(monkeypatch, "LAWS", Stiffening)
    loaded = written(CONCHA, StiffeningSpec)
    result = run_certification(loaded)
    assert result.certification.verdict == "proved"
    said = " ".join(result.certification.system.assumptions)
    assert "concha is a stiffening law whose deflection stays between 0.1 rad and 0.3 rad" in said
    assert "Crossley" not in said
    assert result.designed.plant.environment("concha").nonlinear is Stiffening
    wanted = Runs(engine="sampled")
    own, other = (
        next(run_scenarios(run_design(one), wanted)) for one in (loaded, read_spec(CONCHA))
    )
    (surface,) = own.scenario.surfaces
    assert type(surface.law) is Stiffening
    torque = [np.abs(one.run.response["torque"]).max() for one in (own, other)]
    assert torque[0] > 1.2 * torque[1] > 0


def test_a_linear_law_in_the_tables_is_itself(monkeypatch):
    known(monkeypatch, "LINEAR_LAWS", Springy)
    (environment,) = build_plant(written(SOFT_TISSUE, SpringySpec).spec).environments
    assert (environment.law, environment.nonlinear) == (Springy, None)


@pytest.mark.parametrize(
    ("model", "fact"), [(RememberingSpec, "remembers"), (TakenForElasticSpec, "linear_model")]
)
def test_a_spec_that_says_other_facts_than_the_law_is_refused(monkeypatch, model, fact):
    known(monkeypatch, "LINEAR_LAWS", Springy)
    with pytest.raises(InternalError, match=f"'springy' differ in {fact}"):
        build_plant(written(SOFT_TISSUE, model).spec)


def test_a_law_that_is_not_linear_needs_a_preload(monkeypatch):
    """Its linear ranges hold there only."""
    known(monkeypatch, "LAWS", Stiffening)
    model = type("Unbounded", (StiffeningSpec,), {"preloaded": False})
    with pytest.raises(InternalError, match="'stiffening' differ in preloaded"):
        build_plant(written(CONCHA, model).spec)

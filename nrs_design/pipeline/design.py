"""Plant, gains and analysis of a spec, also for an older force."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import ceil
from typing import TYPE_CHECKING

from nrs_design.errors import DesignError, NrsDesignError
from nrs_design.models.axis import axis_context
from nrs_design.spec import LoadedSpec
from nrs_design.spec.sampling import LONGEST_DELAY

if TYPE_CHECKING:
    from nrs_design.controllers.controller_design import ControllerDesign
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.design.linear_parts import LinearParts, OpenLoop
    from nrs_design.models.plant import Plant
    from nrs_design.spec import InteractionDesignSpec


# Commands for other kinds of specs.
_FOR_KIND = {"robot": "`nrs-design robot`", "switched-system": "`nrs-design certify-switching`"}


@dataclass(frozen=True, slots=True)
class Designed:
    """An interaction design with all that follows from its spec alone."""

    loaded: LoadedSpec  # The spec and where it came from
    spec: InteractionDesignSpec  # Content of the spec
    plant: Plant  # Plant of the spec, for all later stages
    design: ControllerDesign  # The gains that ship


@contextmanager
def placed(loaded: LoadedSpec) -> Iterator[None]:
    """Add path, line and column to errors from stages that know the spec but not its file.

    Their words are about its axis.
    """
    try:
        with axis_context(getattr(loaded.spec, "axis", None)):
            yield
    except NrsDesignError as error:
        if error.path is None and error.at:
            place = loaded.place(*error.at)
            error.line, error.column = place.line, place.column
        error.path = error.path or loaded.path
        if isinstance(error, DesignError):
            _ask_first(error, loaded)
        raise


def _ask_first(error: DesignError, loaded: LoadedSpec) -> None:
    """Put doubts about sizes before advice on gains: a wrong unit is the likelier cause."""
    from nrs_design.spec.plausible import doubt_sizes

    for keys, text in doubt_sizes(loaded.spec):
        if text not in (error.remedy or ""):
            place = loaded.place(*keys)
            alternative = f" Otherwise, {error.remedy}" if error.remedy else ""
            error.remedy = f"first, line {place.line}: {text}{alternative}"


def wrong_kind(loaded: LoadedSpec, message: str, remedy: str) -> DesignError:
    """Return the error for a spec of a kind that a command does not take."""
    place = loaded.place("kind")
    return DesignError(
        message, path=loaded.path, line=place.line, column=place.column, remedy=remedy
    )


def interaction_of(loaded: LoadedSpec, lacks: str) -> InteractionDesignSpec:
    """Return an interaction design, for what needs one.

    `lacks` is why another kind does not do, such as ``has nothing to tune``.
    """
    spec = loaded.spec
    if spec.kind == "interaction-design":
        return spec
    raise wrong_kind(
        loaded,
        f"a spec of kind {spec.kind} {lacks}",
        f"use {_FOR_KIND[spec.kind]}, or a spec of kind interaction-design",
    )


def design_at_least_cost(loaded: LoadedSpec) -> Designed | None:
    """Build the plant of a spec and choose gains of the least cost; None for given matrices.

    Which gains a spec has, `nrs_design.pipeline.runs.run_design` decides.
    """
    if loaded.spec.kind == "robot":
        raise wrong_kind(
            loaded,
            "a robot spec has no controllers that are switched, so there is nothing to certify",
            "use `nrs-design robot check SPEC`, or a spec of kind interaction-design",
        )
    spec = loaded.spec
    if spec.kind != "interaction-design":
        return None
    from nrs_design.design.analysis import design_controllers
    from nrs_design.spec.build_plant import build_plant

    with placed(loaded):
        plant = build_plant(spec)
        return Designed(loaded, spec, plant, design_controllers(spec, plant))


def run_linear_parts(designed: Designed) -> LinearParts:
    """Return plant, controllers and contacts of a design, at nominal values."""
    from nrs_design.design.linear_parts import linear_parts

    return linear_parts(designed.plant, designed.design)


def run_open_loops(designed: Designed) -> tuple[OpenLoop, ...]:
    """Return the loops whose margins a design has, at every corner."""
    from nrs_design.design.linear_parts import open_loops

    return open_loops(designed.spec, designed.plant, designed.design)


def run_analysis(designed: Designed) -> DesignAnalysis:
    """Compute what a design achieves; an unstable nominal loop is a `DesignError`."""
    from nrs_design.design.analysis import analyze_design

    with placed(designed.loaded):
        return analyze_design(designed.spec, designed.plant, designed.design)


def wanted_age(designed: Designed) -> int | None:
    """Return the age of the force for the goal `delay`, in samples, if it is not declared.

    None where the declared ages reach the goal.
    """
    goals, sampling = designed.spec.goals, designed.spec.sampling
    delay = None if goals is None else goals.delay
    if delay is None or sampling is None or sampling.oldest >= delay.exact:
        return None
    age = ceil(delay.exact / sampling.outer)
    if age > LONGEST_DELAY:
        raise DesignError(
            f"the goal delay, {delay.text}, is {age} samples, and at most {LONGEST_DELAY} are "
            "modelled",
            remedy="ask for a shorter delay, or sample less often",
            at=("goals", "delay"),
        )
    return age


def for_goal(designed: Designed) -> Designed | None:
    """Return a design that declares the age for its goal `delay`; None if it already does."""
    age = wanted_age(designed)
    return None if age is None else declaring(designed, age)


def declaring(designed: Designed, age: int) -> Designed:
    """Return a design whose spec declares ages of the force up to this one, in samples."""
    assert designed.spec.sampling is not None, "a delay is of samples"
    shortest = designed.spec.sampling.delay[0]
    spec = designed.spec.declaring_ages((min(shortest, age), age))
    return replace(designed, loaded=replace(designed.loaded, spec=spec), spec=spec)

"""What `optimize` does and says where goals of the certificate choose the gains."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from nrs_design.cli.destinations import check_beside
from nrs_design.cli.granted import print_granted
from nrs_design.cli.printing import note, progress, say
from nrs_design.errors import OutputError
from nrs_design.progress import Progress
from nrs_design.proof.bounds import lower_float

if TYPE_CHECKING:
    from nrs_design.certificates.goals import CertifiedGoal
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.pipeline.certification import Result
    from nrs_design.pipeline.certified_optimum import CertifiedOptimum
    from nrs_design.pipeline.design import Designed
    from nrs_design.spec import LoadedSpec
    from nrs_design.spec.spec_document import SpecDocument

ENDING = ".nrs.yaml"


@dataclass(frozen=True, slots=True)
class CertifiedGains:
    """Gains that come with their proof, and where both were written."""

    given: Designed  # The spec as it stands
    found: CertifiedOptimum
    designed: Designed  # The spec with these gains
    analysis: DesignAnalysis
    goals: tuple[CertifiedGoal, ...]
    # spec, certificate: files that were written; None if none was asked for.
    spec: Path | None
    certificate: Path | None

    @classmethod
    def of(cls, designed: Designed, analysis: DesignAnalysis, out: Path | None) -> Self | None:
        """Choose gains by the goals of the certificate, and write them; None without such goals.

        A `DesignError` if the goals are not reached.
        """
        from nrs_design.controllers.gains import steering_goals

        if not steering_goals(designed.spec):
            if out is not None:
                raise OutputError(
                    "only gains that were chosen by a goal of the proof are written",
                    path=out,
                    remedy="add `goals: {decay_rate: 2 1/s}` and leave a gain free, or leave "
                    "--out out",
                )
            return None

        from nrs_design.certificates.goals import certified_goals
        from nrs_design.pipeline.certified_optimum import run_certified_optimum
        from nrs_design.pipeline.design import run_analysis

        name = None if out is None else name_for(designed.loaded, out)
        with progress(f"gains with their proof for {designed.spec.name}") as step:
            found = run_certified_optimum(designed, analysis, step)
            written = None if name is None else certified_spec(found, name, step)
        own = found.result.designed
        assert own is not None, "as it was designed before"
        goals = tuple(certified_goals(own.spec, found.result.certificate))
        certificate = None if written is None or out is None else write_certified(written, out)
        return cls(designed, found, own, run_analysis(own), goals, out, certificate)

    @property
    def proved(self) -> bool:
        """Whether all goals of the certificate are met."""
        return all(goal.met for goal in self.goals)

    def facts(self) -> dict[str, Any]:
        """Return the same for JSON, in SI units."""
        from nrs_design.certificates.goals import decay_rate

        found = self.found
        rate = decay_rate(found.result.certificate)
        return {
            "gains": {f"{name}.{gain}": text for (name, gain), text in found.gains.items()},
            "cost": found.cost,
            "free_cost": found.free_cost,
            "free_decay_rate": found.free_rate,
            "binds": [goal.key for goal in found.goals if goal.binds],
            "prices": {goal.key: goal.price for goal in found.goals},
            "goals": [
                {"goal": goal.key, "wanted": goal.wanted, "shown": goal.said, "met": goal.met}
                for goal in self.goals
            ],
            "decay_rate": None if rate is None else lower_float(rate),
            "designs_tried": found.tried,
            "at_bounds": dict(found.at_bounds),
            "declares_delay": self._declared,
            "spec": None if self.spec is None else str(self.spec),
            "certificate": None if self.certificate is None else str(self.certificate),
        }

    def show(self) -> None:
        """Print what is proved, and what it costs."""
        found = self.found
        for goal in self.goals:
            ends = "PROVED" if goal.met else "NOT PROVED"
            say(f"goal {goal.key}, {goal.wanted}: {ends}: {goal.said}")
        if self.spec is None:
            say("  every command takes these gains; --out NEW.nrs.yaml writes a spec with them")
        print_granted(found.result)
        more, rate = max(found.cost - found.free_cost, 0.0), found.free_rate or 0.0
        # A rate that is not positive is no decay.
        shows = f"a decay of {rate:.3g} 1/s" if rate > 0 else "no decay"
        if self.analysis.impedance:
            least = f"{more:.4f} above the least without these"
            say(f"cost {found.cost:.4f} of all controllers, {least}")
            say(f"goals, of which one quadratic function shows {shows} (floating point)")
        else:
            say(f"no gain here has a cost: goals alone move what is given, which shows {shows}")
        for steered in found.goals if self.analysis.impedance else ():
            if not steered.binds:
                say(f"{steered.key} does not raise the cost")
            elif (tighter := steered.price_of_a_percent) is None:
                say(f"{steered.key} binds")
            else:
                price = f"1 % tighter costs about {tighter:.2g} before gains are rounded"
                say(f"{steered.key} binds: {price}")
        self._show_freed()

    def _show_freed(self) -> None:
        """Print gains and ages that are not those of the spec."""
        units, bounds = self.designed.design.units, dict(self.found.at_bounds)
        for name, free in self.given.spec.design.free.items():
            own = self.given.design.laws[name].gains
            for gain, _ in free.given():
                value = self.designed.design.laws[name].gains[gain]
                times = f"{float(value / own[gain]):.3g} times the given one"
                on = bounds.get(f"{name} {gain}")
                say(
                    f"{name} {gain} = {float(value):.6g} {units[name][gain]}, {times}"
                    + ("" if on is None else f": on its {on} bound, as the cost has neither noise")
                )
                if on is not None:
                    say("of the sensor nor effort of the motor; look at both before you take it")
        if (delay := self._declared) is not None:
            say(f"proved for `sampling.delay: {delay}`, more than the spec declares")

    @property
    def _declared(self) -> list[int] | None:
        """The ages of the force that were declared beyond those of the spec."""
        certificate = self.found.result.certificate
        return None if certificate is None or certificate.ages is None else [*certificate.ages]


def name_for(loaded: LoadedSpec, out: Path) -> str:
    """Return the name of the new spec; refuse a place that it cannot be at."""
    from nrs_design.errors import SpecError
    from nrs_design.output import check_place
    from nrs_design.ownership import check_certificate
    from nrs_design.spec.edits import changed
    from nrs_design.spec.load import respecified

    name = out.name.removesuffix(ENDING)
    if not out.name.endswith(ENDING):
        raise OutputError("is not the name of a spec", path=out, remedy=f"end it in {ENDING}")
    check_place(out)
    if out.exists():
        raise OutputError("exists, and is not replaced", path=out, remedy="name a new file")
    try:
        respecified(loaded, changed(loaded.root, ("name",), name))
    except SpecError as error:
        remedy = error.faults[0].remedy
        raise OutputError(error.faults[0].message, path=out, remedy=remedy) from error
    check_certificate(out, _certificate_of(name))
    check_beside(loaded, out)
    return name


def certified_spec(found: CertifiedOptimum, name: str, step: Progress) -> Result:
    """Return the spec that gives these gains, and declares what is proved of it, certified."""
    from nrs_design.pipeline.certification import certify_design
    from nrs_design.pipeline.gain_coordinate import with_gains
    from nrs_design.pipeline.runs import run_design

    designed, certificate = found.result.designed, found.result.certificate
    assert designed is not None, "as it was designed before"
    ages = None if certificate is None else certificate.ages

    def change(document: SpecDocument) -> None:
        document.put(document.root, "name", name)
        if ages is not None:
            document.put(document.root["sampling"], "delay", [*ages])

    loaded = with_gains(designed, found.gains, change)
    return certify_design(loaded, run_design(loaded), progress=step)


def _certificate_of(name: str) -> Path:
    return Path("reports") / f"{name}.cert.json"


def write_certified(result: Result, out: Path) -> Path:
    """Write a spec and its certificate, both or none; return where the certificate is."""
    from nrs_design.certificates.certificate import dump
    from nrs_design.output import CERTIFICATE, write_outputs
    from nrs_design.ownership import origin_of

    assert result.certificate is not None, "as its goals are met"
    path = _certificate_of(result.loaded.spec.name)
    content = dump(result.certificate, origin_of(out, path))
    write_outputs([(out, result.loaded.text, b""), (path, content, CERTIFICATE)])
    note(f"spec written to {out}, certificate to {path}")
    return path

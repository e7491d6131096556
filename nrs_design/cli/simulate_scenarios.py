"""``nrs-design simulate`` without more: the scenarios of a spec, each run once."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.axis import unit
from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer
from nrs_design.cli.printing import note, say, wants_details
from nrs_design.cli.run_files import RunFiles, write_runs
from nrs_design.cli.tables import print_table
from nrs_design.facts.simulation import run_facts
from nrs_design.facts.spec import spec_facts
from nrs_design.progress import Progress

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from nrs_design.certificates.certificate import Certificate
    from nrs_design.output import Output
    from nrs_design.pipeline.certified_runs import CertifiedBound, CertifiedRate
    from nrs_design.pipeline.design import Designed
    from nrs_design.pipeline.scenarios import Runs, Simulated
    from nrs_design.simulation.run import Run

# A run, and the bounds and the rate that are certified beside it.
Bounded = tuple["Simulated", "tuple[CertifiedBound, ...]", "CertifiedRate | None"]


def simulate_scenarios(
    designed: Designed,
    wanted: Runs,
    prove: Callable[[], Certificate | None],
    out: Path | None,
    step: Progress,
) -> Answer:
    """Simulate, and write the figures and tables of every run.

    `prove` returns the certificate whose bounds are shown, if any; it is called when all has run.
    """
    from nrs_design.pipeline.scenarios import run_scenarios

    if out is not None:
        _check_places(designed, wanted, out)
    found = list(run_scenarios(designed, wanted, step))
    proof = prove()
    runs = [(one, *_certified(designed, proof, one)) for one in found]
    step("figures")
    files = [] if out is None else _write(designed, out, runs)

    def show() -> None:
        if not wants_details():
            _print_briefly(runs)
            return
        for run in runs:
            _print(*run)
        say("not modelled:")
        for line in dict.fromkeys(line for one in found for line in one.run.left_out):
            say(f"  - {line}")

    facts = spec_facts(designed.loaded)
    return Answer(
        lambda: facts | {"runs": [run_facts(*run) for run in runs], "files": files},
        show,
        exit_codes.INCONCLUSIVE if any(one.run.stopped for one in found) else exit_codes.PROVED,
    )


def _certified(
    designed: Designed, proof: Certificate | None, one: Simulated
) -> tuple[tuple[CertifiedBound, ...], CertifiedRate | None]:
    """Return what is certified beside a run: bounds, and a rate."""
    from nrs_design.pipeline.certified_runs import hold_bounds, hold_rate

    if proof is None:
        return (), None
    return hold_bounds(designed, proof, one), hold_rate(designed, proof, one)


def _check_places(designed: Designed, wanted: Runs, out: Path) -> None:
    from nrs_design.pipeline.scenarios import names_of

    for name in names_of(designed.spec, wanted):
        _files(designed, out, name).check()


def _files(designed: Designed, out: Path, scenario: str) -> RunFiles:
    from nrs_design.output import RESPONSE

    return RunFiles(out, f"{designed.spec.name}.{scenario}", RESPONSE)


def _write(designed: Designed, out: Path, runs: Sequence[Bounded]) -> list[str]:
    from nrs_design.reporting.figures.simulated import draw_simulated
    from nrs_design.simulation.run import common_lever_arm

    limits = designed.spec.limits
    outputs: list[Output] = []
    for one, bounds, _ in runs:
        response = one.run.response
        touched = [surface.environment for surface in one.scenario.surfaces]
        arm = common_lever_arm(designed.spec, touched)
        level = next(((b.level, not b.uncovered) for b in bounds if b.output == "force"), None)
        figure = draw_simulated(response, limits.torque.si, limits.velocity.si, arm, level)
        files = _files(designed, out, one.scenario.name)
        outputs += files.outputs(response.to_csv(), figure)
    written = write_runs(outputs)
    note(f"written to {out}")
    return written


def _print_briefly(runs: Sequence[Bounded]) -> None:
    """Print a row for each run, and what went wrong in one."""
    from nrs_design.axis import current
    from nrs_design.proof.bounds import upper
    from nrs_design.reporting.simulation import four_digits_up

    fine, rows, beyond = current().fine, [], False
    for one, bounds, _ in runs:
        proved = {b.output: b.level for b in bounds if not b.uncovered}
        limits = {"torque": one.metrics["torque_limit"], **one.scenario.limits}
        peaks = {"torque": "peak_torque", "velocity": "peak_velocity", "deflection": "peak_depth"}
        shown = {
            key: four_digits_up((1.0 if key == "torque" else fine) * one.metrics[name])
            + "!" * (one.metrics[name] > limits.get(key, math.inf))
            for key, name in peaks.items()
        }
        beyond = beyond or "!" in "".join(shown.values())
        rows.append(
            [
                one.run.scenario,
                shown["torque"],
                upper(Fraction(proved["force"]), 4) if "force" in proved else "-",
                f"{limits['torque']:.4g}",
                shown["velocity"],
                shown["deflection"],
                str(one.metrics["switches"]),
            ]
        )
    columns = [
        "run",
        f"largest\n{unit('N m')}",
        f"proved\n{unit('N m')}",
        f"limit\n{unit('N m')}",
        f"speed\n{unit('deg/s')}",
        f"deflection\n{unit('deg')}",
        "switches",
    ]
    print_table("", columns, rows)
    if beyond:
        say("! beyond a limit of the spec or the scenario")
    for one, _, _ in runs:
        if one.run.stopped:
            say(f"{one.run.scenario}: STOPPED: {one.run.stopped}")
        if one.run.refused:
            say(f"{one.run.scenario}: the law refused {one.run.refused} samples")
        if one.run.saturated:
            say(f"{one.run.scenario}: the motor met its limit at {one.run.saturated} samples")
    say("A run proves nothing; -v says more.")


def _print(one: Simulated, bounds: tuple[CertifiedBound, ...], rate: CertifiedRate | None) -> None:
    """Print the metrics of a run, bounds beside what they bound."""
    from nrs_design.proof.bounds import upper
    from nrs_design.reporting.simulation import four_digits_up, metric_rows

    run = one.run
    print_table(f"{run.scenario}: {run.engine} engine", ["", "value", "unit", "limit"],
                metric_rows(one.metrics, one.scenario.limits))  # fmt: skip
    say(f"  {_setting(run)}")
    peaks = {"force": one.metrics["peak_torque"], "velocity": one.metrics["peak_velocity"]}
    for b in bounds:
        peak = peaks.get(b.output)
        shown = "" if peak is None else f", simulated peak {four_digits_up(peak)} {b.unit}"
        level = upper(Fraction(b.level))
        say(f"  certified bound on the {b.output}: {level} {b.unit}{shown}")
        for reason in b.uncovered:
            say(f"    it is not about this run: {reason}")
    if rate is not None:
        here = "" if rate.start is None else f", here from {rate.start:.6g} s on"
        say(f"  certified decay once nothing is commanded{here}: {_rate(rate)}")
        for reason in rate.uncovered:
            say(f"    it is not about this run: {reason}")
    if run.missed is not None:
        say(
            f"  deadlines missed: {run.missed} of {run.steps} samples, drawn from the seed of the "
            "scenario as the rule of the spec allows"
        )
    if run.refused:
        say(f"  the law refused {run.refused} samples: an input was beyond its limits")
    if run.saturated:
        say(f"  the motor's command met its limit at {run.saturated} samples")
    if run.stopped:
        say(f"  STOPPED: {run.stopped}")


def _setting(run: Run) -> str:
    """Say which controllers were in force, and when the law ran, on how old a force sample."""
    modes = run.response.modes
    active = [modes[i] for i in sorted(set(run.response.mode.tolist()))]
    said = f"in force: {', '.join(active)}"
    if run.sampling is None:
        return f"{said}; continuous time, force of the moment"
    period, youngest, oldest = run.sampling
    age = f"{oldest}" if youngest == oldest else f"{youngest} to {oldest}, drawn anew at each"
    clock = f"a sample every {period:.6g} s"
    if run.outer not in (None, period):
        clock = f"motion loop every {period:.6g} s, force sample every {run.outer:.6g} s"
    return f"{said}; {clock}, age of the force in samples: {age}"


def _rate(rate: CertifiedRate) -> str:
    """Return the rate in words, rounded to the safe side."""
    from nrs_design.proof.bounds import lower, upper

    number = Fraction(rate.rate)
    text = f"{lower(number)} 1/s" if rate.unit else f"by {upper(number)} a sample"
    return text + ("" if rate.attained else ", or any slower one")

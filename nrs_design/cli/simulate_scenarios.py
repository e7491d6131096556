"""What ``nrs-design simulate`` does: scenarios, each run once, or an adversary; files of runs."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.axis import unit
from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer
from nrs_design.cli.printing import note, say, wants_details
from nrs_design.cli.tables import print_table
from nrs_design.output import (
    PNG,
    RESPONSE,
    SVG,
    WORST_RUN,
    Beginning,
    Output,
    check_place,
    write_outputs,
)
from nrs_design.progress import Progress

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from matplotlib.figure import Figure

    from nrs_design.api.simulation import ScenarioRun, Simulation
    from nrs_design.api.worst import WorstFound
    from nrs_design.certificates.certificate import Certificate
    from nrs_design.pipeline.design import Designed
    from nrs_design.pipeline.scenarios import CertifiedRate, Runs
    from nrs_design.simulation.run import Run


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
    from nrs_design.api.simulation import Simulation
    from nrs_design.pipeline.scenarios import names_of, run_scenarios

    name = designed.spec.name
    _check_runs(out, (f"{name}.{one}" for one in names_of(designed.spec, wanted)), RESPONSE)
    found = list(run_scenarios(designed, wanted, step))
    runs = Simulation.of(designed, found, prove())
    step("figures")
    drawn = ((f"{name}.{one.name}", one.response.to_csv(), one.plot()) for one in runs)
    files = _write_runs(out, drawn, RESPONSE)

    def show() -> None:
        if not wants_details():
            _print_briefly(runs)
            return
        for one in runs:
            _print(one)
        say("not modelled:")
        for line in dict.fromkeys(line for one in runs for line in one.run.left_out):
            say(f"  - {line}")

    return Answer(
        lambda: runs.to_dict() | {"files": files},
        show,
        exit_codes.INCONCLUSIVE if any(one.run.stopped for one in runs) else exit_codes.PROVED,
    )


def worst_case(
    designed: Designed, proof: Certificate | None, out: Path | None, step: Progress
) -> Answer:
    """Search, and write the figure and the table of every run."""
    from nrs_design.api.worst import WorstFound
    from nrs_design.pipeline.scenarios import run_worst_case
    from nrs_design.reporting.worst_case import response_of
    from nrs_design.simulation.worst_outputs import DEFLECTION

    begun = f"{designed.spec.name}.worst-"
    names = (f"{begun}{name}" for name in ("force", "velocity", DEFLECTION))
    _check_runs(out, names, WORST_RUN)
    case = run_worst_case(designed, proof, progress=step)
    found = WorstFound(designed, case)
    step("figures")
    runs = (
        (f"{begun}{run.output.name}", response_of(case, run).to_csv(), found.plot(run.output.name))
        for run in case.runs
    )
    written = _write_runs(out, runs, WORST_RUN)
    return Answer(lambda: found.to_dict() | {"files": written}, lambda: _print_worst(found))


def _print_worst(found: WorstFound) -> None:
    from nrs_design.reporting.worst_case import COLUMNS, LEFT_OUT, UNDECLARED, meaning, worst_rows

    case, spec = found.case, found.designed.spec
    title = f"{spec.name}: the worst that an adversary found"
    print_table(title, COLUMNS, worst_rows(case, spec))
    say(meaning(case))
    if not case.declared:
        say(UNDECLARED)
    say(f"not in it: {LEFT_OUT}")


def _places(folder: Path, name: str, table: Beginning) -> dict[Path, Beginning]:
    """Return ``NAME.csv``, ``.svg`` and ``.png``, and how one that may be replaced begins."""
    kinds: dict[str, Beginning] = {"csv": table, "svg": SVG, "png": PNG}
    return {folder / f"{name}.{ending}": kind for ending, kind in kinds.items()}


def _check_runs(folder: Path | None, names: Iterable[str], table: Beginning) -> None:
    """Refuse, before the work, a folder in which something else stands at one of the places."""
    if folder is None:
        return
    for name in names:
        for place, kind in _places(folder, name, table).items():
            check_place(place, kind)


def _write_runs(
    folder: Path | None, runs: Iterable[tuple[str, str, Figure]], table: Beginning
) -> list[str]:
    """Write name, table and figure of all runs, once all of them are there; return their files."""
    from nrs_design.reporting.images import to_png, to_svg_file

    if folder is None:
        return []
    outputs: list[Output] = []
    for name, text, figure in runs:
        contents: list[str | bytes] = [text, to_svg_file(figure), to_png(figure)]
        places = zip(_places(folder, name, table).items(), contents, strict=True)
        outputs += [(place, content, kind) for (place, kind), content in places]
    write_outputs(outputs)
    note(f"written to {folder}")
    return [str(path) for path, _, _ in outputs]


def _print_briefly(runs: Simulation) -> None:
    """Print a row for each run, and what went wrong in one."""
    from nrs_design.axis import current
    from nrs_design.proof.bounds import upper
    from nrs_design.reporting.simulation import four_digits_up

    fine, rows, beyond = current().fine, [], False
    for one in runs:
        proved = {b.output: b.level for b in one.bounds if not b.uncovered}
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
                one.name,
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
    for one in runs:
        if one.run.stopped:
            say(f"{one.name}: STOPPED: {one.run.stopped}")
        if one.run.refused:
            say(f"{one.name}: the law refused {one.run.refused} samples")
        if one.run.saturated:
            say(f"{one.name}: the motor met its limit at {one.run.saturated} samples")
    say("A run proves nothing; -v says more.")


def _print(one: ScenarioRun) -> None:
    """Print the metrics of a run, bounds beside what they bound."""
    from nrs_design.proof.bounds import upper
    from nrs_design.reporting.simulation import four_digits_up, metric_rows

    run, rate = one.run, one.rate
    print_table(f"{run.scenario}: {run.engine} engine", ["", "value", "unit", "limit"],
                metric_rows(one.metrics, one.scenario.limits))  # fmt: skip
    say(f"  {_setting(run)}")
    peaks = {"force": one.metrics["peak_torque"], "velocity": one.metrics["peak_velocity"]}
    for b in one.bounds:
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

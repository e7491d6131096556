"""Runs of ``nrs-design simulate``: all scenarios once, or an adversary; their files."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer
from nrs_design.cli.printing import note, say, wants_details
from nrs_design.cli.tables import print_table
from nrs_design.models.axis import unit
from nrs_design.output import PNG, RESPONSE, SVG, Beginning, Output, check_place, write_outputs
from nrs_design.progress import Progress

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from matplotlib.figure import Figure

    from nrs_design.api.simulation import ScenarioRun, Simulation
    from nrs_design.certificates.certificate import Certificate
    from nrs_design.pipeline.design import Designed
    from nrs_design.pipeline.scenarios import CertifiedRate, Runs
    from nrs_design.simulation.run import Run


def simulate_scenarios(
    designed: Designed,
    settings: Runs,
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
    _check_runs(out, (f"{name}.{one}" for one in names_of(designed.spec, settings)), tables=True)
    found = list(run_scenarios(designed, settings, step))
    runs = Simulation.of(designed, found, prove())
    step("figures")
    outputs = ((f"{name}.{one.name}", one.plot(), one.response.to_csv()) for one in runs)
    files = _write_runs(out, outputs)

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
    """Search, and write the figure of every run."""
    from nrs_design.api.worst import WorstFound
    from nrs_design.pipeline.scenarios import run_worst_case
    from nrs_design.reporting.worst_case import COLUMNS, LEFT_OUT, UNDECLARED, meaning, worst_rows

    spec = designed.spec
    prefix = f"{spec.name}.worst-"
    _check_runs(out, (f"{prefix}{name}" for name in ("force", "velocity", "deflection")))
    case = run_worst_case(designed, proof, progress=step)
    found = WorstFound(designed, case)
    step("figures")
    files = _write_runs(out, ((f"{prefix}{name}", found.plot(name)) for name in found.figures))

    def show() -> None:
        title = f"{spec.name}: the worst that an adversary found"
        print_table(title, COLUMNS, worst_rows(case, spec))
        say(meaning(case))
        if not case.declared:
            say(UNDECLARED)
        say(f"not in it: {LEFT_OUT}")

    return Answer(lambda: found.to_dict() | {"files": files}, show)


def _check_runs(folder: Path | None, names: Iterable[str], *, tables: bool = False) -> None:
    """Refuse, before the work, a folder in which something else stands at one of the places."""
    if folder is None:
        return
    kinds: dict[str, Beginning] = {"svg": SVG, "png": PNG}
    if tables:
        kinds["csv"] = RESPONSE
    for name, (ending, kind) in product(names, kinds.items()):
        check_place(folder / f"{name}.{ending}", kind)


def _write_runs(
    folder: Path | None, runs: Iterable[tuple[str, Figure, *tuple[str, ...]]]
) -> list[str]:
    """Write figure, and table if any, of all runs, once all are there; return their files."""
    from nrs_design.reporting.images import render_png, render_svg_file

    if folder is None:
        return []
    outputs: list[Output] = []
    for name, figure, *tables in runs:
        outputs += [(folder / f"{name}.csv", table, RESPONSE) for table in tables]
        outputs.append((folder / f"{name}.svg", render_svg_file(figure), SVG))
        outputs.append((folder / f"{name}.png", render_png(figure), PNG))
    write_outputs(outputs)
    note(f"written to {folder}")
    return [str(path) for path, _, _ in outputs]


def _print_briefly(runs: Simulation) -> None:
    """Print a row for each run, and the faults of each run."""
    from nrs_design.models.axis import current
    from nrs_design.proof.bounds import upper
    from nrs_design.reporting.simulation import four_digits_up

    fine, rows, exceeds_limit = current().fine, [], False
    for one in runs:
        proved = {b.output: b.level for b in one.bounds if not b.uncovered}
        limits = {"torque": one.metrics["torque_limit"], **one.scenario.limits}
        peaks = {"torque": "peak_torque", "velocity": "peak_velocity", "deflection": "peak_depth"}
        texts = {
            key: four_digits_up((1.0 if key == "torque" else fine) * one.metrics[name])
            + "!" * (one.metrics[name] > limits.get(key, math.inf))
            for key, name in peaks.items()
        }
        exceeds_limit = exceeds_limit or "!" in "".join(texts.values())
        bound = upper(Fraction(proved["force"]), 4) if "force" in proved else "-"
        torque = (texts["torque"], bound, f"{limits['torque']:.4g}")
        motion_cells = (texts["velocity"], texts["deflection"], str(one.metrics["switches"]))
        rows.append([one.name, *torque, *motion_cells])
    torques = [f"{kind}\n{unit('N m')}" for kind in ("largest", "proved", "limit")]
    moves = [f"speed\n{unit('deg/s')}", f"deflection\n{unit('deg')}"]
    print_table("", ["run", *torques, *moves, "switches"], rows)
    if exceeds_limit:
        say("! beyond a limit of the spec or the scenario")
    for one in runs:
        if one.run.stopped:
            say(f"{one.name}: STOPPED: {one.run.stopped}")
        if one.run.refused:
            say(f"{one.name}: the law refused {one.run.refused} samples")
        if one.run.saturated:
            say(f"{one.name}: the motor met its limit at {one.run.saturated} samples")
    say("A run proves nothing; -v says more.")


def _print(result: ScenarioRun) -> None:
    """Print the metrics of a run with their certified bounds."""
    from nrs_design.proof.bounds import upper
    from nrs_design.reporting.simulation import four_digits_up, metric_rows

    run, rate = result.run, result.rate
    print_table(f"{run.scenario}: {run.engine} engine", ["", "value", "unit", "limit"],
                metric_rows(result.metrics, result.scenario.limits))  # fmt: skip
    say(f"  {_setting(run)}")
    peaks = {"force": result.metrics["peak_torque"], "velocity": result.metrics["peak_velocity"]}
    for b in result.bounds:
        peak = peaks.get(b.output)
        peak_text = "" if peak is None else f", simulated peak {four_digits_up(peak)} {b.unit}"
        level = upper(Fraction(b.level))
        say(f"  certified bound on the {b.output}: {level} {b.unit}{peak_text}")
        for reason in b.uncovered:
            say(f"    it is not about this run: {reason}")
    if rate is not None:
        start = "" if rate.start is None else f", here from {rate.start:.6g} s on"
        say(f"  certified decay once nothing is commanded{start}: {_rate(rate)}")
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
    modes_text = f"in force: {', '.join(active)}"
    if run.sampling is None:
        return f"{modes_text}; continuous time, force of the moment"
    period, youngest, oldest = run.sampling
    age = f"{oldest}" if youngest == oldest else f"{youngest} to {oldest}, drawn anew at each"
    clock = f"a sample every {period:.6g} s"
    if run.outer not in (None, period):
        clock = f"motion loop every {period:.6g} s, force sample every {run.outer:.6g} s"
    return f"{modes_text}; {clock}, age of the force in samples: {age}"


def _rate(rate: CertifiedRate) -> str:
    """Return the rate in words, rounded to the safe side."""
    from nrs_design.proof.bounds import lower, upper

    number = Fraction(rate.rate)
    text = f"{lower(number)} 1/s" if rate.unit else f"by {upper(number)} a sample"
    return text + ("" if rate.attained else ", or any slower one")

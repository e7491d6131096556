"""``nrs-design simulate --worst-case``: what an adversary finds, beside limits and bounds."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design.cli import exit_codes
from nrs_design.cli.printing import note, print_json, say
from nrs_design.cli.tables import print_table
from nrs_design.progress import Progress

if TYPE_CHECKING:
    from collections.abc import Callable

    from nrs_design.certificates.certificate import Certificate
    from nrs_design.output import Beginning
    from nrs_design.pipeline import Designed
    from nrs_design.pipeline.worst_case import WorstCase


def worst_case(
    designed: Designed, proof: Certificate | None, seed: int, out: Path | None, step: Progress
) -> Callable[..., int]:
    """Search, and write the figure and the table of every run; return what prints it.

    Parameters
    ----------
    designed : Designed
        The spec and its gains.
    proof : Certificate or None
        Whose bounds are shown.
    seed : int
        Of the search.
    out : Path or None
        Folder for files.
    step : callable
        Told what is done.
    """
    from nrs_design.output import check_place
    from nrs_design.pipeline.worst_case import run_worst_case
    from nrs_design.simulation.worst_outputs import DEFLECTION

    names = ("force", "velocity", DEFLECTION)
    for path, beginning in (item for name in names for item in _places(designed, out, name)):
        check_place(path, beginning)
    case = run_worst_case(designed, proof, seed=seed, progress=step)
    step("figures")
    return partial(_show, designed, case, _write(designed, case, out), seed)


def _show(
    designed: Designed,
    case: WorstCase,
    files: list[Path],
    seed: int,
    *,
    as_json: bool,
    quiet: bool,
) -> int:
    from nrs_design.reporting.worst_case import (
        COLUMNS,
        MEANING,
        NO_BOUND,
        UNDECLARED,
        left_out,
        worst_rows,
    )

    if files:
        note(f"written to {files[0].parent}", quiet=quiet)
    if as_json:
        print_json("simulate", _document(designed, case, seed) | {"files": list(map(str, files))})
    elif not quiet:
        title = f"{designed.spec.name}: the worst that an adversary found, seed {seed}"
        print_table(title, COLUMNS, worst_rows(case, _arm(designed)))
        say(MEANING if case.bounds else f"{MEANING.partition(';')[0]}. {NO_BOUND}")
        if not case.declared:
            say(UNDECLARED)
        say(f"not in it: {left_out(case.system)}")
    return exit_codes.PROVED


def _arm(designed: Designed) -> float | None:
    from nrs_design.simulation.run import common_lever_arm

    return common_lever_arm(designed.spec, designed.spec.touched)


def _places(designed: Designed, out: Path | None, name: str) -> list[tuple[Path, Beginning]]:
    from nrs_design.output import ARCHIVE, PNG, SVG, WORST_RUN

    if out is None:
        return []
    beginnings: dict[str, Beginning] = {"csv": WORST_RUN, "npz": ARCHIVE, "svg": SVG, "png": PNG}
    stem = f"{designed.spec.name}.worst-{name}"
    return [(out / f"{stem}.{suffix}", beginning) for suffix, beginning in beginnings.items()]


def _write(designed: Designed, case: WorstCase, out: Path | None) -> list[Path]:
    if out is None:
        return []
    from nrs_design.output import Output, write_outputs
    from nrs_design.reporting.images import to_png, to_svg_file
    from nrs_design.reporting.worst_case import draw_worst, response_of

    outputs: list[Output] = []
    arm = _arm(designed)
    for run in case.runs:
        response = response_of(case, run)
        figure = draw_worst(case, run, arm)
        contents: tuple[str | bytes, ...] = (
            response.to_csv(),
            response.to_npz(),
            to_svg_file(figure),
            to_png(figure),
        )
        places = _places(designed, out, run.output.name)
        outputs += [
            (path, content, ours) for content, (path, ours) in zip(contents, places, strict=True)
        ]
    write_outputs(outputs)
    return [path for path, _, _ in outputs]


def _document(designed: Designed, case: WorstCase, seed: int) -> dict[str, Any]:
    from nrs_design.reporting.worst_case import found_in, left_out

    found = [
        {
            "output": item.name,
            "unit": item.unit,
            "worst_found": item.value,
            "limit": item.limit,
            "certified_bound": item.bound,
            "bound_over_found": item.ratio,
            "exceeds_limit": item.exceeds,
            "duration": float(run.time[-1]),
            "starts": [float(value) for value in run.starts],
        }
        for item, run in zip(found_in(case), case.runs, strict=True)
    ]
    return {
        "spec": designed.spec.name,
        "spec_sha256": designed.loaded.sha256,
        "worst_case": {
            "seed": seed,
            "disturbances": [
                {"name": c.name, "unit": c.unit, "bound": float(c.bound)}
                for c in case.system.channels
            ],
            "disturbances_declared": case.declared,
            "found": found,
            "not_modelled": [left_out(case.system)],
        },
    }

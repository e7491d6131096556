"""``nrs-design optimize``: virtual mass and damping of every impedance controller."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.axis import unit
from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.goals import design_answer, print_responses
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import detail, note, progress, say, wants_details
from nrs_design.cli.tables import print_table
from nrs_design.facts.design import meanings, optimum_facts

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.spec import InteractionDesignSpec


@command("optimize", each_axis=True)
def optimize(
    spec: SpecFile,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="NEW.nrs.yaml",
            help="Write the spec with these gains given, named after the file, and its "
            "certificate to reports/NAME.cert.json; for goals decay_rate, peak_torque and delay.",
        ),
    ] = None,
) -> Answer:
    """Optimize virtual mass Mt and damping Bt for displayed impedance and sensitivity.

    Goals of the spec are respected. With decay_rate, peak_torque or delay among them, the gains of
    all controllers are chosen together, and those that design.free names, and come with their
    proof. The exit code is 1 if gains that are given miss a goal, or if one of a proof is
    not proved, and 3 if one is not judged.

    Example: nrs-design optimize specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.cli.certified_gains import CertifiedGains
    from nrs_design.pipeline.design import design_at_least_cost, interaction_of, run_analysis

    loaded = take_spec(spec)
    with progress(f"designing {loaded.spec.name}") as step:
        step("cost")
        interaction_of(loaded, "has nothing to design")
        designed = design_at_least_cost(loaded)
        assert designed is not None, "an interaction design"
        step("margins")
        analysis = run_analysis(designed)
    certified = CertifiedGains.of(designed, analysis, out)
    if certified is not None:
        designed, analysis = certified.designed, certified.analysis

    def facts() -> dict[str, Any]:
        return {
            **optimum_facts(designed, analysis),
            "certified": None if certified is None else certified.facts(),
        }

    def show() -> None:
        if not analysis.impedance:
            note("no impedance controllers in this spec; see nrs-design tune for the others")
        _print(designed.spec, analysis)
        print_responses(analysis)
        if certified is not None:
            certified.show()

    proved = all(found.proved for item in analysis.impedance for found in item.responses)
    proved = proved and (certified is None or certified.proved)
    has_proof = certified is not None
    return design_answer(
        designed, analysis, analysis.impedance, facts, show, proved=proved, judged=has_proof
    )


def _print(spec: InteractionDesignSpec, analysis: DesignAnalysis) -> None:
    if wants_details():
        from nrs_design.reporting.formatting import polynomial_text

        G = analysis.motion
        source = "by root locus" if analysis.motion_source == "designed" else "given in the spec"
        numerator, denominator = map(polynomial_text, (G.numerator, G.denominator))
        say(f"{spec.name}: G(s) = ({numerator}) / ({denominator}), {source}")
    if not analysis.impedance:
        return
    from nrs_design.cli.marked import basis, cells, marks, worst_of

    columns = [
        "controller",
        f"Mt\n{unit('kg m^2')}",
        f"Bt\n{unit('N m s/rad')}",
        "cost",
        "Ms",
        "gain\nmargin",
        "phase\nmargin",
        "delay\nmargin",
        "disk\nmargin",
        f"stands up to\n{unit('N m/rad')}",
    ]
    print_table(
        f"{spec.name}: {worst_of(analysis.impedance)}", columns, [*map(cells, analysis.impedance)]
    )
    for line in marks(analysis.impedance):
        say(line)
    for line in meanings(analysis.impedance):
        detail(line)
    if not wants_details():
        say(basis(analysis.impedance))

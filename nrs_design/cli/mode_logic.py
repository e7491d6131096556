"""``nrs-design mode-logic``: which controller is active when, and why it cannot chatter."""

from __future__ import annotations

from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import say
from nrs_design.cli.tables import print_blocks


@command("mode-logic")
def mode_logic(spec: SpecFile) -> Answer:
    """Show the mode logic of a spec: switches, dwell times derived from noise and delay.

    Nothing is certified here; `certify-switching` does, with these dwell times where the spec says
    `switching: mode-logic`.

    Example: nrs-design mode-logic docs/examples/insertion-by-sign.nrs.yaml
    """
    from nrs_design.pipeline.design import wrong_kind
    from nrs_design.reporting.sections.mode_logic import logic_meaning, logic_summary, logic_tables

    loaded = take_spec(spec)
    design_spec = loaded.spec
    if design_spec.kind != "interaction-design" or design_spec.mode_logic is None:
        raise wrong_kind(
            loaded,
            "the spec has no mode_logic",
            "add one to an interaction design, see docs/design/mode-logic.md",
        )

    def show() -> None:
        print_blocks(design_spec.name, logic_tables(design_spec))
        for line in logic_meaning(design_spec):
            say(line)

    return Answer(lambda: loaded.facts | logic_summary(design_spec), show)

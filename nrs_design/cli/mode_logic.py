"""``nrs-design mode-logic``: which controller is active when, and why it cannot chatter."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.cli.options import Json, SpecFile
from nrs_design.cli.printing import print_json, say
from nrs_design.cli.tables import print_table

if TYPE_CHECKING:
    from nrs_design.spec import InteractionDesignSpec, LoadedSpec


def mode_logic(spec: SpecFile, as_json: Json = False) -> None:
    """Show the mode logic of a spec: switches, dwell times derived from noise and delay, estimator.

    Nothing is certified here; `certify-switching` does, with these dwell times where the spec says
    `switching: mode-logic`.

    Example: nrs-design mode-logic docs/examples/insertion-by-sign.nrs.yaml
    """
    from nrs_design.reporting.sections.mode_logic import logic_meaning, logic_summary, logic_tables
    from nrs_design.spec import read_spec

    loaded = read_spec(spec)
    declared = _with_logic(loaded)
    if as_json:
        content = {"spec": declared.name, "spec_sha256": loaded.sha256}
        print_json("mode-logic", content | logic_summary(declared))
        return
    for table in logic_tables(declared):
        print_table(f"{declared.name}: {table.title}", table.columns, table.rows)
    for line in logic_meaning(declared):
        say(line)


def _with_logic(loaded: LoadedSpec) -> InteractionDesignSpec:
    from nrs_design.pipeline import wrong_kind

    spec = loaded.spec
    if spec.kind != "interaction-design" or spec.mode_logic is None:
        raise wrong_kind(
            loaded,
            "the spec has no mode_logic",
            "add one to an interaction design, see docs/design/mode-logic.md",
        )
    return spec

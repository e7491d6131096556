"""Runs in the place of the records that figures 6.14 to 6.34 of the thesis show, as one page.

`figures.yaml` says of each what the thesis prints, what goes into the run, and what is drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from nrs_design import __version__
from nrs_design.progress import Progress, silent
from nrs_design.reporting.document import Block, Bullets, Illustration, Report, Section, Table
from nrs_design.reporting.figures.panels import Curve, Panel, PanelColumn, draw_panels
from nrs_design.reporting.render import render_html
from nrs_design.simulation.metrics import displayed_impedance
from nrs_design.simulation.time_response import TimeResponse
from nrs_design.thesis import interaction, thesis
from nrs_design.thesis.errata import read_data

# Thesis 6.3.1.1: from the sensor at the pivot to the contact, in m; a torque in N m is so many N.
ARM = 0.24
# Controllers of the runs by name, and what stands for `force` where a run has another law.
CONTROLLERS = {
    "impedance": interaction.admittance("0", "2.15"),
    "insertion": interaction.admittance("0.01", "2.15"),
    "withdrawal": interaction.admittance("0.01", "1.04"),
    "tissue": interaction.admittance("0.01", "2.15"),
    "tool": interaction.admittance("0.01", "2.11", "stiff"),
    "position": interaction.POSITION,
    "force": interaction.PROPORTIONAL,
}
LAWS = {
    "measured": (interaction.PROPORTIONAL_FROM_MEASURED, ""),
    "integral": (interaction.INTEGRAL, interaction.BLEEDING),
}
ENGINE = (
    "Continuous time, exact between events. Not in it: sampling (motion loop at 500 Hz, admittance "
    "every 0.1 ms), noise and bias of the force sensor, joint clearance, gravity, the other axes."
)
_FIRST = (
    "The thesis draws records of experiments on the robot. Its figures are not copied here: each "
    "has a run of the model in its place, and beside it what the text of the thesis says of the "
    "figure. Nothing was fitted to the print: an input is from the thesis, or is declared as "
    "chosen. A run proves nothing. Simulated numbers beside printed ones are in the table of "
    "`nrs-design reproduce`."
)
FOOTER = "Gallery of nrs-design. Runs are floating-point illustrations; certificates are proofs."


@dataclass(frozen=True, slots=True)
class Counterpart:
    """What stands for a figure, or for several that show the same."""

    given: Mapping[str, Any]  # Its entry in `figures.yaml`
    runs: Mapping[str, TimeResponse]  # By the names of their files
    illustration: Illustration  # Drawn

    @property
    def title(self) -> str:
        """What its section is called, and what was simulated."""
        numbers = list(self.given["shows"])
        figures = f"Figure{'s' * (len(numbers) > 1)} {', '.join(numbers)}"
        return f"{figures}: {self.given['title']}"


def draw_counterparts(progress: Progress = silent) -> tuple[Counterpart, ...]:
    """Simulate and draw all of them."""
    found = []
    for entry in read_data("figures.yaml"):
        progress(f"figures {', '.join(entry['shows'])}")
        runs = {name: _simulate(**run) for name, run in entry["runs"].items()}
        columns = [_column(entry["panels"], runs[c["run"]], c) for c in entry["columns"]]
        name = f"figure-{next(iter(entry['shows'])).replace('.', '-')}-record"
        note = f"{entry['note']} {ENGINE}"
        drawn = Illustration(name, entry["title"].capitalize(), note, draw_panels(columns))
        found.append(Counterpart(entry, runs, drawn))
    return tuple(found)


def _simulate(controllers: Sequence[str], scenario: str, law: str = "") -> TimeResponse:
    chosen = {name: CONTROLLERS[name] for name in controllers}
    more = ""
    if law:
        chosen["force"], more = LAWS[law]
    return interaction.run_scenario(chosen, scenario, more).response


def _column(panels: Sequence[str], response: TimeResponse, given: Mapping[str, Any]) -> PanelColumn:
    low, high = given.get("span") or (0.0, float(response.t[-1]))
    instants = tuple(map(float, given.get("instants", ())))
    values = given.get("values", ())
    crosses = tuple(zip(instants[len(instants) - len(values) :], values, strict=True))
    made = tuple(PANELS[name](response, crosses) for name in panels)
    return PanelColumn(given.get("title", ""), made, (low, high), _stays(response), instants)


def _stays(response: TimeResponse) -> tuple[tuple[float, float, str], ...]:
    """Return from when to when which controller is in force, if there are several."""
    if len(response.modes) == 1:
        return ()
    changes = [0, *(np.flatnonzero(np.diff(response.mode)) + 1).tolist(), len(response) - 1]
    return tuple(
        (float(response.t[a]), float(response.t[b]), response.modes[int(response.mode[a])])
        for a, b in pairwise(changes)
    )


Crosses = tuple[tuple[float, float], ...]


def _command(response: TimeResponse, _: Crosses) -> Panel:
    return Panel("Speed [rad/s]", (Curve(response.t, response["hand"], "command", 1),))


def _speed(response: TimeResponse, crosses: Crosses) -> Panel:
    velocity = Curve(response.t, response["velocity"], "velocity", 0)
    return Panel("Speed [rad/s]", (velocity, *_command(response, crosses).curves))


def _torque(response: TimeResponse, _: Crosses) -> Panel:
    signs = (1, -1) if (response["torque"] < 0).any() else (1,)
    limits = tuple(sign * thesis.TORQUE for sign in signs)
    curve, force = Curve(response.t, response["torque"], "torque", 0), "Force at 240 mm [N]"
    return Panel("Torque [N m]", (curve,), limits, "T_max, 0.3 N m", other=(force, 1 / ARM))


def _depth(response: TimeResponse, _: Crosses) -> Panel:
    return Panel("Depth [mm]", (Curve(response.t, 1e3 * ARM * response["depth"], "depth", 0),))


def _angle(response: TimeResponse, _: Crosses) -> Panel:
    return Panel("Angle [rad]", (Curve(response.t, response["angle"], "angle", 0),))


def _impedance(response: TimeResponse, crosses: Crosses) -> Panel:
    shown, taken = displayed_impedance(response["hand"], response["torque"])
    curves = [Curve(response.t, np.where(taken, shown, np.nan), "displayed impedance", 0)]
    if crosses:
        t, y = np.array(crosses).T
        curves.append(Curve(t, y, "printed value", printed=True))
    return Panel("Impedance\n[N m s/rad]", tuple(curves), (interaction.DESIRED,), "desired, 2.1486")


def _selection(response: TimeResponse, _: Crosses) -> Panel:
    position = (response.mode == response.modes.index("position")).astype(float)
    return Panel("S", (Curve(response.t, position, "S", 3),), ticks=(0, 1))


# What is drawn, by its name in `figures.yaml`.
PANELS: Mapping[str, Callable[[TimeResponse, Crosses], Panel]] = {
    "command": _command,
    "speed": _speed,
    "torque": _torque,
    "depth": _depth,
    "angle": _angle,
    "impedance": _impedance,
    "selection": _selection,
}


def gallery_page(found: Sequence[Counterpart]) -> str:
    """Return the page; the same counterparts give the same bytes."""
    rows = tuple(
        (figure, shows, one.title) for one in found for figure, shows in one.given["shows"].items()
    )
    report = Report(
        name="Figures of the thesis, simulated",
        title="Records of chapter 6: print beside simulation",
        verdict="simulated",
        claim=_FIRST,
        remarks=(),
        facts=(("Figures", str(len(rows))), ("Package", f"nrs-design {__version__}")),
        sections=(
            Section(
                "Every figure", (Table("Figures", ("figure", "in print", "counterpart"), rows),)
            ),
            *map(_section, found),
        ),
        footer=FOOTER,
    )
    return render_html(report)


def _section(one: Counterpart) -> Section:
    blocks: tuple[Block, ...] = (
        Bullets(f"In print, section {one.given['section']}", tuple(one.given["printed"])),
        one.illustration,
        Bullets("Inputs from the thesis", tuple(one.given["given"])),
        Bullets("Inputs of ours, which the thesis omits", tuple(one.given["chosen"])),
    )
    return Section(one.title, blocks)


def summarize_gallery(found: Sequence[Counterpart]) -> list[dict[str, Any]]:
    """Return what the page says, as fields."""
    plain = ("section", "title", "printed", "given", "chosen", "note")
    return [
        {"figures": list(one.given["shows"])}
        | {key: one.given[key] for key in plain}
        | {"runs": [f"{name}.csv" for name in one.runs]}
        for one in found
    ]

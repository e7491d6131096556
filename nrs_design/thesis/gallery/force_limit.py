"""Figures 6.22 to 6.27: position control up to a torque, force control from there on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.design.force_loop import force_loop_response
from nrs_design.design.transfer import TransferFunction, poles
from nrs_design.reporting.document import Illustration
from nrs_design.reporting.figures.complex_plane import draw_root_locus
from nrs_design.reporting.figures.panels import Curve, Panel, PanelColumn, draw_panels
from nrs_design.reporting.simulation import four_digits_up
from nrs_design.simulation.metrics import overshoot, steady_state_error
from nrs_design.simulation.run import Run
from nrs_design.thesis import thesis
from nrs_design.thesis.gallery.counterpart import (
    Counterpart,
    Reproducibility,
    Statement,
    measured,
    stated,
    taken,
)
from nrs_design.thesis.gallery.panels import ENGINE, speed_panel, stays, torque_panel
from nrs_design.thesis.interaction import (
    BLEEDING,
    BY_THRESHOLD,
    INTEGRAL,
    POSITION,
    PROFILE,
    PROPORTIONAL,
    PROPORTIONAL_FROM_MEASURED,
    into,
    run_scenario,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

_GIVEN = (
    "motion loop of 4.29 and 4.30, k_soft 43.0356 N m/rad",
    "Kp 0.02 rad/(N m), F_d 0.3 N m; force control from 0.3 N m on, position control once the "
    "command points out (6.3.3)",
)
# Of the tissue in deg, and of the command in deg/s: the slower of 6.3.2.3's is 3, the faster 5.
_TISSUE, SPEED = 10, 5
# From the start of the command to force control in s, for the tissue and the speed above.
_ARRIVAL = 2.1
# Three controllers: what each is called, its entry, and what else the spec says.
CONTROLLERS = (
    ("P, X_i the reference", PROPORTIONAL, ""),
    ("P, X_i the position", PROPORTIONAL_FROM_MEASURED, ""),
    ("PI that bleeds", INTEGRAL, BLEEDING),
)


@dataclass(frozen=True, slots=True)
class ForceLimitExperiment:
    """One of the two experiments of 6.3.3.3."""

    # figure, axis: which.
    figure: str
    axis: str
    switches: tuple[str, str]  # When force control takes over, s, as printed
    turns: tuple[float, float]  # When the command of the run turns out of the tissue, s
    error: str  # Largest steady-state error in %, as printed


EXPERIMENTS = (
    ForceLimitExperiment("6.26", "phi", ("19", "52"), (30, 60), "2"),
    ForceLimitExperiment("6.27", "psi", ("14.5", "53.5"), (30, 62), "12"),
)


def counterparts() -> tuple[Counterpart, ...]:
    """Simulate the desired profile, the schemes, the locus and both experiments."""
    runs = {one.figure: [_pressed(one, *entry[1:]) for entry in CONTROLLERS] for one in EXPERIMENTS}
    return (
        _profile(),
        _schemes(runs["6.26"][0]),
        _locus(),
        *(_experiment(one, runs[one.figure]) for one in EXPERIMENTS),
    )


def _pressed(one: ForceLimitExperiment, force: str, more: str) -> Run:
    """Press twice, so that force control begins when the thesis says."""
    (first, second), (out, end) = map(float, one.switches), one.turns
    # What goes out goes in again: 10 deg at 5 deg/s.
    command = (
        (0, 0),
        (first - _ARRIVAL, 0),
        (first - _ARRIVAL, SPEED),
        (out, SPEED),
        (out, -SPEED),
        (out + 2, -SPEED),
        (out + 2, 0),
        (second - 2, 0),
        (second - 2, SPEED),
        (end, SPEED),
        (end, -SPEED),
        (end + 2, -SPEED),
    )
    scenario = into(_TISSUE, *((round(t, 6), v) for t, v in command), control=BY_THRESHOLD)
    return run_scenario({"position": POSITION, "force": force}, scenario, more)


def _selection(run: Run) -> Panel:
    response = run.response
    position = (response.mode == response.modes.index("position")).astype(float)
    return Panel("S", (Curve(response.t, position, "S", 3),), ticks=(0, 1))


def _profile() -> Counterpart:
    run = run_scenario(
        {"position": POSITION, "force": PROPORTIONAL}, into(8, *PROFILE, control=BY_THRESHOLD)
    )
    response, (switched, back) = run.response, [time for time, _ in run.switches]
    made, lost = (time for time, _, _ in run.contacts)
    held = (response.t >= switched) & (response.t < back)
    torque = response["torque"][held]
    panels = (speed_panel(response, "phi"), torque_panel(response), _selection(run))
    return Counterpart(
        shows={"6.22": "Desired torque under a hybrid controller; instants named, not timed"},
        section="6.3.3",
        title="desired torque, position and force control",
        statements=(
            stated(
                "order: contact t2, force control t_i, position control t4, contact lost t5",
                "t2 < t_i < t4 < t5",
                f"{made:.3f}, {switched:.3f}, {back:.3f}, {lost:.3f} s",
                made < switched < back < lost,
            ),
            stated(
                "torque from t_i to t4, N m",
                "kept at T_h, 0.3",
                f"peak {four_digits_up(float(torque.max()))}, at last {torque[-1]:.4g}",
                bool(torque.max() <= thesis.TORQUE),
                "a proportional gain overshoots at the switch, and with X_i the reference it keeps "
                "an error; figures 6.26 and 6.27 show the same of the robot",
            ),
        ),
        given=(*_GIVEN, "shape and largest speed, 8 deg/s, of the command of figure 6.7"),
        chosen=("the times of the command; tissue from 8 deg on; X_i the reference at the switch",),
        illustrations=(
            Illustration(
                "figure-6-22-record",
                "Counterpart of figure 6.22: command, torque and selection",
                "The command waits while force is controlled. From t4 on position control takes up "
                "where it waits, which is deeper: the torque first rises to "
                f"{four_digits_up(float(response['torque'].max()))} N m. {ENGINE}",
                draw_panels([PanelColumn("", panels, (1.0, 5.0), stays(run))]),
            ),
        ),
        runs={"figure-6-22": response},
    )


def _schemes(run: Run) -> Counterpart:
    response = run.response
    position = response.mode == response.modes.index("position")
    angles = Panel(
        "Angle [rad]",
        (
            Curve(response.t, response["commanded position"], "X_c, at the switch X_i", 1),
            Curve(response.t, response["angle"], "angle X", 0),
        ),
    )
    gain = float(thesis.FORCE_GAIN)
    force = np.where(position, 0.0, gain * (thesis.TORQUE - response["torque"]))
    inputs = Panel("u_f [rad]", (Curve(response.t, force, "u_f = Kp (1 - S)(F_d - F_m)", 4),))
    torque = torque_panel(response, "torque F_m", force=False)
    span = (18.5, 20.0)
    panels = (angles, inputs, torque, _selection(run))
    return Counterpart(
        shows={
            "6.23": "Scheme of hybrid position and force control; no record",
            "6.24": "The same as implemented, with X_i; no record",
        },
        section="6.3.3.1",
        title="signals of the schemes",
        statements=(
            stated(
                "S is 1 in position control, 0 from 0.3 N m on (6.30)",
                "so drawn",
                "in the run: " + ", ".join(f"{name} at {time:g} s" for time, name in run.switches),
                [name for _, name in run.switches] == ["force", "position"] * 2,
            ),
            Statement(
                "X_i of 6.41",
                "the initial condition when S switches",
                "the reference at the switch; in the middle of figure 6.26's second drawing "
                "the measured position",
                Reproducibility.OMITTED,
                "the thesis does not say of which signal: both readings are simulated",
            ),
        ),
        given=_GIVEN,
        chosen=(f"the command of figure 6.26, below; {SPEED} deg/s",),
        illustrations=(
            Illustration(
                "figure-6-24-record",
                "Counterpart of figures 6.23 and 6.24: every signal of the schemes about a switch",
                f"Of the run of figure 6.26. {ENGINE}",
                draw_panels([PanelColumn("", panels, span, stays(run))]),
            ),
        ),
    )


def _locus() -> Counterpart:
    loop, gain, stiffness = thesis.EXACT_LOOP, float(thesis.FORCE_GAIN), float(thesis.SOFT)
    opened = TransferFunction(tuple(stiffness * b for b in loop.numerator), loop.denominator)
    found = force_loop_response(loop, stiffness, gain)
    closed = TransferFunction(
        opened.numerator, tuple(np.polyadd(loop.denominator, gain * np.array(opened.numerator)))
    )
    # No measurement: the rows of 6.3.3.1 hold both against the standard of the table.
    wrong = Reproducibility.NOT_REPRODUCED
    why = "the print is wrong: its value holds for Kp towards 0, and so does not fix Kp"
    return Counterpart(
        shows={"6.25": "Root locus of the open force loop 6.33"},
        section="6.3.3.1",
        title="root locus of the force loop",
        statements=(
            measured("damping ratio at Kp 0.02", "0.707", found.damping_ratio, why, wrong),
            measured(
                "natural frequency there, rad/s",
                "40.2971",
                found.natural_frequency,
                why,
                wrong,
            ),
        ),
        given=("open loop 6.33 with the digits of 4.29 and 4.30, Kp 0.02 rad/(N m)",),
        illustrations=(
            Illustration(
                "figure-6-25-locus",
                "Counterpart of figure 6.25: root locus of the open force loop",
                "Diamonds: the poles at Kp 0.02. Computed, not simulated.",
                draw_root_locus(opened, gain, (), tuple(poles(closed).tolist())),
            ),
        ),
    )


def _experiment(one: ForceLimitExperiment, runs: Sequence[Run]) -> Counterpart:
    first, second = (time for time, name in runs[0].switches if name == "force")
    response, name = runs[0].response, f"figure-6-{one.figure[2:]}"
    panels = (speed_panel(response, one.axis), torque_panel(response), _selection(runs[0]))
    instants = tuple(map(float, one.switches))
    whole = PanelColumn("", panels, (0.0, float(response.t[-1])), stays(runs[0]), instants)
    close = [
        PanelColumn(
            label,
            (torque_panel(run.response, force=last), _selection(run)),
            (first - 0.15, first + 0.45),
            stays(run),
        )
        for (label, _, _), run, last in zip(CONTROLLERS, runs, (False, False, True), strict=True)
    ]
    return Counterpart(
        shows={one.figure: f"Selection S and torque, {one.axis}; the limit is met twice"},
        section="6.3.3.3",
        title=f"a limit on the torque, {one.axis}, without and with PI",
        statements=_statements(one, runs, first, second),
        given=(*_GIVEN, f"force control begins at {one.switches[0]} and {one.switches[1]} s"),
        chosen=(
            f"the speed, {SPEED} deg/s, and when the command turns; tissue from {_TISSUE} deg on",
            "of the PI, Ki 0.5 rad/(N m s), and the rate 20 1/s at which its integral bleeds",
        ),
        illustrations=(
            Illustration(
                f"{name}-record",
                f"Counterpart of figure {one.figure}: command, torque and selection",
                f"The P of the thesis, X_i the reference at the switch. {ENGINE}",
                draw_panels([whole]),
            ),
            Illustration(
                f"{name}-close",
                "About the first switch: P with either X_i, and a PI",
                "The third controller is not in the thesis, which leaves an integral out because "
                "stability under switching is not guaranteed with it; position control and this "
                "PI are certified for any switching (specs/neuroboscope/force-limit-pi.nrs.yaml).",
                draw_panels(close),
            ),
        ),
        runs={
            f"{name}-{suffix}": run.response
            for suffix, run in zip(("p", "p-measured-position", "pi"), runs, strict=True)
        },
    )


def _statements(
    one: ForceLimitExperiment, runs: Sequence[Run], first: float, second: float
) -> tuple[Statement, ...]:
    (peak, left), (other, none), (integral, nothing) = (_judged(run, one.turns[0]) for run in runs)
    speed = f"it grows with the speed, which is not printed; {SPEED} deg/s here"
    over = [
        stated(
            "overshoot at the switch",
            "observed" if one.axis == "phi" else "not observed",
            f"to {four_digits_up(peak)} N m",
            (peak > thesis.TORQUE) == (one.axis == "phi"),
            "both axes have one model, so they overshoot alike; with X_i the position to "
            f"{four_digits_up(other)} N m",
        )
    ]
    if one.axis == "phi":
        over.append(
            measured(
                "largest torque, N m",
                "0.35",
                float(four_digits_up(peak)),
                speed,
                Reproducibility.OMITTED,
            )
        )
    slow = float(one.error) / left * SPEED
    return (
        taken("force control begins, s", one.switches[0], first),
        taken("force control begins again, s", one.switches[1], second),
        *over,
        measured(
            "steady-state error of the P, % of 0.3 N m",
            one.error,
            left,
            f"{speed}. It would be {one.error} % at {slow:.2f} deg/s",
            Reproducibility.OMITTED,
        ),
        stated(
            "a P leaves an error",
            "expected: the loop is of type 0",
            f"{left:.4g} %; with X_i the position {none:.2g} %",
            left > 1,
        ),
        stated(
            "an integral would leave none, but its stability under switching is not guaranteed",
            "so said (6.3.3.1)",
            f"PI that bleeds: {nothing:.2g} % left, to {four_digits_up(integral)} N m; certified",
            holds=False,
            why="position control and a PI that bleeds have a common quadratic function: "
            "specs/neuroboscope/force-limit-pi.nrs.yaml",
        ),
    )


def _judged(run: Run, turn: float) -> tuple[float, float]:
    """Return the largest torque in N m and the steady error in % of the first stay under force."""
    response = run.response
    inside = (response.t >= run.switches[0][0]) & (response.t < turn)
    t, torque = response.t[inside], response["torque"][inside]
    peak = thesis.TORQUE * (1 + overshoot(torque, thesis.TORQUE))
    return peak, round(100 * steady_state_error(t, torque, thesis.TORQUE), 6)

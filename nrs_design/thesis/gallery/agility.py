"""Figures 6.16 to 6.21: out of tissue sooner, by switching to half of the impedance."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.reporting.document import Illustration
from nrs_design.reporting.figures.panels import Curve, Panel, PanelColumn, draw_panels
from nrs_design.reporting.simulation import four_digits_up
from nrs_design.simulation.metrics import gain_in_time, withdrawal_times
from nrs_design.simulation.run import Run
from nrs_design.thesis.experiments import GAINS, TIMES
from nrs_design.thesis.gallery.counterpart import (
    Counterpart,
    Reproducibility,
    Statement,
    measured,
    stated,
)
from nrs_design.thesis.gallery.panels import (
    ENGINE,
    FORCE,
    T_MAX,
    speed_panel,
    stays,
    torque_panel,
)
from nrs_design.thesis.interaction import (
    BY_SIGN,
    PROFILE,
    admittance,
    away,
    into,
    run_scenario,
    withdrawals,
)
from nrs_design.thesis.thesis import TORQUE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_GIVEN = (
    "motion loop of 4.29 and 4.30, k_soft 43.0356 N m/rad",
    "Mt 0.01 kg m^2; Bt 2.15 N m s/rad into tissue, 1.04 out of it (6.3.2.1)",
)
_LITTLE = (
    "Where the command itself falls to zero, the torque has all but followed it when the law "
    "switches: little is left to gain. The gain shows where the command is turned at once, figures "
    "6.18 to 6.21."
)
# Half of a unit of the last digit of a printed time, s.
_ROUNDING = 0.005


@dataclass(frozen=True, slots=True)
class Withdrawal:
    """One of the four experiments of 6.3.2.3; its times and gain are in `experiments`."""

    # figure, axis: which.
    figure: str
    axis: str
    speed: int  # On the way out, deg/s
    printed_speed: str  # The same in rad/s, as printed
    remark: str = ""  # On the print


_SLIP = "The text of this experiment has phi where the caption, and the axis that moves, say psi."
EXPERIMENTS = (
    Withdrawal("6.18", "phi", 5, "0.0873"),
    Withdrawal("6.19", "phi", 3, "0.0524"),
    Withdrawal("6.20", "psi", 5, "0.0873", _SLIP),
    Withdrawal("6.21", "psi", 3, "0.0524", _SLIP),
)


def counterparts() -> tuple[Counterpart, ...]:
    """Simulate the desired profile, the scheme, and the four experiments."""
    pairs = {speed: withdrawals(speed) for speed in (5, 3)}
    return (
        _profile(),
        _scheme(pairs[5][1]),
        *(
            _withdrawal(one, pairs[one.speed], times, gain)
            for one, times, gain in zip(EXPERIMENTS, TIMES, GAINS, strict=True)
        ),
    )


def _profile() -> Counterpart:
    both = {"insertion": admittance("0.01", "2.15"), "withdrawal": admittance("0.01", "1.04")}
    without, switched = (
        run_scenario(both, into(8, *PROFILE, control=control))
        for control in ("{fixed: insertion}", BY_SIGN)
    )
    later, sooner = (run.contacts[1][0] for run in (without, switched))
    return Counterpart(
        shows={"6.16": "Desired torque with one impedance and with two; instants named, not timed"},
        section="6.3.2",
        title="desired torque, one impedance and two",
        statements=(
            stated(
                "end of contact t4 with switching",
                "sooner",
                f"{sooner:.4f} s after {later:.4f} s without",
                sooner < later,
            ),
            stated(
                "torque up to its peak",
                "the same",
                f"{four_digits_up(_largest(switched))} N m in both",
                math.isclose(_largest(without), _largest(switched), rel_tol=1e-9),
            ),
            stated(
                "peak torque",
                "does not exceed T_max, 0.3 N m",
                f"{four_digits_up(_largest(switched))} N m",
                _largest(switched) < TORQUE,
            ),
        ),
        given=(*_GIVEN, "shape and largest speed, 8 deg/s, of the command of figure 6.7"),
        chosen=("the times of the command; tissue from 8 deg on",),
        illustrations=_profile_figures(without, switched),
        runs={
            "figure-6-16-one-impedance": without.response,
            "figure-6-16-two-impedances": switched.response,
        },
    )


def _profile_figures(without: Run, switched: Run) -> tuple[Illustration, Illustration]:
    labels = ("one impedance (solid)", "two (dashed in print)")
    torque = Panel(
        "Torque [N m]",
        tuple(
            Curve(run.response.t, run.response["torque"], label, look)
            for look, (run, label) in enumerate(zip((without, switched), labels, strict=True))
        ),
        (TORQUE,),
        T_MAX,
        other=FORCE,
    )
    speed = speed_panel(switched.response, "phi", of_the_axis=False)
    whole = PanelColumn("", (speed, torque), (1.5, 4.3), stays(switched))
    close = PanelColumn("", (speed, replace(torque, limits=())), (3.97, 4.06), stays(switched))
    return (
        Illustration(
            "figure-6-16-record",
            "Counterpart of figure 6.16: torque with one impedance and with two",
            f"{_LITTLE} {ENGINE}",
            draw_panels([whole]),
        ),
        Illustration(
            "figure-6-16-close",
            "The same, where contact ends",
            "The solid line is still on its way to zero when the dashed one is there.",
            draw_panels([close]),
        ),
    )


def _scheme(run: Run) -> Counterpart:
    return Counterpart(
        shows={"6.17": "Scheme of the impedance controller with two admittances; no record"},
        section="6.3.2.1",
        title="signals of the scheme",
        statements=(
            stated(
                "s1 is closed in contact; Y1 acts into tissue, Y2 out of it",
                "so drawn",
                "in the run: "
                + ", ".join(f"{name} at {time:.3f} s" for time, name in run.switches),
                [name for _, name in run.switches][:1] == ["withdrawal"] and len(run.contacts) == 2,
            ),
        ),
        given=_GIVEN,
        chosen=("the command of figure 6.18, below",),
        illustrations=(
            Illustration(
                "figure-6-17-record",
                "Counterpart of figure 6.17: every signal of the scheme in one run",
                "Into tissue at 8 deg/s, out at 5 deg/s from 1 s on. The robot follows the command "
                "less what the admittance makes of the torque. Met at 8 deg/s, the tissue "
                f"pushes with up to {four_digits_up(_largest(run))} N m at first, more than T_max. "
                f"{ENGINE}",
                draw_panels([_signals(run)]),
            ),
        ),
    )


def _signals(run: Run) -> PanelColumn:
    response = run.response
    contact = (response["torque"] != 0).astype(float)
    first = (response.mode == response.modes.index("insertion")).astype(float)
    velocities = Panel(
        "Speed [rad/s]",
        (
            Curve(response.t, response["hand"], "command dX_c", 1),
            Curve(response.t, response["vm"], "admittance dX_m", 2),
            Curve(response.t, response["velocity"], "robot dX", 0),
        ),
    )
    switches = Panel(
        "Switches",
        (
            Curve(response.t, contact, "s1: 1 in contact", 3),
            Curve(response.t, first, "s2: 1 Y1, 0 Y2", 4),
        ),
        ticks=(0, 1),
    )
    return PanelColumn("", (velocities, torque_panel(response), switches), (0.0, 1.3), stays(run))


def _withdrawal(
    one: Withdrawal, runs: tuple[Run, Run], printed: tuple[float, float], gain: str
) -> Counterpart:
    without, switched = map(_time, runs)
    why = (
        f"at this speed 0.3 N m of k_soft are {away(one.speed):.2f} s away with no compliance at "
        "all: what took longer on the robot is not in k_soft; 6.2 speaks of joint clearance"
    )
    name = f"figure-6-{one.figure[2:]}"
    return Counterpart(
        shows={
            one.figure: "Torque without (left) and with switching (right), out at "
            f"{one.printed_speed} rad/s in {one.axis}"
        },
        section="6.3.2.3",
        title=f"out of tissue at {one.printed_speed} rad/s, {one.axis}",
        statements=(
            stated(
                "out of tissue with switching",
                "sooner",
                f"after {switched:.4f} s, without after {without:.4f} s",
                switched < without,
            ),
            measured("time without switching, s", f"{printed[0]:.2f}", without, why),
            measured("time with switching, s", f"{printed[1]:.2f}", switched, why),
            _gain(gain, printed, 100 * gain_in_time(without, switched)),
        ),
        given=(
            *_GIVEN,
            f"{one.printed_speed} rad/s out of the tissue; before, the largest torque",
        ),
        chosen=(
            "into the tissue at 8 deg/s, the largest command, until the torque rests; out from 1 s",
        ),
        illustrations=(
            Illustration(
                f"{name}-record",
                f"Counterpart of figure {one.figure}: torque without and with switching",
                "Both axes have the same model, as 6.3.2.2 assumes. The time counts from the turn "
                f"of the command, at 1 s, to the loss of contact. {ENGINE}",
                _draw_pair(one, runs),
            ),
        ),
        remark=one.remark,
        runs={
            f"withdrawal-{one.speed}-deg-s-without": runs[0].response,
            f"withdrawal-{one.speed}-deg-s-with": runs[1].response,
        },
    )


def _draw_pair(one: Withdrawal, runs: tuple[Run, Run]) -> Figure:
    titles = ("without switching", "with switching")
    return draw_panels(
        [
            PanelColumn(
                title,
                (
                    speed_panel(run.response, one.axis, of_the_axis=False),
                    torque_panel(run.response),
                ),
                (0.95, 1.1),
                stays(run),
            )
            for title, run in zip(titles, runs, strict=True)
        ]
    )


def _gain(printed: str, times: tuple[float, float], found: float) -> Statement:
    """Hold the gain against those that the printed times allow, which are rounded to 0.01 s."""
    slow, fast = times
    low = 100 * gain_in_time(slow - _ROUNDING, fast + _ROUNDING)
    high = 100 * gain_in_time(slow + _ROUNDING, fast - _ROUNDING)
    allowed = f"what the printed times, rounded to 0.01 s, allow: {low:.1f} to {high:.1f} %"
    if low <= found <= high:
        outcome, why = Reproducibility.REPRODUCED, f"within {allowed}"
    else:
        apart = max(low - found, found - high)
        outcome, why = Reproducibility.NOT_REPRODUCED, f"{apart:.1f} points outside of {allowed}"
    return Statement("gain in time, %", printed, f"{found:.4g}", outcome, why)


def _time(run: Run) -> float:
    response = run.response
    (time,) = withdrawal_times(response.t, response["hand"], response["torque"])
    return time


def _largest(run: Run) -> float:
    return float(np.abs(run.response["torque"]).max())

"""The mode logic: which controller is active when, and how far apart switches lie."""

from __future__ import annotations

from fractions import Fraction

from nrs_design.proof.bounds import lower, upper
from nrs_design.reporting.document import Paragraph, Section, Table
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.threshold_logic import ThresholdLogicSpec, values_at_switch

_CHATTER_FREE = (
    "No chatter: between two switches a signal that is known up to a noise N, as old as an age D "
    "and no faster than a rate R has to cross a band between two thresholds, which takes at least "
    "(band - 2 N)/R - D. The timer holds every controller that long (rounded down), or as long as "
    "the hold in the spec says, whatever the signals do.",
    "A switch is made when all of its conditions hold. The true signal has then gone no further "
    "than listed, if its own condition is the last one to come true.",
)
_UNITS = {"command": "rad/s", "torque": "N·m"}


def logic_section(spec: InteractionDesignSpec) -> Section | None:
    """Describe the mode logic of a spec, if it has one."""
    if spec.mode_logic is None:
        return None
    return Section("Mode logic", (*map(Paragraph, logic_meaning(spec)), *logic_tables(spec)))


def logic_meaning(spec: InteractionDesignSpec) -> tuple[str, ...]:
    """Return sentences on the numbers of a mode logic, and on their role in the proof."""
    last = "The statement about stability is for the switching that this logic can give."
    if spec.switching.is_arbitrary:
        last = "The statement about stability needs none of this: switching is arbitrary."
    return (*_CHATTER_FREE, last)


def logic_tables(spec: InteractionDesignSpec) -> tuple[Table, ...]:
    """Return what a mode logic does, in tables of text."""
    assert spec.mode_logic is not None
    return _switches(spec.mode_logic), _stays(spec.mode_logic)


def _switches(logic: ThresholdLogicSpec) -> Table:
    rows = []
    for number, switch in enumerate(logic.switches, 1):
        ends, conditions, signal_bounds = values_at_switch(logic, switch), list[str](), list[str]()
        for name, condition in switch.conditions.items():
            threshold = Fraction(ends[name])
            if condition.above is not None:
                conditions.append(f"{name} above {condition.above.text}")
                signal_bounds.append(f"{name} ≤ {upper(threshold)} {_UNITS[name]}")
            elif condition.below is not None:
                conditions.append(f"{name} below {condition.below.text}")
                signal_bounds.append(f"{name} ≥ {lower(threshold)} {_UNITS[name]}")
        leads = f"{number}: {switch.source} to {switch.target}"
        rows.append((leads, " and ".join(conditions), ", ".join(signal_bounds)))
    columns = ("Switch", "When", "True signal then, at worst")
    return Table("Switches, in the order in which they are tried", columns, tuple(rows))


def _stays(logic: ThresholdLogicSpec) -> Table:
    rows = []
    for name in logic.controllers:
        stay, derived, separation = logic.stay(name), logic.derived(name), logic.tightest(name)
        moves = "–"
        if separation is not None and separation.signal is not None:
            switches = f"from switch {separation.entering + 1} to {separation.leaving + 1}"
            moves = f"{separation.signal}, {switches}"
        texts = ("–" if time is None else time.text for time in (stay, derived))
        rows.append((name, *texts, moves, f"{upper(logic.held_back(name))} s"))
    columns = (
        "Controller",
        "Held for",
        "By thresholds",
        "Has to move",
        "Switch held back, at most",
    )
    return Table("How long every controller stays active", columns, tuple(rows))


def logic_summary(spec: InteractionDesignSpec) -> dict[str, object]:
    """Return the numbers of a mode logic in SI units, each rounded to its safe side."""
    assert spec.mode_logic is not None
    logic = spec.mode_logic
    return {
        "type": logic.type,
        "used_in_proof": not spec.switching.is_arbitrary,
        "controllers": [_controller_summary(logic, name) for name in logic.controllers],
        "switches": [
            {
                "from": switch.source,
                "to": switch.target,
                "reach": dict(values_at_switch(logic, switch)),
            }
            for switch in logic.switches
        ],
        "units": {"stay": "s", "command": "rad/s", "torque": "N*m"},
    }


def _controller_summary(logic: ThresholdLogicSpec, name: str) -> dict[str, object]:
    stay, derived = logic.stay(name), logic.derived(name)
    return {
        "name": name,
        "stay": None if stay is None else float(stay.value),
        "stay_by_thresholds": None if derived is None else float(derived.value),
        "held_back_at_most": float(logic.held_back(name)),
        "pairs": [
            {
                "entering": separation.entering + 1,
                "leaving": separation.leaving + 1,
                "signal": separation.signal,
                "at_least": float(lower(separation.seconds)),
            }
            for separation in logic.pairs(name)
        ],
    }

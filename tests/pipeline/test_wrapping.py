"""How often a stiffness is wrapped anew between the text of a spec and the matrices of a proof."""

import re
import sys
from fractions import Fraction

from nrs_design.design.design import design_controllers
from nrs_design.spec import parse_spec
from nrs_design.spec.build_plant import build_plant
from nrs_design.spec.quantity import Quantity
from nrs_design.switched.assemble import assemble
from tests.support import SOFT_TISSUE

STIFFNESS = Fraction("53.719")
TEXT, FOUND = re.subn(
    r" stiffness: \{.*\}\n.*lever_arm:.*\n",
    " stiffness: 53.719 N*m/rad\n",
    SOFT_TISSUE.read_text("utf-8"),
)


def flat(values):
    for value in values:
        if isinstance(value, tuple | list):
            yield from flat(value)
        else:
            yield value


def fields_of(thing):
    slots = [n for kind in type(thing).__mro__ for n in kind.__dict__.get("__slots__", ())]
    own = [getattr(thing, name, None) for name in slots if name.isidentifier()]
    return flat([*own, *getattr(thing, "__dict__", {}).values()])


def holds_it(thing):
    values = (v.value if isinstance(v, Quantity) else v for v in fields_of(thing))
    return any(isinstance(value, Fraction) and value == STIFFNESS for value in values)


def classes_that_hold_it(run):
    """Classes of ours that have the number in a field, of all that functions have at hand."""
    found = set()

    def look(frame, event, argument):
        if event != "return":
            return
        for thing in flat(frame.f_locals.values()):
            kind = type(thing)
            if kind.__module__.startswith("nrs_design.") and kind not in found and holds_it(thing):
                found.add(kind)

    before = sys.getprofile()
    sys.setprofile(look)
    try:
        run()
    finally:
        sys.setprofile(before)
    return {kind.__name__ for kind in found}


def test_a_stiffness_is_held_five_times_from_text_to_matrix():
    """Four classes hold it, and between the last two it is the value of a corner, a bare number."""
    assert FOUND == 1
    spec = parse_spec(TEXT)
    plant = build_plant(spec)
    design = design_controllers(spec, plant)

    def all_the_way():
        again = parse_spec(TEXT)
        assemble(again, build_plant(again), design)

    wrappers = classes_that_hold_it(all_the_way)
    assert wrappers == {"Quantity", "RangedQuantity", "Interval", "Elastic"}

"""A spec with gains that were chosen, written into it as given ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.controllers.laws import LAWS
from nrs_design.proof.text import exact_text
from nrs_design.spec import LoadedSpec
from nrs_design.spec.document import parse_document
from nrs_design.spec.interaction_parts import MOTION
from nrs_design.spec.load import respecified
from nrs_design.spec.spec_document import SpecDocument

if TYPE_CHECKING:
    from nrs_design.pipeline.design import Designed

# What ships of every gain that was chosen, with its unit, by controller and name.
Written = Mapping[tuple[str, str], str]


def with_gains(
    designed: Designed,
    written: Written,
    change: Callable[[SpecDocument], None] = lambda document: None,
) -> LoadedSpec:
    """Return the spec with gains given, and its text.

    A `SpecError` if that is no valid spec, or a comment would be lost.
    """
    motion = {gain: text for (name, gain), text in written.items() if name == MOTION}
    free = designed.spec.design.free

    def give(document: SpecDocument) -> None:
        if motion:
            _put_motion(document, designed, motion)
        for (name, gain), text in written.items():
            if name != MOTION:
                _put(document, designed, name, gain, text)
        # Factors on gains that are not the same any more.
        if any(gain in dict(free[name].given()) for name, gain in written if name in free):
            document.drop(document.root["design"], "free")
            if not document.root["design"]:
                document.drop(document.root, "design")
        change(document)

    document = SpecDocument(designed.loaded)
    give(document)
    text = document.text()
    loaded = respecified(designed.loaded, parse_document(text, designed.loaded.path))
    return replace(loaded, text=text)


def _put(document: SpecDocument, designed: Designed, name: str, gain: str, text: str) -> None:
    """Give a gain of a controller, in the place of what it was chosen by."""
    spec, node = designed.spec.controllers[name], document.root["controllers"][name]
    document.put(node, LAWS[spec.type].fixed.get(gain, gain), text)
    if (replaced := spec.freeable.get(gain)) is not None:
        document.drop(node, replaced)


def _put_motion(document: SpecDocument, designed: Designed, motion: Mapping[str, str]) -> None:
    """Give the gains of the motion loop, as it is told: Kd, and the zero Kp/Kd."""
    own, unit = designed.design.motion, designed.design.units[MOTION]["Kd"]
    node = document.root["motion_loop"]
    Kp, Kd = (
        Fraction(motion[gain].split()[0]) if gain in motion else value
        for gain, value in (("Kp", own.Kp), ("Kd", own.Kd))
    )
    document.put(node, "derivative_gain", f"{exact_text(Kd)} {unit}")
    document.put(node, "zero", f"{exact_text(Kp / Kd)} 1/s")

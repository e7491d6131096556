"""Runs of an exported law, compiled together with its exported monitor: what is told, and when."""

import subprocess
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from nrs_design.controllers.sector import sector_of
from nrs_design.exporters.formats.c import header_text as law_header
from nrs_design.exporters.formats.c import source_text as law_source
from nrs_design.exporters.formats.monitor import header_text, source_text
from nrs_design.exporters.monitor_limits import monitor_limits
from nrs_design.exporters.program import Program
from nrs_design.exporters.text import CNames
from nrs_design.spec import parse_spec
from tests.exporters.programs import LAWS, built, compiler
from tests.support import SOFT_TISSUE

LAW = LAWS["inertia"]
STUDY = Path(__file__).with_suffix(".c")
# The bounds of the study; the limit of the torque is beyond whatever a run meets.
MONITORED = """
contact: {contact}
monitoring:
  torque_noise: {torque_noise}
  angle_noise: 0.00439453125 deg
  surface: {surface}
"""
SAMPLING = "sampling: {period: 2 ms, delay: [0, 1]}\n"
TEXT = SOFT_TISSUE.read_text().replace("torque: 0.3 N*m", "torque: 30 N*m")
VISCOUS = "    model: kelvin-voigt\n    damping: {nominal: 0.1 N*s/m, range: [0 N*s/m, 0.2 N*s/m]}"


def monitored(
    surface="fixed", torque_noise="2 N*mm", contact="losable", more="", text=TEXT + SAMPLING
):
    said = MONITORED.format(surface=surface, torque_noise=torque_noise, contact=contact)
    return parse_spec(text + said + more)


def sources(export, spec):
    program = Program(export.record, LAW, CNames("x"))
    limits = monitor_limits(replace(export, spec=spec), LAW)
    return {
        "x.h": law_header(program),
        "x.c": law_source(program),
        "x_monitor.h": header_text(program, limits),
        "x_monitor.c": source_text(program, limits),
    }


def study(folder, export, spec, *, damping=0.0):
    """Compile runs of a spec and return what draws them."""
    sector = sector_of(spec)
    said = spec.monitoring
    given = {
        "LOW": float(sector.low),
        "HIGH": float(sector.high),
        "TORQUE_NOISE": said.torque_noise.si,
        "ANGLE_NOISE": said.angle_noise.si,
        "MOVES": ["fixed", "free", "touched"].index(said.surface),
        "KEPT": int(sector.contact_maintained),
        "DRIFT": float(sector.surface_speed),
        "SPEED": 1.0 if sector.speed is None else float(sector.speed),
        "SKEW": 0.0 if said.skew is None else said.skew.si,
        "DAMPING": damping,
    }
    for name, text in sources(export, spec).items():
        (folder / name).write_text(text)
    flags = [f"-D{name}={value!r}" for name, value in given.items()]
    files = (folder / "x.c", folder / "x_monitor.c", STUDY)
    strict = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-O2", "-ffp-contract=off")
    built(compiler("cc"), *strict, *flags, "-I", folder, *files, "-lm", "-o", folder / "study")

    def drawn(runs, seed, *violation):
        command = [str(folder / "study"), str(runs), str(seed), *map(repr, violation)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        rows = [line.split(",") for line in done.stdout.splitlines()]
        return {name: [int(number) for number in numbers] for name, *numbers in rows}

    return drawn


def need_of(spec, factor):
    """Return the torque from which a violation is found, and what a travel of 1 rad adds."""
    sector, factor = sector_of(spec), Fraction(str(factor))
    # What single precision costs up to half a turn is in the header; twice that here.
    rounding = Fraction(1, 10**5)
    first = sector.need(factor, Fraction(0), rounding)
    return float(first), float(sector.need(factor, Fraction(1), rounding) - first)

"""Monitors of running loops, compiled and fed sample by sample."""

import ctypes
import re
from functools import cache

from nrs_design.exporters.formats.fmu import shared_library
from nrs_design.spec import parse_spec
from tests.exporters.programs import compiler
from tests.support import SOFT_TISSUE

TEXT = SOFT_TISSUE.read_text().replace("bandwidth: 2 Hz", "bandwidth: 2 Hz\n  command: 3000 rpm")


def spec_with(rules="arbitrary", text=TEXT):
    """The nominal tissue where there are rules: a dwell time and a range exclude each other."""
    if rules != "arbitrary":
        text = text.replace("switching: arbitrary", f"switching: {rules}")
        text = text.replace("{nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}", "747 N/m")
    return parse_spec(text)


class Input(ctypes.Structure):
    _fields_ = [
        *(("mode", ctypes.c_uint32), ("step", ctypes.c_float), ("age", ctypes.c_uint32)),
        *((name, ctypes.c_float) for name in ("angle", "torque", "command")),
    ]


@cache
def compiled(sources):
    """Compile names and texts of files; most monitors differ in what they watch only."""
    seen = "#pragma GCC visibility push(default)\n"
    return shared_library(compiler("cc"), {name: seen + text for name, text in sources})


class Monitor:
    """A compiled monitor; what it tells is called as its header calls it."""

    reads = Input

    def __init__(self, folder, sources):
        # One that is loaded must not be written over.
        file = folder / f"monitor-{len([*folder.iterdir()])}.so"
        file.write_bytes(compiled(tuple(sources.items())))
        library = ctypes.CDLL(str(file))
        told = re.findall(r"#define (\w+)_LEFT_(\w+) (\d+)U", "".join(sources.values()))
        self.kinds = {int(number): kind for _, kind, number in told}
        name = f"{told[0][0].lower()}_monitor"
        self._init, self._step = (getattr(library, f"{name}_{end}") for end in ("init", "step"))
        self._init.argtypes = [ctypes.c_void_p, ctypes.c_float]
        self._step.restype = ctypes.c_uint32
        # More than it needs.
        self.memory = (ctypes.c_uint32 * 64)()
        self.begin()

    def begin(self):
        self._init(self.memory, 1e-4)

    def step(self, **given):
        usual = {"mode": 0, "step": 0.002, "age": 0, "angle": 0.0, "torque": 0.0, "command": 0.0}
        return self.kinds[self._step(ctypes.byref(self.reads(**(usual | given))), self.memory)]

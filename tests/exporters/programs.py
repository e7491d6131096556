"""Laws of every shape, and the compilers that make programs of them."""

import subprocess
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from nrs_design.controllers.float32 import round_float32
from nrs_design.controllers.laws import (
    Admittance,
    IntegralForce,
    PositionControl,
    ProportionalDerivative,
    ProportionalForce,
)
from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.sensor import LowPass
from nrs_design.controllers.step_law import StepFrame, StepLimits, build_law
from nrs_design.exporters import rendered
from nrs_design.exporters.export import Export
from nrs_design.exporters.formats.c import header_text, source_text
from nrs_design.exporters.program import Program
from nrs_design.exporters.self_test import program_macro, self_test
from nrs_design.exporters.text import CNames
from nrs_design.models.drive import CommandInterface
from tests.support import program_named

PERIOD = Fraction(1, 500)
MOTION = ProportionalDerivative(round_float32(Fraction("117359.43")), Fraction(2060))
M4F = Path(__file__).parent / "board"
STRICT = (
    "-std=c99",
    *("-Wall", "-Wextra", "-Werror", "-pedantic", "-Wconversion", "-Wdouble-promotion"),
    *("-Wfloat-equal", "-Wshadow", "-ffp-contract=off"),
)
CORTEX = ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard")
MACHINE = ("-M", "netduinoplus2", "-nographic", "-monitor", "none", "-serial", "none")
SEMIHOSTING = ("-semihosting-config", "enable=on,target=native")


def source_file(name: str) -> str:
    """Read a program that is compiled or run together with what is exported."""
    return (Path(__file__).parent / "sources" / name).read_text(encoding="utf-8")


def frame(low_pass=None, limits=None, takes=None) -> StepFrame:
    return StepFrame(
        MOTION.Kp, MOTION.difference_gain(PERIOD), low_pass, limits or StepLimits(), takes
    )


def law(*, Mt="0.01", Kt=("0", "0"), order=0, method="exact", limits=None, takes=None) -> StepLaw:
    """Build two admittances of the thesis robot above its motion controller."""
    laws = {
        name: Admittance(*(round_float32(Fraction(gain)) for gain in (Mt, Bt, spring))).discretize(
            PERIOD, method
        )
        for (name, Bt), spring in zip(
            (("insertion", "2.15"), ("withdrawal", "1.04")), Kt, strict=True
        )
    }
    low_pass = LowPass(order, Fraction(200)).discretize(PERIOD) if order else None
    return build_law(frame(low_pass, limits, takes), laws)


PLACED = {
    "position": PositionControl(),
    "force": ProportionalForce(round_float32(Fraction("0.02"))),
}
ADMITTANCE = Admittance(round_float32(Fraction("0.01")), round_float32(Fraction("2.15")))
INTEGRAL = IntegralForce(round_float32(Fraction("0.02")), Fraction(1, 2))
LAG = LowPass(1, Fraction(200)).discretize(PERIOD)


def mixture(low_pass=None, limits=None, takes=None, **others) -> StepLaw:
    """Build controllers of position and force with others beside them."""
    laws = {name: one.discretize(PERIOD, "exact") for name, one in {**PLACED, **others}.items()}
    idle = (round_float32(Fraction("0.96")),) if others else ()
    return build_law(frame(low_pass, limits, takes), laws, *idle)


SPRUNG = replace(ADMITTANCE, Kt=Fraction(1, 2))
CLAMPED = StepLimits(Fraction(3), command=Fraction(4000), integral=Fraction(1, 128))
LAWS = {
    "force and position": mixture(LAG),
    "inertia": law(),
    "static": law(Mt="0"),
    "filter and spring": law(order=2, Kt=("0.5", "0")),
    "static, filter, spring": law(Mt="0", order=1, Kt=("0.5", "3"), method="euler"),
    "mixed": mixture(insertion=ADMITTANCE),
    "integral": mixture(insertion=ADMITTANCE, hold=INTEGRAL),
    "clamped": mixture(limits=CLAMPED, hold=INTEGRAL),
    "mixed, spring": mixture(LAG, insertion=SPRUNG),
    "positions": mixture(takes=CommandInterface.POSITION),
    "positions, mixed": mixture(takes=CommandInterface.POSITION, insertion=SPRUNG),
    "velocities, spring": law(Kt=("0.5", "0"), order=1, takes=CommandInterface.VELOCITY),
    "limits": law(
        limits=StepLimits(Fraction(1, 2), round_float32(Fraction("0.13")), Fraction(4000))
    ),
}


def write_formats(folder: Path, export: Export, formats: Iterable[str]) -> Path:
    for name in formats:
        for ending, content in rendered(name, export).items():
            (folder / f"{export.record.spec.name}{ending}").write_bytes(content)
    return folder


def write_law(folder: Path, record, law: StepLaw, cases) -> tuple[Path, Path, str]:
    """Write a law and its self-test; both sources come back, and the flag that brings a `main`."""
    names = CNames(record.spec.name)
    program = Program(record, law, names)
    texts = self_test(law, cases, names, program.description)
    texts |= {".h": header_text(program).encode(), ".c": source_text(program).encode()}
    for ending, content in texts.items():
        (folder / f"{names.spec}{ending}").write_bytes(content)
    source, test = (folder / f"{names.spec}{ending}" for ending in (".c", "_test.c"))
    return source, test, f"-D{program_macro(names)}"


def compiler(name="gcc"):
    return program_named(name)


def run(*command: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*map(str, command)], capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL
    )


def built(*command: str | Path) -> None:
    done = run(*command)
    assert (done.returncode, done.stderr) == (0, "")


def check_that_it_calls_nothing(folder: Path, source: Path, names: list[str]) -> None:
    """No heap, no libm, and on the processor no arithmetic of doubles by library."""
    for gcc, nm, flags in (("gcc", "nm", ()), ("arm-none-eabi-gcc", "arm-none-eabi-nm", CORTEX)):
        built(compiler(gcc), *flags, *STRICT, "-O2", "-c", source, "-o", folder / "o")
        symbols = run(compiler(nm), "-g", folder / "o").stdout.splitlines()
        assert [line.split()[-2:] for line in symbols if line] == [["T", name] for name in names]


def emulated(folder: Path, law: Path, *others: str | Path, counted: bool = False) -> str:
    """Compile a law as for the robot, and return what its program says on an emulated STM32F405.

    Where it is `counted`, the clock of the emulator advances by 256 ns with each instruction.
    """
    gcc, emulator = compiler("arm-none-eabi-gcc"), compiler("qemu-system-arm")
    compiled, program = folder / "compiled.o", folder / "program.elf"
    built(gcc, *CORTEX, *STRICT, "-O2", "-c", law, "-o", compiled)
    start = (M4F / "startup.c", "-T", M4F / "memory.ld", "--specs=nosys.specs", "-nostartfiles")
    flags = (*CORTEX, "-O2", "-std=c99", "-ffp-contract=off")
    linked = run(gcc, *flags, compiled, *others, *start, "-lm", "-o", program)
    assert linked.returncode == 0, linked.stderr
    clock = ("-icount", "shift=8,align=off,sleep=off") if counted else ()
    done = run(emulator, *MACHINE, *clock, *SEMIHOSTING, "-kernel", program)
    # The emulator prints what the program says beside its own messages; its exit code stands first.
    return f"{done.returncode}: {done.stderr}"


def check_with_misra(source: Path) -> None:
    """Let cppcheck look for MISRA C, but for macros that are the caller's (rule 2.5)."""
    limits = ("RADIX=2", "MANT_DIG=24", "MAX_EXP=128", "EVAL_METHOD=0")
    suppressed = ("missingIncludeSystem", "unusedFunction", "misra-c2012-2.5")
    suppressed += ("unmatchedSuppression",)
    done = run(
        compiler("cppcheck"),
        *("--enable=all", "--addon=misra", "--std=c99", "--quiet", "--error-exitcode=1"),
        *(f"-DFLT_{limit}" for limit in limits),
        *(f"--suppress={name}" for name in suppressed),
        source,
    )
    assert (done.returncode, done.stderr) == (0, "")

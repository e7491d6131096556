"""What a program limits: signals that are cut off, and a reference that a safety layer moves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from nrs_design.proof.matrix import RationalMatrix

# There are two to this power of matrices for each mode.
MOST_SIGNALS = 4
Range = tuple[Fraction, Fraction]
ZERO, ONE = Fraction(0), Fraction(1)
# What single precision changes: more than the three roundings of a command, over its terms; more
# than those of angles, over the largest one.
OF_TERMS, OF_ANGLES = Fraction(1, 2**22), Fraction(1, 2**22)


@dataclass(frozen=True, slots=True, kw_only=True)
class CutOff:
    """A signal ``s`` that saturates: ``s = min(max(a, -limit), limit)``.

    Its argument is ``a = q (x, s_1, ..., s_j)``, where the s_i are the signals before it.
    """

    # What it is, such as ``velocity command`` in ``rad/s``.
    name: str
    unit: str
    limit: Fraction  # Where it is cut off, both ways
    # Shape (n, 1). What it does to the state, in every mode and after them in the free modes.
    columns: tuple[RationalMatrix, ...]
    # Shape (1, n + number of signals before it). The q in the same order; in free motion nothing in
    # them stands for the deflection.
    rows: tuple[RationalMatrix, ...]
    # Shape (1, roundings of the system). What these add to its argument, in the same order; none
    # where nothing is said of that.
    errors: tuple[RationalMatrix, ...] = ()
    # Shape (1, couplings of the system). What it adds to the row of each of them, likewise.
    pushes: tuple[RationalMatrix, ...] = ()


@dataclass(frozen=True, slots=True)
class Start:
    """States that a motion begins in: a size times any mixture of some of them."""

    # What the size is of, such as ``contact force`` in ``N*m``.
    name: str
    unit: str
    # Shape (n, 1). At the size one, at the corners of the ranges.
    states: tuple[RationalMatrix, ...]
    # The size that a statement is meant to reach; for words and searches only.
    wanted: Fraction | None = None
    # What of such a state is neither at rest nor zero, in words that begin with a comma.
    beside: str = ""


@dataclass(frozen=True, slots=True)
class Saturation:
    """What saturates in a loop, and how motions begin that a statement about it names.

    The modes say what the loop does while nothing is cut off. Beyond that it is
    ``x' = A x + sum c_i (s_i - l_i x)``, where ``l_i x`` is what ``s_i`` were if nothing was; in
    discrete time ``x+`` is that.
    """

    signals: tuple[CutOff, ...]  # Each may depend on those before it
    start: Start  # How motions begin

    def between(
        self, A: RationalMatrix, k: int, held: Sequence[Sequence[Fraction]]
    ) -> Iterator[RationalMatrix]:
        """Yield the matrices between which the loop is while every ``|h x|`` is within its limit.

        The signal is then a mixture of its argument and of ``h x``, since it is the argument cut
        off at a limit that ``h x`` keeps.

        Parameters
        ----------
        A : RationalMatrix, shape (n, n)
            The k-th mode, of those in contact and after them those that are free.
        k : int
            Which.
        held : sequence of rows, each of n numbers
            The h of every signal.
        """
        for changes in self.changes(k, held, 0):
            moved = [list(row) for row in A.fractions()]
            for signal, change in zip(self.signals, changes, strict=True):
                for row, (c,) in zip(moved, signal.columns[k].fractions(), strict=True):
                    row[:] = [own + c * more for own, more in zip(row, change, strict=True)]
            yield RationalMatrix.from_rows(moved)

    def changes(
        self, k: int, held: Sequence[Sequence[Fraction]], errors: int
    ) -> Iterator[list[list[Fraction]]]:
        """Yield by how much the signals differ from what they are while nothing is cut off.

        Between these the loop is, as `between` says; each is a row for every signal.

        Parameters
        ----------
        k, held
            As for `between`.
        errors : int
            How many errors there are behind the state in the rows.
        """
        wide = [[*h, *(ZERO,) * errors] for h in held]
        linear = self._signals(k, wide, errors, (False,) * len(self.signals))
        for replaced in product((False, True), repeat=len(self.signals)):
            taken = self._signals(k, wide, errors, replaced)
            yield [
                [new - old for new, old in zip(*rows, strict=True)]
                for rows in zip(taken, linear, strict=True)
            ]

    def _signals(
        self, k: int, held: Sequence[Sequence[Fraction]], errors: int, replaced: Sequence[bool]
    ) -> list[list[Fraction]]:
        """Return every signal as a row over the state and errors: its argument, or the h."""
        found: list[list[Fraction]] = []
        for signal, h, other in zip(self.signals, held, replaced, strict=True):
            row, n = signal.rows[k].fractions()[0], len(h) - errors
            off = signal.errors[k].fractions()[0] if errors else []
            argument = [*row[:n], *off]
            for share, before in zip(row[n:], found, strict=True):
                argument = [a + share * b for a, b in zip(argument, before, strict=True)]
            found.append(list(h) if other else argument)
        return found


@dataclass(frozen=True, slots=True)
class Governed:
    """A position loop whose reference a safety layer moves; all numbers are those that ship."""

    # Where the motor is: rad/s per unit of the command, and s.
    gain: Range
    time_constant: Range
    # Of the motion controller, in command/rad: its Kp, and Kd over the period.
    Kp: Fraction
    D: Fraction
    tick: Fraction  # The period as the processor holds it, in s
    # What the layer keeps: rad/s, N m, J, and what it gives back in a sample, J.
    speed: Fraction
    torque: Fraction
    energy: Fraction
    refill: Fraction
    stiffness: Range  # Torque over deflection of whatever is touched, in N m/rad
    oldest: int  # Largest age of the torque that the layer is given, in samples
    angle: Fraction  # Largest angle and reference, in rad
    unit: str  # That of the command
    # Bounds on what disturbs: half a step of the encoder in rad, what the torque of the sensor is
    # off in N m, and Coulomb friction in the unit of the command.
    encoder: Fraction = ZERO
    sensor: Fraction = ZERO
    friction: Fraction = ZERO
    damping: Fraction = ZERO  # Of whatever is touched, at most, in N m s/rad
    command: Fraction | None = None  # Where the command saturates; None for nowhere

    @property
    def step(self) -> Fraction:
        """How far a sample moves the reference at most, in rad."""
        return self.tick * self.speed * (1 + OF_TERMS) + self.angle * OF_ANGLES

    @property
    def noise(self) -> Fraction:
        """How far a computed error is off, in rad."""
        return self.encoder + self.angle * OF_ANGLES

    def find_odd(self) -> str | None:
        """Say why these are no numbers of a loop, or None."""
        least = (self.gain[0], self.time_constant[0], self.stiffness[0], self.Kp, self.tick)
        ranges = (self.gain, self.time_constant, self.stiffness)
        kept = (self.speed, self.torque, self.energy, self.angle)
        disturbing = (self.encoder, self.sensor, self.friction, self.damping)
        borne = (self.D, self.refill, *disturbing, self.command or ONE)
        if any(n.denominator & (n.denominator - 1) for n in (self.Kp, self.D)):
            return "a number of its motion loop is not of binary digits"
        if min(*least, *kept) <= 0 or min(borne) < 0 or any(low > high for low, high in ranges):
            return "the safety layer has a number that no layer has"
        if self.tick * self.speed > self.angle:
            return "a step is larger than the largest angle"
        if self.torque < Fraction(1, 2**20):
            return "the limit of its torque is lost where signs are formed"
        return None if 0 <= self.oldest <= 1000 else "its torque is too old"

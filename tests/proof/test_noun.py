"""Frozen dataclasses: they do what those of the standard library do."""

from __future__ import annotations

import dataclasses
import pickle
import subprocess
import sys
from abc import ABC, abstractmethod
from copy import copy, deepcopy
from dataclasses import FrozenInstanceError, field, fields, replace
from pathlib import Path
from typing import ClassVar

import pytest

from nrs_design.proof.noun import dataclass

PAIR = Path(__file__).parents[2] / "benchmarks" / "soft-tissue-pair.nrs.yaml"
# Of these, the reference of the library describes the classes.
DESCRIBED = {"nrs_design.search.gradient_settings"}
# Run with the arguments that follow; then say where the standard decorator is used all the same.
SLOW = """
import dataclasses, sys
from nrs_design.cli import main
try:
    main()
except SystemExit as ending:
    assert ending.code == 0
ours = {name: module for name, module in sys.modules.items() if name.startswith("nrs_design.")}
for name, module in sorted(ours.items()):
    if getattr(module, "dataclass", None) is dataclasses.dataclass:
        print("slow", name)
"""


class AbstractShape(ABC):
    sides: ClassVar[int]

    @property
    @abstractmethod
    def area(self) -> int: ...


@dataclass(frozen=True, slots=True)
class Box(AbstractShape):
    """A box with a name that does not count, and a volume that is not told."""

    sides: ClassVar[int] = 4
    width: int
    height: int = 2
    name: str = field(default="", compare=False)
    marks: list[int] = field(default_factory=list, compare=False, repr=False)
    _half: int = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_half", self.width * self.height // 2)

    @property
    def area(self) -> int:
        return 2 * self._half


@dataclasses.dataclass(frozen=True, slots=True)
class StandardBox:
    width: int
    height: int = 2
    name: str = field(default="", compare=False)
    marks: list[int] = field(default_factory=list, compare=False, repr=False)
    _half: int = field(init=False, repr=False, default=0)


@dataclass(frozen=True, slots=True)
class Square:
    width: int
    height: int = 2


@dataclass(frozen=True, slots=True)
class Odd:
    """One field, and its own ways to compare, hash and print."""

    number: int

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Odd) and self.number % 2 == other.number % 2

    def __hash__(self) -> int:
        return self.number % 2

    def __repr__(self) -> str:
        return "odd"


@dataclass(frozen=True, slots=True)
class Holder:
    entries: list[int]


def test_fields_and_what_follows_from_them():
    box = Box(4, 3, "a")
    assert (box.width, box.height, box.name, box.marks, box.area) == (4, 3, "a", [], 12)
    assert Box(1).height == 2
    assert Box(1).marks is not Box(1).marks
    assert [f.name for f in fields(box)] == ["width", "height", "name", "marks", "_half"]
    assert replace(box, width=6).area == 18
    assert Box.__doc__.startswith("A box")
    assert Box.__match_args__ == StandardBox.__match_args__[:4]
    with pytest.raises(TypeError):
        Box()


def test_what_counts_is_compared_and_hashed():
    assert Box(4, 3, "a") == Box(4, 3, "b", [1])
    assert hash(Box(4, 3, "a")) == hash(Box(4, 3, "b"))
    assert Box(4, 3) != Box(3, 4)
    assert hash(Box(4, 3)) != hash(Box(3, 4))
    assert Box(4) != Square(4)
    assert Square(4) != (4, 2)
    assert Square(4).__eq__((4, 2)) is NotImplemented
    assert hash(Square(4)) == hash((4, 2))
    with pytest.raises(TypeError, match="unhashable"):
        hash(Holder([1]))
    assert Holder([1]) == Holder([1])


def test_it_prints_like_the_standard_one():
    assert repr(Box(4, 3, "a", [1])) == repr(StandardBox(4, 3, "a", [1])).replace("Standard", "")


def test_what_a_class_says_itself_stays():
    assert Odd(1) == Odd(3)
    assert len({Odd(1), Odd(3)}) == 1
    assert repr(Odd(5)) == "odd"
    with pytest.raises(FrozenInstanceError):
        Odd(1).number = 2


@pytest.mark.parametrize("name", ["width", "marks", "_half", "area", "depth", "sides"])
def test_nothing_is_changed(name):
    box = Box(4, 3, "a")
    with pytest.raises(FrozenInstanceError, match=f"cannot assign to field '{name}'"):
        setattr(box, name, 7)
    with pytest.raises(FrozenInstanceError, match=f"cannot delete field '{name}'"):
        delattr(box, name)
    assert box == Box(4, 3, "a")
    assert not hasattr(Square(1), "__dict__")


@pytest.mark.parametrize("twin", [copy, deepcopy, lambda box: pickle.loads(pickle.dumps(box))])
def test_copies(twin):
    box = Box(4, 3, "a", [1])
    again = twin(box)
    assert again is not box
    assert again == box
    assert (again.name, again.marks, again.area) == ("a", [1], 12)


@pytest.mark.parametrize(("frozen", "slots"), [(False, True), (True, False)])
def test_a_noun_is_frozen_and_has_slots(frozen, slots):
    with pytest.raises(TypeError, match="frozen, and has slots"):
        dataclass(frozen=frozen, slots=slots)


def test_a_cold_proof_makes_no_other_dataclasses(tmp_path):
    out = str(tmp_path / "pair.cert.json")
    for arguments in (["certify-switching", str(PAIR), "--out", out], ["verify", out, str(PAIR)]):
        command = [sys.executable, "-c", SLOW, *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        assert "PROVED" in done.stdout
        lines = map(str.split, done.stdout.splitlines())
        slow = {words[1] for words in lines if words[:1] == ["slow"]}
        assert slow <= DESCRIBED

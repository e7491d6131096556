"""The single steps that a system in discrete time may take, as a graph (untrusted)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence.growth import Steps
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.graph import Graph

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# Larger graphs are not searched.
MOST_NODES, MOST_EDGES = 4000, 200_000


@dataclass(frozen=True)
class StepGraph:
    """A node is a mode with the steps made in it; an edge is one more step, in it or another one.

    Edges are in the order of their sources.
    """

    names: tuple[str, ...]  # Of the modes
    # Of each edge: nodes, the mode of its step, which reset leads there (-1: the mode goes on), and
    # what becomes of the state.
    sources: Indices
    targets: Indices
    modes: Indices
    ways: Indices
    maps: Array  # Shape (edges, n, n)
    count: int  # Of the nodes
    has_choice: bool  # Some switch has more than one reset

    @classmethod
    def of(cls, system: SwitchedSystem, matrices: Array) -> StepGraph | None:
        """Return the graph of a system; None where it is none of single steps, or too large.

        The modes may be scaled; they are those of the system itself if there are resets.
        """
        names = tuple(mode.name for mode in system.modes)
        if system.time is not Time.DISCRETE or system.clock is not None:
            return None
        if system.switching.is_arbitrary:
            return cls.free(names, matrices)
        if system.switching.fixed_ends:
            return None
        graph = Graph.of(system, matrices)
        # Steps in a mode are counted up to where nothing changes any more.
        last = np.where(np.isinf(graph.longest), graph.shortest, graph.longest)
        if last.sum() > MOST_NODES:
            return None
        first = np.concatenate([[0], np.cumsum(last)]).astype(np.int64)
        rows: list[tuple[int, int, int, int]] = []
        maps: list[Array] = []
        for k, A in enumerate(matrices):
            for node in range(first[k], first[k + 1] - 1):
                rows.append((node, node + 1, k, -1))
                maps.append(A)
            if np.isinf(graph.longest[k]):
                rows.append((int(first[k + 1]) - 1, int(first[k + 1]) - 1, k, -1))
                maps.append(A)
        for jump in graph.jumps:
            entered = matrices[jump.target] @ jump.map
            begin = first[jump.source] + int(graph.shortest[jump.source]) - 1
            for node in range(begin, first[jump.source + 1]):
                rows.append((node, int(first[jump.target]), jump.target, jump.way))
                maps.append(entered)
            if len(rows) > MOST_EDGES:
                return None
        if not rows:
            return None
        columns = np.array(rows, dtype=np.int64)
        order = np.argsort(columns[:, 0], kind="stable")
        sources, targets, modes, ways = columns[order].T
        has_choice = any(jump.way for jump in graph.jumps)
        each = np.array(maps)[order]
        return cls(names, sources, targets, modes, ways, each, int(first[-1]), has_choice)

    @classmethod
    def free(cls, names: Sequence[str], matrices: Array) -> StepGraph:
        """Return the graph of modes of which any may follow any."""
        none, every = np.zeros(len(names), dtype=np.int64), np.arange(len(names))
        return cls(tuple(names), none, none, every, none, matrices, 1, has_choice=False)

    @classmethod
    def of_clock(
        cls, clock: Clock, names: Sequence[str], matrices: Array, kinds: Sequence[int]
    ) -> StepGraph:
        """Return the graph of an automaton: a node is one of its states."""
        rows = [
            (state, target, k)
            for state, kind, target in clock.turns()
            for k, own in enumerate(kinds)
            if own == kind
        ]
        sources, targets, modes = np.array(rows, dtype=np.int64).T
        # Every step is a stay of its own.
        ways = np.zeros_like(modes)
        count, maps = clock.length, matrices[modes]
        return cls(tuple(names), sources, targets, modes, ways, maps, count, has_choice=False)

    def sequence(self, word: Sequence[int]) -> tuple[Steps, tuple[int, ...]]:
        """Return a closed word as the stays of a signal, with the resets that it takes."""
        word = list(word)
        jumps = [k for k, edge in enumerate(word) if self.ways[edge] >= 0]
        if not jumps:
            return ((self.names[self.modes[word[0]]], Fraction(1)),), ()
        # A signal begins with its first mode.
        first = min(jumps, key=lambda k: int(self.modes[word[k]]))
        word = word[first:] + word[:first]
        if self.count == 1:
            runs = [(mode, len([*run])) for mode, run in groupby(self.modes[word].tolist())]
            return tuple((self.names[mode], Fraction(count)) for mode, count in runs), ()
        starts = [k for k, edge in enumerate(word) if self.ways[edge] >= 0]
        ends = [*starts[1:], len(word)]
        steps = tuple(
            (self.names[self.modes[word[a]]], Fraction(b - a))
            for a, b in zip(starts, ends, strict=True)
        )
        ways = [int(self.ways[word[a]]) for a in starts]
        return steps, (*ways[1:], ways[0]) if self.has_choice else ()

"""Forms of a certificate in floating point: matrices for tables, and norms for runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Block, Illustration, Table
from nrs_design.reporting.evidence.offers import Form
from nrs_design.reporting.formatting import number
from nrs_design.reporting.style import INK, new_axes, new_figure, styled
from nrs_design.reporting.text import wrapped_label
from nrs_design.simulation.norms import (
    Array,
    Norm,
    clipped,
    polynomial_norm,
    quadratic_norm,
    scaled_matrices,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage


SCALED = (
    "Q(i,j) / sqrt(Q(i,i) Q(j,j)): the diagonal becomes one and the states lose their units. An "
    "entry near 1 or -1 says that two states act together in V."
)
# Larger matrices, and more of them, do not fit on a page.
_WRITTEN, _WRITTEN_SMALL, _TABLES, _DRAWN = 8, 3, 2, 6


def norms_of(forms: Sequence[Form], order: int) -> list[Norm]:
    """Return the root of each form; quadratic ones are all divided by the same number."""
    if forms[0].degree == 1:
        return [quadratic_norm(Q) for Q in scaled_matrices(*(form.Q for form in forms))]
    return [polynomial_norm(form.Q, form.degree, order) for form in forms]


def largest_norm(forms: Sequence[Form], order: int) -> Norm:
    """Return the largest root of the forms in contact, and in free motion of those for it.

    Without forms for free motion, those in contact hold there with the deflection at zero.
    """
    norms = norms_of(forms, order)
    touching = [norm for norm, form in zip(norms, forms, strict=True) if not form.free]
    free = [norm for norm, form in zip(norms, forms, strict=True) if form.free]

    def in_contact(states: Array) -> Array:
        return np.asarray(np.max([norm(states) for norm in touching], axis=0))

    def everywhere(states: Array) -> Array:
        flying = np.max([norm(states[..., :-1]) for norm in free], axis=0)
        return np.asarray(np.where(states[..., -1] > 0, in_contact(states), flying))

    return everywhere if free else in_contact


def step_norms(forms: Sequence[Form], system: SwitchedSystem) -> list[Norm]:
    """Return the norm of every step of a round; in free motion without the deflection."""
    norms = norms_of(forms, system.order)
    return norms if system.contact is None else [clipped(norm) for norm in norms]


def matrix_blocks(
    forms: Sequence[Form], states: tuple[str, ...], name: str = "quadratic"
) -> list[Block]:
    """Return the matrices of quadratic forms as tables and heat maps, if a page holds them."""
    matrices = scaled_matrices(*(form.Q for form in forms))
    names = [form.name for form in forms]
    blocks: list[Block] = []
    for of, Q in list(zip(names, matrices, strict=True))[:_TABLES]:
        blocks += _table(f"Q{of and f' of {of}'}, divided by the largest entry", Q, states)
    if len(forms) == 1:
        figure = _draw_quadratic(matrices[0], states)
        return [*blocks, Illustration(name, "Matrix of the function", SCALED, figure)]
    last, most = len(forms) - 1, min(len(forms), _DRAWN)
    shown = [round(k * last / (most - 1)) for k in range(most)]
    some = f" {most} of {len(forms)} are drawn." if most < len(forms) else ""
    figure = _draw_quadratics({names[k]: matrices[k] for k in shown}, states)
    title = "Matrices of the functions"
    return [*blocks, Illustration(f"{name}s", title, f"{SCALED}{some}", figure)]


def _table(title: str, Q: Array, states: tuple[str, ...]) -> list[Block]:
    if len(Q) > _WRITTEN:
        return []
    names = states[: len(Q)]
    rows = tuple((name, *(number(v, 5) for v in row)) for name, row in zip(names, Q, strict=True))
    return [Table(title, ("", *names), rows)]


@styled
def _draw_quadratic(Q: Array, states: Sequence[str]) -> Figure:
    """Draw Q as a heat map, scaled so that its diagonal is one."""
    n = len(Q)
    figure, axes = new_axes(2.6 + 0.2 * min(n, _WRITTEN))
    image = _heat_map(axes, Q, written=n <= _WRITTEN)
    if n <= _WRITTEN:
        labels = [wrapped_label(name, 14) for name in states]
        axes.set_xticks(range(n), labels, rotation=0 if n <= 4 else 60)
        axes.set_yticks(range(n), labels)
    axes.set(xlabel="State j", ylabel="State i")
    figure.colorbar(image, ax=axes, label="Scaled entry of Q [1]")
    return figure


@styled
def _draw_quadratics(functions: Mapping[str, Array], states: Sequence[str]) -> Figure:
    """Draw several matrices side by side, each scaled so that its diagonal is one."""
    columns = min(len(functions), 3)
    rows = -(-len(functions) // columns)
    figure = new_figure(0.8 + 2.1 * rows)
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes in grid.flat[len(functions) :]:
        axes.set_visible(False)
    for axes, (name, Q) in zip(grid.flat, functions.items(), strict=False):
        n = len(Q)
        image = _heat_map(axes, Q, written=n <= _WRITTEN_SMALL)
        numbers = [str(i + 1) for i in range(n)] if n <= 2 * _WRITTEN else []
        axes.set_xticks(range(len(numbers)), numbers)
        axes.set_yticks(range(len(numbers)), numbers)
        axes.set_title(wrapped_label(name, 18), fontsize=9)
    for axes in grid[:, 0]:
        axes.set_ylabel("State i")
    for column, axes in enumerate(grid[-1]):
        lowest = axes if axes.get_visible() else grid[-2, column]
        lowest.set_xlabel("State j")
    figure.colorbar(image, ax=grid, label="Scaled entry of Q [1]")
    return figure


def _heat_map(axes: Axes, Q: Array, *, written: bool) -> AxesImage:
    diagonal = np.sqrt(np.diag(Q))
    scaled = Q / np.outer(diagonal, diagonal)
    image = axes.imshow(scaled, cmap="PuOr", vmin=-1, vmax=1, aspect="auto")
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    if written:
        for (i, j), value in np.ndenumerate(scaled):
            tint = "white" if abs(value) > 0.7 else INK
            axes.text(j, i, f"{value:.2f}", ha="center", va="center", color=tint, fontsize=9)
    return image

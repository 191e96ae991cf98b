"""Costs against the number of primitives, both axes logarithmic."""

import math
from collections.abc import Sequence

from matplotlib.figure import Figure

from .figure_dots import COLUMNS, add_legend
from .numbers import shortened
from .scaling import BUILD, MEMORY, Growth, fitted
from .style import PAGE_WIDTH, Look, new_figure, scale_axis

DASHES = ("-", (0, (4, 2)), (0, (1, 1.5)))  # threads in their order


def scaling_figure(all_of: Sequence[Growth], looks: dict[str, Look]) -> Figure:
    """A row for each family of scenes, a panel for each cost; lines are solid on the fewest threads, dashed on more. The legend has the range of exponents over all rays."""
    families = list(dict.fromkeys(one.family for one in all_of))
    costs = list(dict.fromkeys(one.what for one in all_of))
    places = [(family, what) for family in families for what in costs]
    threads = sorted({one.threads for one in all_of}, key=lambda value: value if isinstance(value, float) else math.inf)
    columns = len(costs) if len(costs) <= COLUMNS + 1 else COLUMNS
    rows = math.ceil(len(places) / columns)
    figure = new_figure(PAGE_WIDTH, 2.2 * rows + 0.35)
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes, place in zip(grid.flat, places):
        here = [one for one in all_of if (one.family, one.what) == place]
        axes.set_title(f"{shortened(place[0], 24)}\n{place[1]}", loc="left")
        axes.set_ylabel("ms" if place[1] == BUILD else "bytes a primitive" if place[1] == MEMORY else "ns per ray")
        axes.set_xlabel("primitives")
        axes.grid(True)
        axes.set_axisbelow(True)
        for one in here:
            look = looks[one.technique]
            dash = DASHES[min(threads.index(one.threads), len(DASHES) - 1)]
            axes.plot(*zip(*one.points), color=look.colour, linestyle=dash, linewidth=1.1, **{**look.mark(3.5), "markeredgewidth": 0.2})
        if not here:
            axes.set_visible(False)
            continue
        scale_axis(axes, "x", [x for one in here for x, _ in one.points])
        scale_axis(axes, "y", [y for one in here for _, y in one.points])
    for axes in list(grid.flat)[len(places) :]:
        axes.set_visible(False)
    labels = [label for label in looks if any(one.technique == label for one in all_of)]
    add_legend(figure, labels, looks, notes={label: exponents(all_of, label) for label in labels})
    return figure


def exponents(all_of: Sequence[Growth], technique: str) -> str:
    """The range of a technique's exponents over families, rays and threads."""
    powers = [fitted(one.points).exponent for one in all_of if one.technique == technique and one.what not in (BUILD, MEMORY)]
    if not powers:
        return ""
    low, high = f"{min(powers):.2f}", f"{max(powers):.2f}"
    return f" (n^{low})" if low == high else f" (n^{low} to n^{high})"

"""What a grid's walk errs by the form of its DDA: growth with the cells a side, and speed against error."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from .cells import Cell, at_setting, finite, main_setting, parse_params, scenes_of
from .figure_dots import add_legend
from .numbers import axis_number, shortened
from .peer import ratio_of
from .style import INK, MARKERS, PAGE_WIDTH, STRUCTURE_COLOURS, Look, new_figure

FORMS = ("recompute", "divide", "fma", "compensated", "accumulate")
COLOURS = [STRUCTURE_COLOURS[name] for name in ("bvh", "octree", "grid", "kdtree", "ray_classification")]
LOOKS = {form: Look(colour, marker) for form, colour, marker in zip(FORMS, [INK, *COLOURS], MARKERS)}


@dataclass(frozen=True)
class Walk:
    """Rays by one form through one grid: the share that misses a cell which they pass through, their longest way in one, in cells."""

    cell: Cell
    form: str
    side: int  # cells along the longest side
    rays: float
    missing: float
    longest: float
    at_risk: float  # share of the rays that go further in a missed cell than lists reach beyond cells
    speed: float | None = None  # relative to `recompute` through the same grid, with its 95 % interval
    slow: float | None = None
    fast: float | None = None


def cells_a_side(resolution: str) -> int | None:
    sides = resolution.split("x")
    return max(map(int, sides)) if all(side.isdecimal() for side in sides) else None


def walks(cells: Sequence[Cell]) -> dict[tuple[str, str], list[Walk]]:
    """By scene and kind of rays, at the main setting, along rising resolutions. Nothing where forms do not differ."""
    having = [cell for cell in cells if finite(cell.accuracy.get("cell_rays_checked"))]
    panels: dict[tuple[str, str], list[Walk]] = {}
    for cell in at_setting(having, main_setting(having)):
        params = parse_params(cell.technique[1])
        side = cells_a_side(params.get("resolution", ""))
        if side is None or params.get("dda") not in LOOKS:
            continue
        rays = finite(cell.accuracy["cell_rays_checked"]) or 1.0
        missing, at_risk = ((finite(cell.accuracy[name]) or 0.0) / rays for name in ("cell_rays_missing", "cell_rays_at_risk"))
        walk = Walk(cell, params["dda"], side, rays, missing, finite(cell.accuracy["longest_missed"]) or 0.0, at_risk)
        panels.setdefault((cell.scene, cell.rays), []).append(walk)
    found = {key: sorted(timed(of_panel), key=lambda walk: walk.side) for key, of_panel in panels.items()}
    return found if any(len({walk.form for walk in of_panel}) > 1 for of_panel in found.values()) else {}


def timed(of_panel: Sequence[Walk]) -> list[Walk]:
    """The same with their speeds, round by round against the robust form on the same grid."""
    robust = {walk.side: walk.cell for walk in of_panel if walk.form == FORMS[0]}
    ratios = [ratio_of(walk.cell, robust[walk.side]) if walk.side in robust else None for walk in of_panel]
    return [replace(walk, speed=ratio.value, slow=ratio.low, fast=ratio.high) if ratio else walk for walk, ratio in zip(of_panel, ratios)]


def front(of_grid: Sequence[Walk]) -> list[Walk]:
    """Of the walks through one grid those that no other beats in error and speed, by rising error."""
    best: list[Walk] = []
    for walk in sorted(of_grid, key=lambda walk: (walk.missing, -(walk.speed or 0.0))):
        if walk.speed and (not best or walk.speed > (best[-1].speed or 0.0)):
            best.append(walk)
    return best


def walks_figure(panels: dict[tuple[str, str], list[Walk]]) -> Figure:
    """A column for each scene and kind of rays. Above, the longest way in a missed cell by cells a side; below, where timed, speed by the share of rays that
    miss any, with a place of its own for none; the finest grid has large marks, and its front."""
    everything = [walk for of_panel in panels.values() for walk in of_panel]
    scenes = scenes_of([walk.cell for walk in everything])
    columns = sorted(panels, key=lambda key: (scenes.index(key[0]), key[1]))
    has_speeds = any(walk.speed for walk in everything)
    figure = new_figure(PAGE_WIDTH, 4.6 if has_speeds else 2.6)
    grid = figure.subplots(2 if has_speeds else 1, len(columns), sharey="row", sharex="row", squeeze=False)
    forms = [form for form in FORMS if any(walk.form == form for walk in everything)]
    for column, key in enumerate(columns):
        title = shortened(key[0]) + ("" if key[1] == "case" else f", {key[1]}")
        draw_growth(grid[0, column], panels[key], forms, [walk.longest for walk in everything])
        grid[0, column].set_title(title, loc="left")
        if has_speeds:
            draw_speeds(grid[1, column], panels[key], forms, everything)
    grid[0, 0].set_ylabel("longest way in a missed cell")
    if has_speeds:
        grid[1, 0].set_ylabel("speed, recompute = 1")
        speeds = [speed for walk in everything for speed in (walk.slow, walk.speed, walk.fast) if speed]
        room = 0.1 * (max(speeds) - min(speeds)) or 0.1
        grid[1, 0].set_ylim(min(speeds) - room, max(speeds) + room)
    add_legend(figure, forms, LOOKS)
    return figure


def zero_and_decades(values: Sequence[float]) -> tuple[float, list[int]]:
    """Where 0 stands on an axis of decimal logarithms, and the decades to be named."""
    logarithms = [math.log10(value) for value in values if value]
    low, high = (math.floor(min(logarithms)), math.ceil(max(logarithms))) if logarithms else (-1, 0)
    return low - 1.0, list(range(high, low - 1, -max(1, math.ceil((high - low) / 4))))[::-1]


def draw_growth(axes: Axes, of_panel: Sequence[Walk], forms: Sequence[str], values: Sequence[float]) -> None:
    zero, decades = zero_and_decades(values)
    axes.grid(True)
    axes.set_axisbelow(True)
    for form in forms:
        line = [walk for walk in of_panel if walk.form == form]
        places = [math.log10(walk.longest) if walk.longest else zero for walk in line]
        axes.plot([walk.side for walk in line], places, color=LOOKS[form].colour, linewidth=0.9, alpha=0.7)
        for walk, place in zip(line, places):
            axes.plot([walk.side], [place], linestyle="none", **LOOKS[form].mark(4))
            if walk.at_risk:
                axes.plot([walk.side], [place], linestyle="none", marker="o", markersize=10, markerfacecolor="none", markeredgecolor=INK, markeredgewidth=0.9)
    axes.set_xscale("log", base=2)
    axes.xaxis.set_major_locator(FixedLocator(sorted({walk.side for walk in of_panel})))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xlabel("cells a side")
    axes.set_ylim(zero - 0.4, decades[-1] + 0.3)
    axes.set_yticks([zero, *decades], ["none", *(f"{axis_number(10.0**decade)} cell" if decade == decades[-1] else axis_number(10.0**decade) for decade in decades)])


def draw_speeds(axes: Axes, of_panel: Sequence[Walk], forms: Sequence[str], everything: Sequence[Walk]) -> None:
    zero, decades = zero_and_decades([walk.missing for walk in everything])
    finest = max(walk.side for walk in everything)
    axes.grid(True)
    axes.set_axisbelow(True)

    def place(walk: Walk) -> float:
        return math.log10(walk.missing) if walk.missing else zero

    best = front([walk for walk in of_panel if walk.side == finest])
    if best:
        ends = [(place(walk), walk.speed or 0.0) for walk in best]
        ends = [(ends[0][0], -1.0), *ends, (decades[-1] + 10, ends[-1][1])]
        axes.plot(*zip(*ends), color=INK, alpha=0.3, linewidth=3, drawstyle="steps-post", solid_joinstyle="miter", zorder=1)
    for form in forms:
        line = [walk for walk in of_panel if walk.form == form and walk.speed]
        look = LOOKS[form]
        axes.plot([place(walk) for walk in line], [walk.speed for walk in line], color=look.colour, linewidth=0.9, alpha=0.7, zorder=2)
        for walk in line:
            middle = walk.speed or 0.0
            bar = [[max(0.0, middle - (walk.slow or middle))], [max(0.0, (walk.fast or middle) - middle)]]
            size = 6 if walk.side == finest else 3
            axes.errorbar(place(walk), middle, yerr=bar, color=look.colour, marker=look.marker, markersize=size, linewidth=0.8, zorder=3)
    least = min(walk.rays for walk in everything)
    axes.set_xlim(zero - 0.4, decades[-1] + 0.3)
    axes.set_xticks([zero, *decades], [f"0\n(< {float(f'{3 / least:.0e}'):g})", *(axis_number(10.0**decade) for decade in decades)])
    axes.set_xlabel("share of rays that miss a cell")

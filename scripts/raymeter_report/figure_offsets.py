"""What becomes of secondary rays by how far their origins are lifted off their surfaces: wrong answers and speed by rule, a row of panels for each scene."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from .cells import Cell, at_setting, finite, main_setting, rays_of, scenes_of
from .figure_dots import add_legend
from .numbers import axis_number, shortened
from .style import INK, PAGE_WIDTH, SPARE_COLOURS, STRUCTURE_COLOURS, Look, new_figure, scale_axis

MARK = ":offset="
BOUND = "bound"
SELF = "meets the surface that it leaves"
OTHER = "misses what is there, or meets a neighbour instead"
SPEED = "speed, with 95 % interval"
LOOKS = {SELF: Look(STRUCTURE_COLOURS["grid"], "o"), OTHER: Look(STRUCTURE_COLOURS["bvh"], "D"), SPEED: Look(SPARE_COLOURS[1], "s")}


@dataclass(frozen=True)
class Lifted:
    """Rays by one rule: shares of all that went wrong, and Mrays/s with its interval."""

    cell: Cell
    rule: str
    self_hits: float
    others: float | None  # of the bound: the others are held against it
    rays: float
    speed: float | None
    slow: float | None
    fast: float | None


def rule_of(rays: str) -> str | None:
    """The rule in the name of a ray set, None where it names none."""
    return rays.partition(MARK)[2].partition(" ")[0] or None


def rank_of(rule: str) -> tuple[int, float]:
    """Fixed offsets by size, then relative ones, then the bound."""
    return (2, 0.0) if rule == BOUND else (1, float(rule[:-3])) if rule.endswith("ulp") else (0, float(rule))


def rule_label(rule: str) -> str:
    if rule == BOUND:
        return "proven bound"
    amount = axis_number(float(rule.removesuffix("ulp"))).replace("e-0", "e-")
    return f"{amount} ulp" if rule.endswith("ulp") else f"fixed {amount}"


def lifted_rays(cells: Sequence[Cell]) -> dict[tuple[str, str], list[Lifted]]:
    """By scene and kind of rays, at the main setting, in the order of rules; of several structures the first. Nothing where rules do not differ."""
    having = [cell for cell in cells if not cell.frame and not cell.is_peer and rule_of(cell.rays) and finite(cell.accuracy.get("rays_checked"))]
    panels: dict[tuple[str, str], dict[str, Lifted]] = {}
    for cell in at_setting(having, main_setting(having)):
        rays = finite(cell.accuracy["rays_checked"]) or 1.0
        rule = rule_of(cell.rays) or BOUND
        wrong = sum(finite(cell.accuracy.get(name)) or 0.0 for name in ("false_miss", "false_hit", "wrong_prim"))
        self_hits = finite(cell.accuracy.get("self_hits")) or 0.0
        others = None if rule == BOUND else max(0.0, wrong - self_hits) / rays
        speeds = [cell.number("mrays_per_s"), *(1e3 / time if time else None for time in (cell.number("ci_hi"), cell.number("ci_lo")))]
        panels.setdefault((cell.scene, cell.rays.partition(MARK)[0]), {}).setdefault(rule, Lifted(cell, rule, self_hits / rays, others, rays, *speeds))
    found = {key: sorted(of_panel.values(), key=lambda one: rank_of(one.rule)) for key, of_panel in panels.items()}
    return found if any(len(of_panel) > 1 for of_panel in found.values()) else {}


def offsets_figure(panels: dict[tuple[str, str], list[Lifted]]) -> Figure:
    """For each scene and kind two panels: what went wrong, on a logarithmic axis with a place of its own for nothing, and how fast the rays were."""
    everything = [one for of_panel in panels.values() for one in of_panel]
    cells = [one.cell for one in everything]
    kinds = [kind for kind in dict.fromkeys(rays.partition(MARK)[0] for rays in rays_of(cells))]
    rows = [(scene, kind) for scene in scenes_of(cells) for kind in kinds if (scene, kind) in panels]
    rules = sorted({one.rule for one in everything}, key=rank_of)
    shares = [share for one in everything for share in (one.self_hits, one.others) if share]
    rays = min(one.rays for one in everything)
    low = math.floor(math.log10(min(shares, default=1.0)))
    timed = any(one.speed for one in everything)
    figure = new_figure(PAGE_WIDTH, len(rows) * (0.155 * len(rules) + 0.38) + 0.6)
    grid = figure.subplots(len(rows), 2 if timed else 1, sharey=True, sharex="col", squeeze=False, width_ratios=[3, 2] if timed else [1])
    for row, (scene, kind) in enumerate(rows):
        draw_shares(grid[row, 0], panels[scene, kind], rules, low - 1.0)
        grid[row, 0].set_title(f"{shortened(scene)}, {kind.replace('_', ' ')} rays", loc="left")
        if timed:
            draw_speeds(grid[row, 1], panels[scene, kind], rules)
    label_axes(grid, rules, low, rays)
    if timed:
        scale_axis(grid[-1, 1], "x", [speed for one in everything for speed in (one.slow, one.speed, one.fast) if speed], max_ticks=5)
        grid[-1, 1].set_xlabel("million rays per second")
    add_legend(figure, [SELF, OTHER, SPEED] if timed else [SELF, OTHER], LOOKS)
    return figure


def label_axes(grid: "list[list[Axes]]", rules: Sequence[str], low: int, rays: float) -> None:
    decades = list(range(0, low - 1, -max(1, math.ceil(-low / 5))))[::-1]
    for axes in grid[:, 0]:  # type: ignore[call-overload]
        axes.set_xlim(low - 1.4, 0.15)
        axes.xaxis.set_major_locator(FixedLocator([low - 1.0, *decades]))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xticklabels([f"none\n(< {float(f'{3 / rays:.0e}'):g})", *(axis_number(10.0**decade) for decade in decades)])
        axes.set_ylabel("origin lifted by")
    for axes in grid.flat:  # type: ignore[attr-defined]
        axes.set_ylim(len(rules) - 0.5, -0.5)
        axes.set_yticks(range(len(rules)), [rule_label(rule) for rule in rules])
        axes.tick_params(axis="y", length=0)
        axes.grid(axis="x")
        axes.set_axisbelow(True)
        for i in range(0, len(rules), 2):
            axes.axhspan(i - 0.5, i + 0.5, color=INK, alpha=0.05, linewidth=0)
    grid[-1, 0].set_xlabel("share of the rays that err")  # type: ignore[call-overload]


def draw_shares(axes: Axes, lifted: Sequence[Lifted], rules: Sequence[str], zero: float) -> None:
    axes.axvline(zero, color=INK, linewidth=0.8, alpha=0.7)
    for one in lifted:
        for share, look, shift in ((one.self_hits, LOOKS[SELF], -0.16), (one.others, LOOKS[OTHER], 0.16)):
            if share is not None:
                y = rules.index(one.rule) + shift
                at = math.log10(share) if share else zero
                axes.plot([zero, at], [y, y], color=look.colour, linewidth=1.0, alpha=0.5)
                axes.plot([at], [y], linestyle="none", **look.mark(4))


def draw_speeds(axes: Axes, lifted: Sequence[Lifted], rules: Sequence[str]) -> None:
    look = LOOKS[SPEED]
    for one in lifted:
        y = rules.index(one.rule)
        if one.slow and one.fast:
            axes.plot([one.slow, one.fast], [y, y], color=look.colour, linewidth=1.2)
        if one.speed:
            axes.plot([one.speed], [y], linestyle="none", **look.mark(4))

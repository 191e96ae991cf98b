"""Wrong answers of techniques on the same rays: a panel for each scene and ray kind, a row for each technique."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from .cells import Cell, finite, rays_of, scenes_of, techniques_of
from .numbers import axis_number, shortened
from .style import INK, PAGE_WIDTH, Look, new_figure
from .work_precision import error_rate


@dataclass(frozen=True)
class Wrong:
    """The worst of a technique's cells in a panel: wrong answers a ray, and of how many rays."""

    error: float
    rays: float


def wrong_answers(cells: Sequence[Cell]) -> dict[tuple[str, str], dict[str, Wrong]]:
    """By scene and ray kind, then by technique; nothing where fewer than two techniques were checked or none erred. Hard cases have a table of their own."""
    panels: dict[tuple[str, str], dict[str, Wrong]] = {}
    for cell in cells:
        error = error_rate(cell) if not cell.frame and cell.summary["rays"] != "case" and ":offset=" not in cell.rays else None
        if error is None:
            continue
        of_panel = panels.setdefault((cell.scene, cell.rays), {})
        worst = of_panel.get(cell.label)
        if worst is None or error > worst.error:
            of_panel[cell.label] = Wrong(error, finite(cell.accuracy.get("rays_checked")) or 1.0)
    erring = any(wrong.error for of_panel in panels.values() for wrong in of_panel.values())
    return panels if erring and any(len(of_panel) > 1 for of_panel in panels.values()) else {}


def wrong_figure(panels: dict[tuple[str, str], dict[str, Wrong]], cells: Sequence[Cell], looks: dict[str, Look]) -> Figure:
    """Wrong answers a ray on a logarithmic axis with a place of its own for none."""
    shown = [cell for cell in cells if (cell.scene, cell.rays) in panels]
    scenes, kinds, labels = scenes_of(shown), rays_of(shown), techniques_of(shown)
    everything = [wrong for of_panel in panels.values() for wrong in of_panel.values()]
    errors = [math.log10(wrong.error) for wrong in everything if wrong.error]
    rays = min((wrong.rays for wrong in everything if not wrong.error), default=1.0)
    low, high = min(math.floor(min(errors)), math.floor(math.log10(3 / rays)) + 1), 0
    figure = new_figure(PAGE_WIDTH, len(scenes) * (0.17 * len(labels) + 0.3) + 0.55)
    grid = figure.subplots(len(scenes), len(kinds), sharex=True, sharey=True, squeeze=False)
    for row, scene in enumerate(scenes):
        for column, kind in enumerate(kinds):
            draw_panel(grid[row, column], panels.get((scene, kind), {}), labels, looks, low - 1.0)
            grid[row, column].set_title(f"{shortened(scene.removeprefix('hard:'), 16)}, {kind}", loc="left")
    step = max(1, math.ceil((high - low) / 3))
    decades = list(range(high, low - 1, -step))[::-1]
    for axes in grid.flat:
        axes.set_xlim(low - 1.5, high + 0.3)
        axes.set_ylim(len(labels) - 0.5, -0.5)
        axes.xaxis.set_major_locator(FixedLocator([low - 1.0, *decades]))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xticklabels([f"0\n(< {float(f'{3 / rays:.0e}'):g})", *(axis_number(10.0**decade) for decade in decades)])
        axes.set_yticks(range(len(labels)), labels)
        axes.tick_params(axis="y", length=0)
    for axes in grid[-1, :]:
        axes.set_xlabel("wrong answers per ray")
    return figure


def draw_panel(axes: Axes, wrong: dict[str, Wrong], labels: Sequence[str], looks: dict[str, Look], zero: float) -> None:
    axes.grid(axis="x")
    axes.set_axisbelow(True)
    axes.axvline(zero, color=INK, linewidth=0.8, alpha=0.7)
    for i, label in enumerate(labels):
        if label not in wrong:
            continue
        at = math.log10(wrong[label].error) if wrong[label].error else zero
        axes.plot([zero, at], [i, i], color=looks[label].colour, linewidth=1.0, alpha=0.6)
        axes.plot([at], [i], linestyle="none", **looks[label].mark(5))

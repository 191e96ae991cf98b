"""Hard cases by technique: a row for each case, a column for each technique, its wrong answers in the field."""

import math
from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from .cells import Cell, finite, techniques_of
from .hard_cases import WRONG
from .numbers import integer
from .style import INK, PAGE_WIDTH, new_figure

WRONG_COLOUR, EXCUSED_COLOUR = "#d55e00", "#787d84"
LIGHTEST, DARKEST = 1e-6, 1.0  # wrong answers a ray, from the faintest colour to the full one


def cells_of_cases(cells: Sequence[Cell]) -> list[Cell]:
    return [cell for cell in cells if cell.summary["rays"] == "case" and cell.accuracy]


def worst_of(cells: Sequence[Cell]) -> tuple[float, float]:
    """Wrong answers, rays that hit the surface that they leave among them, and the rays held against what is known; of the worst cell."""
    counts = [(sum(finite(cell.accuracy.get(name)) or 0.0 for name in (*WRONG, "self_hits")), finite(cell.accuracy.get("rays_checked")) or 1.0) for cell in cells]
    return max(counts, key=lambda pair: pair[0] / pair[1])


def cases_figure(cells: Sequence[Cell]) -> Figure:
    """Counts in fields whose colour deepens with the logarithm of the rate, grey and in brackets where they are excused; a field without a count was not run."""
    cells = cells_of_cases(cells)
    labels, scenes = techniques_of(cells), list(dict.fromkeys(cell.scene for cell in cells))
    longest = max(len(label) for label in labels)
    figure = new_figure(PAGE_WIDTH, 0.165 * len(scenes) + 0.062 * longest + 0.25)
    axes = figure.subplots()
    for row, scene in enumerate(scenes):
        for column, label in enumerate(labels):
            here = [cell for cell in cells if (cell.scene, cell.label) == (scene, label)]
            if not here:
                continue
            wrong, rays = worst_of(here)
            excused = wrong and all(cell.state == "ok" and not cell.is_peer for cell in here)
            if wrong:
                depth = math.log(max(wrong / rays, LIGHTEST) / LIGHTEST) / math.log(DARKEST / LIGHTEST)
                axes.add_patch(Rectangle((column - 0.47, row - 0.44), 0.94, 0.88, facecolor=EXCUSED_COLOUR if excused else WRONG_COLOUR, alpha=0.2 + 0.6 * depth, linewidth=0))
            count = f"({integer(wrong)})" if excused else integer(wrong)
            axes.text(column, row, count, ha="center", va="center", fontsize=6.5 if wrong else 6, alpha=1.0 if wrong else 0.45, color=INK)
    axes.set_xlim(-0.5, len(labels) - 0.5)
    axes.set_ylim(len(scenes) - 0.5, -0.5)
    axes.set_xticks(range(len(labels)), labels, rotation=90 if len(labels) > 4 else 0)
    axes.set_yticks(range(len(scenes)), [scene.removeprefix("hard:") for scene in scenes])
    axes.tick_params(length=0, top=False, bottom=False, labeltop=True, labelbottom=False)
    axes.spines[:].set_visible(False)
    return figure

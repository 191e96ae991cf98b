"""Dot plots: one row per scene, one mark per technique, one panel per ray kind or measure."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .numbers import axis_number, shortened
from .style import INK, PAGE_WIDTH, Look, new_figure, scale_axis

COLUMNS = 3


@dataclass(frozen=True)
class Dot:
    """A value of one technique on one scene, with its confidence interval where there is one."""

    scene: str
    technique: str
    value: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True)
class Panel:
    """A panel of dots; `absent` are the techniques and scenes without a value because the cell failed, `line` a value that they are to be held against, `limit` one that they are
    not to go beyond."""

    title: str
    axis: str
    dots: Sequence[Dot]
    absent: Sequence[tuple[str, str]] = ()
    line: float | None = None
    limit: float | None = None


def dot_figure(
    panels: Sequence[Panel], scenes: dict[str, float | None], looks: dict[str, Look], shared_scale: bool = True, columns: int = COLUMNS
) -> Figure:
    """Panels side by side; `scenes` gives each scene's number of primitives. With `shared_scale` all panels have the same axis."""
    columns = min(columns, len(panels))
    rows = math.ceil(len(panels) / columns)
    techniques = [label for label in looks if any(dot.technique == label for panel in panels for dot in panel.dots)]
    row_height = max(0.3, 0.1 * len(techniques) + 0.12)
    height = min(10.0, rows * (len(scenes) * row_height + 0.75) + 0.35)
    figure = new_figure(PAGE_WIDTH, height)
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    shown = [[value for dot in panel.dots for value in (dot.value, dot.low, dot.high, panel.limit) if value is not None] for panel in panels]
    for axes, panel, own in zip(grid.flat, panels, shown):
        draw_panel(axes, panel, list(scenes), techniques, looks)
        scale_axis(axes, "x", [value for of_panel in shown for value in of_panel] if shared_scale else own, max_ticks=5)
    for axes in list(grid.flat)[len(panels) :]:
        axes.set_visible(False)
    for axes in grid[:, 0]:
        axes.set_yticks(range(len(scenes)), [scene_label(scene, size) for scene, size in scenes.items()])
    add_legend(figure, techniques, looks, any(panel.absent for panel in panels))
    return figure


def scene_label(scene: str, size: float | None) -> str:
    """The scene and its size on a second line."""
    name = "\n".join(shortened(line) for line in scene.split("\n"))
    return name if size is None else f"{name}\n{axis_number(float(f'{size:.3g}'))} primitives"


def draw_panel(axes: Axes, panel: Panel, scenes: list[str], techniques: list[str], looks: dict[str, Look]) -> None:
    """Marks with error bars, techniques of one scene one below the other."""
    step = 0.74 / max(1, len(techniques))
    size = 5.0 if len(techniques) <= 5 else 4.0
    axes.set_title(shortened(panel.title), loc="left")
    axes.set_xlabel(panel.axis)
    axes.set_ylim(len(scenes) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    axes.grid(axis="x")
    axes.set_axisbelow(True)
    if panel.line is not None:
        axes.axvline(panel.line, color=INK, linewidth=0.8, alpha=0.7)
    if panel.limit is not None:
        axes.axvline(panel.limit, color=INK, linewidth=0.8, alpha=0.7, linestyle="--")
    for i in range(0, len(scenes), 2):
        axes.axhspan(i - 0.5, i + 0.5, color=INK, alpha=0.05, linewidth=0)

    def place(scene: str, technique: str) -> float:
        return scenes.index(scene) + (techniques.index(technique) - (len(techniques) - 1) / 2) * step

    for dot in panel.dots:
        look = looks[dot.technique]
        y = place(dot.scene, dot.technique)
        if dot.low is not None and dot.high is not None:
            axes.plot([dot.low, dot.high], [y, y], color=look.colour, linewidth=1.2, solid_capstyle="butt")
            axes.plot([dot.low, dot.high], [y, y], linestyle="none", marker="|", markersize=size + 1, color=look.colour, markeredgewidth=1.0)
        axes.plot([dot.value], [y], linestyle="none", **look.mark(size))
    for scene, technique in panel.absent:
        if technique in techniques:
            axes.plot(
                [0.03], [place(scene, technique)], transform=axes.get_yaxis_transform(), marker="x", markersize=size, color=looks[technique].colour
            )


def add_legend(figure: Figure, techniques: list[str], looks: dict[str, Look], with_failed: bool = False, notes: dict[str, str] = {}) -> None:
    """One legend above all panels; `notes` adds a remark to a technique's name."""
    handles = [
        Line2D([], [], linestyle="none", label=label + notes.get(label, ""), **looks[label].mark(5))
        for label in techniques
    ]
    if with_failed:
        handles.append(Line2D([], [], linestyle="none", marker="x", color=INK, markersize=5, label="failed: no value"))
    widths = [0.32 + 0.066 * len(handle.get_label()) for handle in handles]  # inches: the mark and its text
    room = figure.get_figwidth()
    columns = len(handles) if sum(widths) <= room else max(1, int(room / max(widths)))
    legend_height = 0.06 + 0.155 * math.ceil(len(handles) / columns)
    # Figures are made with room for two lines of legend; what many techniques need is added, so that the panels keep their size.
    figure.set_figheight(figure.get_figheight() + max(0.0, legend_height - 0.37))
    figure.set_layout_engine("constrained", rect=(0, 0, 1, 1 - legend_height / figure.get_figheight()))
    figure.legend(
        handles=handles, loc="upper left", bbox_to_anchor=(0, 1), ncols=columns, handletextpad=0.3, columnspacing=1.4, labelspacing=0.3, borderaxespad=0.1
    )

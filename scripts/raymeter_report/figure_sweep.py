"""Speed against one setting: instruction set, packet size or threads."""

import math
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from .cells import SETTING, Cell, at_setting, main_setting, rays_of, setting_key, techniques_of
from .figure_dots import COLUMNS, add_legend
from .numbers import axis_number, geometric_mean, shortened
from .records import Value
from .style import INK, PAGE_WIDTH, Look, new_figure, scale_axis


@dataclass(frozen=True)
class Sweep:
    """Speed-up over the first value of a setting, per ray kind and technique, one series per scene."""

    column: str
    values: list[Value]
    setting: dict[str, Value]
    series: dict[tuple[str, str], dict[str, dict[Value, float]]]  # (rays, technique) -> scene -> value -> speed-up

    def mean(self, rays: str, technique: str) -> dict[Value, float]:
        """Geometric mean over the scenes that have every value which any scene of this technique has."""
        scenes = self.series.get((rays, technique), {})
        reach = {value for one in scenes.values() for value in one}
        complete = [one for one in scenes.values() if set(one) == reach]
        return {value: geometric_mean([one[value] for one in complete]) for value in self.values if complete and value in reach}


def sweep(cells: Sequence[Cell], column: str) -> Sweep | None:
    """The sweep over `column` with all other settings fixed where most of it was measured; None where nothing was swept."""
    timed = [cell for cell in cells if cell.state == "ok" and (cell.number("mrays_per_s") or 0) > 0]
    others = [name for name in SETTING if name != column]
    groups: dict[tuple[Value, ...], Counter] = defaultdict(Counter)
    for cell in timed:
        groups[tuple(cell.summary[name] for name in others)][cell.label, cell.scene, cell.rays] += 1
    main = main_setting(cells)

    def worth(fixed: tuple[Value, ...]) -> tuple[int, int]:
        swept = sum(1 for count in groups[fixed].values() if count > 1)
        return swept, sum(main.get(name) == value for name, value in zip(others, fixed))

    if not groups:
        return None
    fixed = max(groups, key=worth)
    if worth(fixed)[0] == 0:
        return None
    setting = dict(zip(others, fixed))
    chosen = at_setting(timed, setting)
    values = sorted({cell.summary[column] for cell in chosen}, key=setting_key(column))
    speeds: dict[tuple[str, str], dict[str, dict[Value, float]]] = defaultdict(lambda: defaultdict(dict))
    for cell in chosen:
        speeds[cell.rays, cell.label][cell.scene][cell.summary[column]] = cell.number("mrays_per_s") or math.nan
    series = {
        key: {scene: {value: speed / one[values[0]] for value, speed in one.items()} for scene, one in scenes.items() if values[0] in one and len(one) > 1}
        for key, scenes in speeds.items()
    }
    return Sweep(column, values, setting, {key: scenes for key, scenes in series.items() if scenes})


def sweep_figure(data: Sweep, cells: Sequence[Cell], looks: dict[str, Look], axis: str, ideal: bool = False) -> Figure:
    """One panel per ray kind: lines are geometric means over scenes, faint marks single scenes, `ideal` a line of perfect scaling."""
    kinds = [rays for rays in rays_of(cells) if any(key[0] == rays for key in data.series)]
    columns = min(COLUMNS, len(kinds))
    rows = math.ceil(len(kinds) / columns)
    figure = new_figure(PAGE_WIDTH if columns > 1 else PAGE_WIDTH * 0.62, 2.3 * rows + 0.35)
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    techniques = [label for label in techniques_of(cells) if any(key[1] == label for key in data.series)]
    place = {value: float(i) for i, value in enumerate(data.values)}
    every = [speed for scenes in data.series.values() for one in scenes.values() for speed in one.values()]
    first = data.values[0] if isinstance(data.values[0], float) else 1.0
    perfect = [value / first if isinstance(value, float) else 1.0 for value in data.values]
    for axes, rays in zip(grid.flat, kinds):
        axes.set_title(shortened(rays), loc="left")
        axes.set_xlabel(axis)
        axes.grid(axis="y")
        axes.set_axisbelow(True)
        axes.axhline(1.0, color=INK, linewidth=0.6, alpha=0.5)
        if ideal:
            axes.plot(list(place.values()), perfect, color=INK, linewidth=0.8, linestyle=(0, (4, 3)), alpha=0.7)
        for i, label in enumerate(techniques):
            look = looks[label]
            shift = 0.05 * (i - (len(techniques) - 1) / 2)  # so that equal speed-ups stay visible
            for one in data.series.get((rays, label), {}).values():
                points = [(place[value] + shift, speed) for value, speed in one.items()]
                axes.plot(*zip(*points), linestyle="none", marker=look.marker, markersize=3, color=look.colour, alpha=0.5, markeredgewidth=0)
            mean = data.mean(rays, label)
            axes.plot([place[value] + shift for value in mean], list(mean.values()), color=look.colour, marker=look.marker, markersize=5, linewidth=1.4)
        axes.set_xlim(-0.3, len(place) - 0.7)
        axes.xaxis.set_major_locator(FixedLocator(list(place.values())))
        axes.xaxis.set_minor_locator(NullLocator())
        names = [value if isinstance(value, str) else axis_number(float(value or 0)) for value in data.values]
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _, names=names: names[round(x)] if 0 <= round(x) < len(names) else ""))
        scale_axis(axes, "y", every + (perfect if ideal else []))
    for axes in list(grid.flat)[len(kinds) :]:
        axes.set_visible(False)
    for axes in grid[:, 0]:
        axes.set_ylabel("speed-up")
    add_legend(figure, techniques, looks)
    return figure

"""Primitive tests per ray against time per ray, and the samples in the order in which they were taken."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text

from .figure_dots import COLUMNS, add_legend
from .numbers import axis_number, shortened
from .style import INK, PAGE_WIDTH, PAPER, Look, new_figure, scale_axis

CROWDED = 30  # points in a panel from which on single scenes are no longer named
# Places for a label around its mark: offset in points, alignment.
LABEL_PLACES = (
    (5, 0, "left", "center"),
    (-5, 0, "right", "center"),
    (0, 5, "center", "bottom"),
    (0, -5, "center", "top"),
    (4, 4, "left", "bottom"),
    (4, -4, "left", "top"),
)
Box = tuple[float, float, float, float]  # left, bottom, right, top in pixels
MANY = 2000  # marks from which on they are stored as pixels
GUIDES_NS = (0.1, 1.0, 10.0, 100.0, 1000.0)


@dataclass(frozen=True)
class Point:
    """A cell in the plane of tests and time."""

    rays: str
    technique: str
    scene: str
    tests: float
    nanoseconds: float


def off_scale(points: Sequence[Point]) -> dict[str, tuple[float, float]]:
    """Techniques that would squeeze all others into a corner, because even their least tests are ten times the others' most: name -> range."""
    ranges: dict[str, tuple[float, float]] = {}
    for point in points:
        low, high = ranges.get(point.technique, (point.tests, point.tests))
        ranges[point.technique] = (min(low, point.tests), max(high, point.tests))
    ordered = sorted(ranges, key=lambda label: ranges[label][1])
    for i, label in enumerate(ordered[1:], 1):
        if all(ranges[far][0] > 10 * ranges[ordered[i - 1]][1] for far in ordered[i:]):
            return {far: ranges[far] for far in ordered[i:]}
    return {}


def scatter_figure(points: Sequence[Point], kinds: Sequence[str], looks: dict[str, Look]) -> Figure:
    """One panel per ray kind on common logarithmic axes, with lines of constant time per test. Techniques off the scale stand in the legend."""
    far = off_scale(points)
    notes = {label: f" (off the scale: {axis_number(float(f'{low:.2g}'))} to {axis_number(float(f'{high:.2g}'))} tests)" for label, (low, high) in far.items()}
    columns = min(COLUMNS, len(kinds)) if len(kinds) != 4 else 2
    rows = math.ceil(len(kinds) / columns)
    width = PAGE_WIDTH if columns > 1 else PAGE_WIDTH * 0.7
    figure = new_figure(width, rows * (3.0 if columns > 1 else 3.4) + 0.35)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    techniques = [label for label in looks if any(point.technique == label for point in points)]
    add_legend(figure, [label for label in techniques if label not in far] + list(far), looks, notes=notes)
    points = [point for point in points if point.technique not in far]
    for axes, rays in zip(grid.flat, kinds):
        axes.set_title(shortened(rays), loc="left")
        axes.grid(True)
        axes.set_axisbelow(True)
        for point in (point for point in points if point.rays == rays):
            look = looks[point.technique]
            axes.plot(
                [point.tests],
                [point.nanoseconds],
                linestyle="none",
                marker=look.marker,
                color=look.colour,
                markersize=5.5,
                markeredgecolor=PAPER,
                markeredgewidth=0.5,
            )
    _log_limits(grid.flat[0], "x", [point.tests for point in points])
    _log_limits(grid.flat[0], "y", [point.nanoseconds for point in points])
    for axes in list(grid.flat)[len(kinds) :]:
        axes.set_visible(False)
    for axes in grid[-1, :]:
        axes.set_xlabel("primitive tests per ray")
    for axes in grid[:, 0]:
        axes.set_ylabel("time per ray [ns]")
    figure.draw_without_rendering()  # fixes the layout, which labels are placed in
    for axes, rays in zip(grid.flat, kinds):
        here = [point for point in points if point.rays == rays]
        taken = [mark_box(axes, point) for point in here]
        draw_guides(axes, taken)
        if len(here) <= CROWDED:
            name_scenes(axes, here, taken)
    return figure


def _log_limits(axes: Axes, axis: str, values: Sequence[float]) -> None:
    """Logarithmic limits of at least a decade and a half, with room for labels."""
    low, high = min(values), max(values)
    missing = max(1.0, 10.0 / (high / low)) ** 0.5
    scale_axis(axes, axis, [low / missing / 1.3, high * missing * (1.8 if axis == "x" else 1.3)], ratio=0.0)


def mark_box(axes: Axes, point: Point) -> Box:
    """The place of a mark in pixels."""
    x, y = axes.transData.transform((point.tests, point.nanoseconds))
    half = 0.045 * axes.figure.dpi
    return x - half, y - half, x + half, y + half


def fits(axes: Axes, text: Text, taken: list[Box]) -> bool:
    """Whether a text lies inside the panel and on nothing; if so its place is taken, else it is removed."""
    x0, y0, x1, y1 = text.get_window_extent(axes.figure.canvas.get_renderer()).extents
    frame = axes.get_window_extent()
    inside = x0 >= frame.x0 and x1 <= frame.x1 and y0 >= frame.y0 and y1 <= frame.y1
    if inside and not any(x0 < other[2] and other[0] < x1 and y0 < other[3] and other[1] < y1 for other in taken):
        taken.append((x0, y0, x1, y1))
        return True
    text.remove()
    return False


def draw_guides(axes: Axes, taken: list[Box]) -> None:
    """Faint diagonals on which a primitive test costs 1, 10, ... ns, named near their upper end where there is room."""
    (x_low, x_high), (y_low, y_high) = axes.get_xlim(), axes.get_ylim()
    frame = axes.get_window_extent()
    angle = math.degrees(math.atan2(frame.height / math.log(y_high / y_low), frame.width / math.log(x_high / x_low)))
    for cost in GUIDES_NS:
        axes.plot([x_low, x_high], [x_low * cost, x_high * cost], color=INK, alpha=0.35, linewidth=0.6, linestyle=(0, (1, 2)))
        begin, end = max(x_low, y_low / cost), min(x_high, y_high / cost)
        for place in (0.97, 0.85, 0.7, 0.55, 0.4) if end > begin else ():
            x = begin * (end / begin) ** place
            name = f"{axis_number(cost)} ns/test"
            text = axes.text(x, x * cost, name, rotation=angle, rotation_mode="anchor", ha="right", va="bottom", fontsize=5.8, alpha=0.8)
            if fits(axes, text, taken):
                break
    axes.set_xlim(x_low, x_high)
    axes.set_ylim(y_low, y_high)


def name_scenes(axes: Axes, points: Sequence[Point], taken: list[Box]) -> None:
    """Names the scene beside each mark where there is room, once where marks of one scene lie together."""
    named: dict[str, list[Box]] = {}
    near = 0.15 * axes.figure.dpi
    for point in sorted(points, key=lambda point: point.tests, reverse=True):
        box = mark_box(axes, point)
        if any(abs(box[0] - other[0]) < near and abs(box[1] - other[1]) < near for other in named.get(point.scene, [])):
            continue
        name = shortened(point.scene.removeprefix("spd:").removeprefix("gen:"), 16)
        for dx, dy, horizontal, vertical in LABEL_PLACES:
            anchor = (point.tests, point.nanoseconds)
            text = axes.annotate(name, anchor, (dx, dy), textcoords="offset points", ha=horizontal, va=vertical, fontsize=6)
            if fits(axes, text, taken):
                named.setdefault(point.scene, []).append(box)
                break


def run_order_figure(samples: Sequence[tuple[float, float, str]], looks: dict[str, Look]) -> Figure:
    """Samples as (order, time relative to the median of their cell, technique): a level cloud around 1 is a quiet machine."""
    figure = new_figure(PAGE_WIDTH, 2.3)
    axes = figure.subplots()
    techniques = [label for label in looks if any(sample[2] == label for sample in samples)]
    for label in techniques:
        own = [(order, relative) for order, relative, technique in samples if technique == label]
        pixels = len(samples) > MANY
        mark = {"marker": looks[label].marker, "color": looks[label].colour, "markersize": 2.6, "alpha": 0.6, "markeredgewidth": 0}
        axes.plot(*zip(*own), linestyle="none", rasterized=pixels, **mark)
    axes.axhline(1.0, color=INK, linewidth=0.6)
    ratios = [relative for _, relative, _ in samples]
    spread = max(max(ratios), 1 / min(ratios), 1.1) ** 1.1
    if spread > 1.8:
        scale_axis(axes, "y", [1 / spread, spread], ratio=0.0)
    else:
        axes.set_ylim(2 - spread, spread)
    axes.set_xlabel("place in the run's order of samples")
    axes.set_ylabel("time / median of its cell")
    axes.grid(axis="y")
    add_legend(figure, techniques, looks)
    return figure

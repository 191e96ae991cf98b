"""Look of all figures: sizes for a two-column paper, one colour and marker per technique, text that stays text."""

import colorsys
import io
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.sax.saxutils import escape

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator

from .cells import Cell, rank, techniques_of
from .numbers import axis_number

PAGE_WIDTH = 7.0  # inches, two columns of a paper
INK = "#24292f"  # text, axes; in the page it follows the reader's colour scheme
PAPER = "#fefefe"  # edges of markers that separate them from what lies below; also follows the scheme
NEUTRAL_INK = "#787d84"  # equal contrast on white and on near-black
# After Okabe and Ito, safe for colour-blind readers; the light ones are darkened to 3:1 against white, and all keep 3:1 against near-black.
STRUCTURE_COLOURS = {
    "list": "#8c8c8c",
    "bvh": "#0072b2",
    "grid": "#d55e00",
    "recursive_grid": "#7b5ea7",
    "octree": "#009e73",
    "kdtree": "#cc79a7",
    "bsp": "#c28800",
    "ray_classification": "#2f9bcf",
    "embree": "#7a7200",
}
SPARE_COLOURS = ("#8a5a3c", "#4d4d9f", "#a3541f")
MARKERS = "osD^vPX<>ph*"

RC = {
    "font.family": "DejaVu Sans",  # comes with matplotlib: the same picture on every machine
    "font.size": 8,
    "axes.titlesize": 8.5,
    "axes.titleweight": "bold",
    "axes.labelsize": 8,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.parse_math": False,  # a $ in a scene's path is a $
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": INK,
    "axes.titlecolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "grid.color": INK,
    "grid.alpha": 0.16,
    "grid.linewidth": 0.5,
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
    "svg.fonttype": "none",
    "svg.hashsalt": "raymeter",
    "pdf.fonttype": 42,
    "figure.dpi": 100,
}


@dataclass(frozen=True)
class Look:
    """How one technique is drawn in every figure."""

    colour: str
    marker: str
    filled: bool = True

    def mark(self, size: float) -> dict[str, object]:
        """How matplotlib is to draw a mark; filled ones have an edge that sets them off from what lies below."""
        face, edge, width = (self.colour, PAPER, 0.4) if self.filled else (PAPER, self.colour, 1.0)
        return {"marker": self.marker, "markersize": size, "markerfacecolor": face, "markeredgecolor": edge, "markeredgewidth": width}


def shade(colour: str, amount: float) -> str:
    """The colour with its lightness moved towards white (amount > 0) or black (amount < 0)."""
    red, green, blue = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    hue, light, saturation = colorsys.rgb_to_hls(red, green, blue)
    light += (1 - light) * amount if amount > 0 else light * amount
    return "#" + "".join(f"{round(255 * part):02x}" for part in colorsys.hls_to_rgb(hue, light, saturation))


def looks(cells: Sequence[Cell]) -> dict[str, Look]:
    """One colour per structure, its variants as shades with their own markers."""
    labels = techniques_of(cells)
    structure_of = {cell.label: cell.technique[0] for cell in cells}
    structures = sorted(set(structure_of.values()), key=lambda name: rank(list(STRUCTURE_COLOURS), name))
    spare = (name for name in structures if name not in STRUCTURE_COLOURS)
    base = {**STRUCTURE_COLOURS, **{name: SPARE_COLOURS[i % len(SPARE_COLOURS)] for i, name in enumerate(spare)}}
    result: dict[str, Look] = {}
    for place, structure in enumerate(structures):
        variants = [label for label in labels if structure_of[label] == structure]
        for i, label in enumerate(variants):
            amount = 0.0 if len(variants) == 1 else -0.3 + 0.85 * i / (len(variants) - 1)
            marker = MARKERS[(place + i) % len(MARKERS)]
            result[label] = Look(shade(base[structure], amount), marker)
    return result


def new_figure(width: float, height: float, layout: str | None = "constrained") -> Figure:
    """A figure in the common style; `matplotlib.rc_context(RC)` must be active (see `styled`). Without a layout the caller places the panels."""
    figure = Figure(figsize=(width, height), layout=layout)
    FigureCanvasAgg(figure)  # measures text, so that labels can be placed where there is room
    return figure


def styled() -> "matplotlib.RcParams":
    """Context in which figures are made and saved."""
    return matplotlib.rc_context(RC)


def scale_axis(axes: Axes, axis: str, values: Sequence[float], ratio: float = 15.0, max_ticks: int = 6) -> None:
    """A logarithmic axis where the positive values span more than `ratio`, else a linear one from 0; at most `max_ticks` named ticks."""
    positive = [value for value in values if value > 0]
    one = axes.xaxis if axis == "x" else axes.yaxis
    set_scale = axes.set_xscale if axis == "x" else axes.set_yscale
    set_limits = axes.set_xlim if axis == "x" else axes.set_ylim
    if not positive:
        one.set_major_locator(NullLocator())
        return
    low, high = min(positive), max(positive)
    if len(positive) == len(values) and high / low > ratio:
        set_scale("log")
        room = (high / low) ** 0.05
        low, high = low / room, high * room
        one.set_major_locator(FixedLocator(log_ticks(low, high, max_ticks)))
        one.set_minor_locator(LogLocator(subs=range(1, 10), numticks=100) if high / low < 1e5 else NullLocator())
        one.set_minor_formatter(NullFormatter())
        set_limits(low, high)
    else:
        set_limits(0, high * 1.08)
        one.set_major_locator(MaxNLocator(nbins=max_ticks - 1, steps=[1, 2, 2.5, 5, 10]))
    one.set_major_formatter(FuncFormatter(lambda value, _: axis_number(value)))


def log_ticks(low: float, high: float, max_ticks: int) -> list[float]:
    """Round values between the limits: 1-2-5 steps if they fit, else every decade, every second one and so on."""
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    fine = [factor * 10.0**decade for decade in range(first, last + 1) for factor in (1, 2, 5)]
    if sum(low <= tick <= high for tick in fine) <= max_ticks:
        return [tick for tick in fine if low <= tick <= high]
    decades = [decade for decade in range(first, last + 1) if low <= 10.0**decade <= high]
    for stride in range(1, len(decades) + 1):
        choices = [[decade for decade in decades if decade % stride == phase] for phase in range(stride)]
        chosen = max(choices, key=lambda choice: (len(choice), 0 in choice))
        if len(chosen) <= max_ticks:
            return [10.0**decade for decade in chosen]
    return []


def save_figure(figure: Figure, folder: Path, name: str, caption: str) -> list[Path]:
    """Writes name.svg (with its caption inside), name.png and name.pdf; PNG and PDF on white, as papers want them."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # the layout stands: all three formats show it, and it is computed once
    svg = folder / f"{name}.svg"
    svg.write_text(svg_of(figure, name, caption), encoding="utf-8")
    paths = [svg]
    for suffix, metadata in (("png", {"Software": None}), ("pdf", {"CreationDate": None})):
        path = folder / f"{name}.{suffix}"
        figure.savefig(path, dpi=200, facecolor="white", metadata=metadata)
        paths.append(path)
    return paths


def svg_of(figure: Figure, name: str, caption: str) -> str:
    """The figure as SVG: no DOCTYPE, the caption as its description, and ids that are unique when several figures stand in one page."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()
    text = re.sub(r"<!DOCTYPE[^>]*>\s*", "", text)
    text = re.sub(r"<metadata>.*?</metadata>", lambda _: f"<desc>{escape(caption)}</desc>", text, flags=re.DOTALL)
    text = text.replace("'DejaVu Sans'", "'DejaVu Sans', Verdana, sans-serif")
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r'href="#', f'href="#{name}-', text)
    return re.sub(r"url\(#", f"url(#{name}-", text)


def inline_svg(svg: str) -> str:
    """An SVG for the page: its ink and paper follow the page's colours, its size the column."""
    text = re.sub(r"<\?xml[^>]*\?>\s*", "", svg)
    text = re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", text, count=1)
    text = re.sub(r'(<svg[^>]*?) height="[^"]*"', r"\1", text, count=1)
    return text.replace(INK, "currentColor").replace(PAPER, "var(--paper)")


def neutral_svg(svg: str) -> str:
    """An SVG that reads on light and on dark pages without a background of its own."""
    return svg.replace(INK, NEUTRAL_INK).replace(PAPER, "none")

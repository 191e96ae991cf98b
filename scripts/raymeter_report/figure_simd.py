"""Speed beside one ray at a time: a panel for each scene and kind of rays, a row for each technique, a mark for each instruction set."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from .cells import ISA_ORDER, Cell, isa_rank, rays_of, scenes_of, techniques_of
from .figure_dots import Dot, Panel, dot_figure
from .records import Run
from .style import MARKERS, STRUCTURE_COLOURS, Look

ISA_COLOURS = dict(zip(ISA_ORDER, (STRUCTURE_COLOURS[name] for name in ("grid", "octree", "bvh", "kdtree"))))
COLUMNS = 2


def against_one_ray(runs: Sequence[Run], cells: Sequence[Cell]) -> list[Cell]:
    """The cells of most rays a packet whose reference differs from them in instruction set and packet size and in nothing else."""
    references = {run.name: run.reference for run in runs}
    found = [cell for cell in cells if set(references.get(cell.run, {})) == {"isa", "packet", "threads"} and cell.state == "ok" and cell.number("ratio_vs_ref")]
    found = [cell for cell in found if references[cell.run]["packet"] == 1 and cell.summary["threads"] == references[cell.run]["threads"]]
    most = max((cell.number("packet") or 1.0 for cell in found), default=1.0)
    return [cell for cell in found if most > 1 and cell.number("packet") == most]


def simd_figure(cells: Sequence[Cell]) -> Figure:
    isas = sorted({str(cell.summary["isa"]) for cell in cells}, key=isa_rank)
    kinds = rays_of(cells)
    panels = []
    for scene in scenes_of(cells):
        for rays in kinds:
            dots = [speed_up(cell) for cell in cells if (cell.scene, cell.rays) == (scene, rays)]
            panels.append(Panel(scene if len(kinds) == 1 else f"{scene}, {rays}", "speed / speed of one ray at a time", dots, line=1.0))
    looks = {isa: Look(ISA_COLOURS.get(isa, STRUCTURE_COLOURS["list"]), MARKERS[i]) for i, isa in enumerate(isas)}
    return dot_figure(panels, dict.fromkeys(row(label) for label in techniques_of(cells)), looks, columns=COLUMNS)


def row(label: str) -> str:
    """A technique's name above its parameters, a line each."""
    return label.replace(":", "\n").replace(",", "\n")


def speed_up(cell: Cell) -> Dot:
    """The inverse of the time against the reference, and of its interval."""
    value, low, high = (cell.number(column) for column in ("ratio_vs_ref", "ratio_hi", "ratio_lo"))
    return Dot(row(cell.label), str(cell.summary["isa"]), 1 / (value or 1.0), low and 1 / low, high and 1 / high)

"""Speed beside one ray at a time: a panel for each scene and kind of rays, a row for each technique, a mark for each instruction set."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from .cells import ISA_ORDER, Cell, isa_rank, rays_of, scenes_of, techniques_of
from .figure_dots import Dot, Panel, dot_figure
from .records import Run
from .style import MARKERS, SPARE_COLOURS, STRUCTURE_COLOURS, Look

ISA_COLOURS = dict(zip(ISA_ORDER, (STRUCTURE_COLOURS["list"], *SPARE_COLOURS)))
COLUMNS = 2


def against_one_ray(runs: Sequence[Run], cells: Sequence[Cell]) -> list[Cell]:
    """Of each run whose reference names instruction set, threads and packets of one ray and nothing else: the cells of as many threads and its largest packets."""
    found = []
    for run in runs:
        if set(run.reference) != {"isa", "packet", "threads"} or run.reference["packet"] != 1:
            continue
        of_run = [cell for cell in cells if cell.run == run.name and cell.summary["threads"] == run.reference["threads"]]
        most = max((cell.number("packet") or 1.0 for cell in of_run), default=1.0)
        found += [cell for cell in of_run if most > 1 and cell.number("packet") == most and (cell.state == "failed" or cell.number("ratio_vs_ref"))]
    return found


def simd_figure(cells: Sequence[Cell]) -> Figure:
    isas = sorted({str(cell.summary["isa"]) for cell in cells}, key=isa_rank)
    kinds = rays_of(cells)
    panels = []
    for scene in scenes_of(cells):
        for rays in kinds:
            here = [cell for cell in cells if (cell.scene, cell.rays) == (scene, rays)]
            panels.append(
                Panel(
                    scene if len(kinds) == 1 else f"{scene}, {rays}",
                    "times as fast as one ray at a time",
                    [speed_up(cell) for cell in here if cell.state == "ok"],
                    [(row(cell), str(cell.summary["isa"])) for cell in here if cell.state != "ok"],
                    line=1.0,
                )
            )
    looks = {isa: Look(ISA_COLOURS.get(isa, STRUCTURE_COLOURS["embree"]), MARKERS[i]) for i, isa in enumerate(isas)}
    rows = dict.fromkeys(row(cell) for label in techniques_of(cells) for cell in cells if cell.label == label)
    return dot_figure(panels, rows, looks, columns=COLUMNS)


def row(cell: Cell) -> str:
    """A technique's name above its parameters, a line each."""
    return cell.label.replace(":", "\n").replace(",", "\n")


def speed_up(cell: Cell) -> Dot:
    """The inverse of the time against the reference, and of its interval."""
    value, low, high = (1 / number if (number := cell.number(column)) else None for column in ("ratio_vs_ref", "ratio_hi", "ratio_lo"))
    assert value is not None
    return Dot(row(cell), str(cell.summary["isa"]), value, low, high)

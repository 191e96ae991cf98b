"""Time beside that of the reference on other rays: a panel for each scene and instruction set, a row for each technique, a mark for each packet size."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from .cells import Cell, finite, techniques_of
from .figure_dots import Dot, Panel, dot_figure
from .records import Run
from .style import MARKERS, STRUCTURE_COLOURS, Look

LIMIT = 1.5  # what invalid rays may cost
PACKET_COLOURS = [colour for name, colour in STRUCTURE_COLOURS.items() if name != "list"]


def against_other_rays(runs: Sequence[Run], cells: Sequence[Cell]) -> list[Cell]:
    """The cells whose reference differs in the kind of rays and in nothing else."""
    references = {run.name: run.reference for run in runs}
    return [
        cell
        for cell in cells
        if list(references.get(cell.run, {})) == ["rays"] and cell.summary["rays"] != references[cell.run]["rays"] and cell.number("ratio_vs_ref")
    ]


def reference_figure(cells: Sequence[Cell]) -> Figure:
    packets = sorted({finite(cell.summary["packet"]) or 1.0 for cell in cells})
    names = {packet: f"packets of {packet:g}" if packet > 1 else "rays one by one" for packet in packets}
    scenes, isas = (list(dict.fromkeys(cell.summary[key] for cell in cells)) for key in ("scene", "isa"))
    panels = []
    for scene in scenes:
        for isa in isas:
            dots = [
                Dot(cell.label, names[finite(cell.summary["packet"]) or 1.0], cell.number("ratio_vs_ref") or 0.0, cell.number("ratio_lo"), cell.number("ratio_hi"))
                for cell in cells
                if (cell.scene, cell.summary["isa"]) == (scene, isa)
            ]
            panels.append(Panel(f"{scene.rpartition(':')[0] or scene}, {isa}" if len(scenes) > 1 else f"{isa}", "time / time without", dots, line=1.0, limit=LIMIT))
    looks = {names[packet]: Look(PACKET_COLOURS[i], MARKERS[i]) for i, packet in enumerate(packets)}
    return dot_figure(panels, dict.fromkeys(techniques_of(cells)), looks, columns=len(isas))

"""How many times as fast as the peer's best mode and its best robust mode: a panel for each ray kind and instruction set, a row for each scene."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from .cells import Cell, at_setting, isa_rank, main_setting, rays_of, scenes_of
from .figure_dots import Dot, Panel, dot_figure
from .peer import KINDS, MEAN, Duel, duels, means
from .style import Look

AGAINST = {"fast": "against the best mode", "robust": "against the best robust mode"}


def peer_duels(cells: Sequence[Cell]) -> dict[str, list[Duel]]:
    """Those at the setting at which figures compare, on every instruction set."""
    chosen = {id(cell) for cell in at_setting(cells, main_setting([cell for cell in cells if not cell.is_peer]), free="isa")}
    return {kind: [duel for duel in of_kind if id(duel.cell) in chosen] for kind, of_kind in duels(cells).items()}


def peer_figure(found: dict[str, list[Duel]], sizes: dict[str, float | None], looks: dict[str, Look]) -> Figure:
    """`sizes` gives each scene's number of primitives."""
    cells = [duel.cell for kind in KINDS for duel in found[kind]]
    averages = {kind: means(found[kind]) for kind in KINDS}
    kinds = rays_of(cells)
    panels = []
    for isa in sorted({cell.summary["isa"] for cell in cells}, key=isa_rank, reverse=True):
        for rays in kinds:
            dots = [
                Dot(duel.cell.scene, f"{duel.cell.label} {AGAINST[kind]}", duel.ratio.value, duel.ratio.low, duel.ratio.high)
                for kind in KINDS
                for duel in found[kind]
                if (duel.cell.rays, duel.cell.summary["isa"]) == (rays, isa)
            ]
            dots += [
                Dot(MEAN, f"{label} {AGAINST[kind]}", value)
                for kind in KINDS
                for (of_rays, of_isa, label), value in averages[kind].items()
                if (of_rays, of_isa) == (rays, isa)
            ]
            panels.append(Panel(rays, f"times as fast, {isa}", dots, line=1.0))
    rows: dict[str, float | None] = {scene: sizes.get(scene) for scene in scenes_of(cells)}
    if any(averages.values()):
        rows[MEAN] = None
    labels = [label for label in looks if any(cell.label == label for cell in cells)]
    marks = {f"{label} {AGAINST[kind]}": Look(looks[label].colour, looks[label].marker, kind == "fast") for label in labels for kind in KINDS}
    return dot_figure(panels, rows, marks, columns=len(kinds))

"""All figures of a report: which exist for the data at hand, and their files."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from .cells import Cell, at_setting, describe_setting, main_setting, rays_of
from .drafts import (
    Draft, best_drafts, build_draft, counter_draft, error_draft, memory_draft, peer_draft, precision_draft, price_draft, price_list_draft, run_order_draft,
    scaling_draft, scatter_draft, simd_draft, speed_draft, sweep_drafts, wrong_draft,
)
from .drafts_numerics import bounds_draft, cases_draft, offsets_draft, reference_draft, walks_draft
from .records import Run
from .style import inline_svg, looks, neutral_svg, save_figure, styled, svg_of


@dataclass(frozen=True)
class Plot:
    """A figure that was written, ready to be placed in a report."""

    name: str
    title: str
    caption: str
    inline: str = ""
    files: list[Path] = field(default_factory=list)


def write_plots(runs: Sequence[Run], cells: Sequence[Cell], folder: Path) -> list[Plot]:
    """Draws every figure that the data allow and writes each as SVG, PNG and PDF into `folder`."""
    plots: list[Plot] = []
    folder.mkdir(parents=True, exist_ok=True)
    with styled():
        for draft in drafts(runs, cells):
            files = save_figure(draft.figure, folder, draft.name, draft.caption)
            plots.append(Plot(draft.name, draft.title, draft.caption, inline_svg(files[0].read_text(encoding="utf-8")), files))
    return plots


def drafts(runs: Sequence[Run], cells: Sequence[Cell]) -> list[Draft]:
    """The figures in the order of the report."""
    look_of = looks(cells)
    setting = main_setting(cells)
    chosen = at_setting(cells, setting)
    where = describe_setting(setting)
    result: list[Draft | None] = [
        counter_draft(
            "tests_per_ray", "Primitive tests per ray", "prim_tests_per_ray", chosen, look_of,
            f"Ray-primitive tests per ray (N_IT in the literature) at {where}. Further left is better: fewer candidates reach the exact test. "
            "A technique whose marks stay in place from the small scenes at the top to the large ones at the bottom scales well.",
        ),
        counter_draft(
            "node_visits_per_ray", "Node visits per ray", "node_visits_per_ray", chosen, look_of,
            f"Interior nodes opened or cells stepped into per ray (N_TS of a grid; a tree's leaves come on top) at {where}. "
            "This is the price paid for saving tests: read it beside the previous figure. "
            "A node of one structure may cost several times one of another; a technique without nodes has no mark.",
        ),
        speed_draft(cells, chosen, look_of, where),
        scatter_draft(chosen, look_of, where),
        build_draft(chosen, look_of),
        peer_draft(cells, look_of),
        *best_drafts(cells, look_of),
        simd_draft(runs, cells),
        *sweep_drafts(cells, look_of),
        scaling_draft(cells, look_of),
        price_list_draft(runs, cells),
        memory_draft(cells, look_of),
        error_draft(cells, look_of),
        precision_draft(cells),
        price_draft(cells),
        wrong_draft(cells, look_of),
        cases_draft(cells),
        reference_draft(runs, cells),
        offsets_draft(cells),
        walks_draft(cells),
        bounds_draft(cells),
        run_order_draft(runs, cells, look_of),
    ]
    return [draft for draft in result if draft is not None]


README_FIGURE = "tests_vs_time"


def readme_figure(runs: Sequence[Run], cells: Sequence[Cell], name: str = README_FIGURE, kinds: int = 3) -> str | None:
    """A figure as SVG that reads on light and dark pages; None where the data do not give it. That of tests and time has the first ray kinds only."""
    with styled():
        if name == README_FIGURE:
            setting = main_setting(cells)
            chosen = [cell for cell in at_setting(cells, setting) if cell.rays in rays_of(cells)[:kinds]]
            draft = scatter_draft(chosen, looks(cells), describe_setting(setting))
        else:
            draft = next((one for one in drafts(runs, cells) if one.name == name), None)
        return None if draft is None else neutral_svg(svg_of(draft.figure, "raymeter", draft.caption))

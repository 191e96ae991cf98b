"""The figures of hard cases and of rays that are held against others; none where the data do not give it."""

from collections.abc import Sequence

from .cells import Cell, describe_setting, main_setting
from .drafts import Draft
from .figure_bounds import bounds_figure, quantised_boxes
from .figure_cases import cases_figure, cells_of_cases
from .figure_offsets import lifted_rays, offsets_figure
from .figure_reference import against_other_rays, reference_figure
from .figure_walks import walks, walks_figure
from .records import Run


def cases_draft(cells: Sequence[Cell]) -> Draft | None:
    """Wrong answers to hard cases; None where there were none of these."""
    if not cells_of_cases(cells):
        return None
    caption = (
        "Wrong answers to hard cases: false misses, false hits, wrong primitives and hits of the surface that a ray leaves, the worst over instruction sets and packet sizes. "
        "The colour deepens with the share of rays that they are of, on a logarithmic scale from 1 in a million; 0 has none. Grey and in brackets: within the errors that raymeter's kernels declare "
        "(underflow, or coordinates beyond the supported range). Where a field is empty the technique was not run. raymeter list scenes says "
        "what each case is."
    )
    return Draft("hard_cases", "Hard cases", caption, cases_figure(cells))


def reference_draft(runs: Sequence[Run], cells: Sequence[Cell]) -> Draft | None:
    """Time against that of the same technique on other rays; None where no config asks for it."""
    found = against_other_rays(runs, cells)
    if not found:
        return None
    of = next(run.reference["rays"] for run in runs if run.name == found[0].run)
    kinds = " and ".join(dict.fromkeys(cell.rays for cell in found))
    caption = (
        f"What {kinds} rays cost: their time relative to that of {of} rays, by the same technique in the same run. At 1 both take as long; the dashed line is the limit, half as long again. "
        "Bars are 95 % confidence intervals of the median ratio."
    )
    return Draft("time_against_other_rays", f"Time of {kinds} rays against {of} rays", caption, reference_figure(found))


def offsets_draft(cells: Sequence[Cell]) -> Draft | None:
    """Secondary rays by the rule of their origins; None where only one was measured."""
    panels = lifted_rays(cells)
    if not panels:
        return None
    where = describe_setting(main_setting([one.cell for of_panel in panels.values() for one in of_panel]))
    caption = (
        f"How far to lift the origin of a secondary ray off the surface that it leaves, at {where}. Too little: rays meet that surface again. Too much: rays begin beyond "
        "what touches it, or beside it. Fixed: in the scene's units; ulp: units in the last place of the point's largest coordinate. The proven bound (what rounding may "
        "do to this primitive, seen from that far) is the default, and what the other rules' answers are held against: far from the origin, where it has to lift far itself, a diamond also says that another lift meets another triangle. What stands at none had no such ray."
    )
    return Draft("origin_offsets", "Where secondary rays begin", caption, offsets_figure(panels))


def walks_draft(cells: Sequence[Cell]) -> Draft | None:
    """What the walk through a grid errs by the form of its DDA; None where only one was held against exact cells."""
    panels = walks(cells)
    if not panels:
        return None
    where = describe_setting(main_setting([walk.cell for of_panel in panels.values() for walk in of_panel]))
    caption = (
        f"What the walk through a grid errs by how it comes by the next plane's t, at {where}: recompute, divide and fma from the plane's index; accumulate adds up steps (Amanatides and Woo), "
        "compensated adds what the sum has lost. Held against the cells that rays exactly pass through. Above: the longest way of any ray in a cell that it should have visited and did not, by cells a "
        "side; circled where it is longer than lists reach beyond their cells, so that a hit may be lost. Below: speed relative to recompute through the same grid, against the share of rays that miss any cell at all; lines "
        "go from the coarsest grid to the finest, which has the large marks and, in grey, the front: there nothing else is faster and errs less. What stands at 0 missed none. Bars are 95 % confidence intervals of the "
        "median ratio."
    )
    return Draft("dda_forms", "Forms of the DDA", caption, walks_figure(panels))


def bounds_draft(cells: Sequence[Cell]) -> Draft | None:
    """Boxes in whole steps beside those in floats; None where only these were measured."""
    panels = quantised_boxes(cells)
    if not panels:
        return None
    where = describe_setting(main_setting([one.cell for of_panel in panels.values() for one in of_panel]))
    caption = (
        f"Boxes of nodes in whole steps of the box around them, rounded outwards, beside the same boxes in floats, at {where}. No answer changes: what errs is the box, which more rays meet. Above: visits of nodes by the "
        "bits of a plane, a mark for each scene, lines through geometric means; below the bits the bytes of a primitive, nodes and leaves together. Below: speed against the nodes that are visited in excess, named by "
        "their bits: small marks are the scenes, with 95 % confidence intervals of the median ratio, large ones geometric means; floats stand at 0 % and 1. Above 1 the smaller nodes are faster."
    )
    return Draft("quantised_bounds", "Boxes in whole steps", caption, bounds_figure(panels))

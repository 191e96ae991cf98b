"""The figures of hard cases and of rays that are held against others; none where the data do not give it."""

from collections.abc import Sequence

from .cells import Cell
from .drafts import Draft
from .figure_cases import cases_figure, cells_of_cases
from .figure_reference import against_other_rays, reference_figure
from .records import Run


def cases_draft(cells: Sequence[Cell]) -> Draft | None:
    """Wrong answers to hard cases; None where there were none of these."""
    if not cells_of_cases(cells):
        return None
    caption = (
        "Wrong answers to hard cases: false misses, false hits, wrong primitives and hits of the surface that a ray leaves, the worst over instruction sets and packet sizes. "
        "The colour deepens with the share of rays that they are of, on a logarithmic scale from 1 in a million; 0 has none. Grey and in brackets: within the errors that raymeter's kernels declare "
        "(underflow, coordinates beyond the supported range, or as many as are published for the formula). Where a field is empty the technique was not run. raymeter list scenes says "
        "what each case is."
    )
    return Draft("hard_cases", "Hard cases", caption, cases_figure(cells))


def reference_draft(runs: Sequence[Run], cells: Sequence[Cell]) -> Draft | None:
    """Time against that of the same technique on other rays; None where no config asks for it."""
    found = against_other_rays(runs, cells)
    if not found:
        return None
    of = next(run.manifest["config_text"]["measure"]["reference"]["rays"] for run in runs if run.name == found[0].run)
    kinds = " and ".join(dict.fromkeys(cell.rays for cell in found))
    caption = (
        f"What {kinds} rays cost: their time relative to that of {of} rays, by the same technique in the same run. At 1 both take as long; at the limit of 1.5 half as long again. "
        "Bars are 95 % confidence intervals of the median ratio."
    )
    return Draft("time_against_other_rays", f"Time of {kinds} rays against {of} rays", caption, reference_figure(found))

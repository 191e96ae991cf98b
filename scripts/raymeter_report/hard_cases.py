"""What each technique makes of the hard cases."""

from collections.abc import Sequence

from .cells import Cell, finite, techniques_of
from .numbers import integer, significant
from .table import Column, Field, Table

WRONG = ("false_miss", "false_hit", "wrong_prim")


def hard_cases_table(cells: Sequence[Cell]) -> Table:
    """Case by technique: misses, false hits, wrong primitives, and how far t is off; the worst of all settings."""
    cells = [cell for cell in cells if cell.summary["rays"] == "case" and cell.accuracy]
    labels = techniques_of(cells)
    columns = [Column("case", number=False), Column("rays"), *(Column(label) for label in labels)]
    rows = []
    for scene in dict.fromkeys(cell.scene for cell in cells):
        of_scene = [cell for cell in cells if cell.scene == scene]
        rays = max(finite(cell.accuracy.get("rays_checked")) or 0 for cell in of_scene)
        fields = [case_field([cell for cell in of_scene if cell.label == label]) for label in labels]
        rows.append([Field(scene.removeprefix("hard:")), Field(integer(rays), rays), *fields])
    caption = (
        "Hard cases: misses / false hits / wrong primitives, and the largest error of t in units in the last place (ulp), where t is known by construction or by "
        "the oracle; the worst over instruction sets and packet sizes. A field of its own: rays that hit the flat surface that they leave. Empty: not run. "
        "raymeter list scenes says what each case is."
    )
    return Table("hard-cases", caption, columns, rows)


def case_field(cells: Sequence[Cell]) -> Field:
    """One technique's answers to one case; set off where the answers are not as promised."""
    if not cells:
        return Field("")
    counts = [max(finite(cell.accuracy.get(name)) or 0 for cell in cells) for name in WRONG]
    self_hits = max(finite(cell.accuracy.get("self_hits")) or 0 for cell in cells)
    ulps = [error for cell in cells if (error := finite(cell.accuracy.get("t_ulp_max"))) is not None]
    text = " / ".join(integer(count) for count in counts) if any(counts) else "0"
    text += f", {integer(self_hits)} self-hits" if self_hits else ""
    text += f"; {significant(max(ulps))} ulp" if ulps else ""
    wrong = any(cell.state == "failed" for cell in cells) or (any(counts) and cells[0].technique[0] == "embree")
    return Field(text, sum(counts) + self_hits, "bad" if wrong else "")

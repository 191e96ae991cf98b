"""Pages that people write around what a run has measured: brings their tables and figures up to date and leaves their words alone."""

import re
from collections.abc import Sequence
from pathlib import Path

from .best_settings import summary_tables
from .cells import Cell
from .figures import readme_figure
from .markdown import table_text
from .records import ReportError, Run

BLOCK = re.compile(r"(<!-- table (\S+) -->\n).*?(<!-- end -->)", re.DOTALL)
FIGURE = re.compile(r"\]\((\w+)\.svg\)")


def refresh(page: Path, runs: Sequence[Run], cells: Sequence[Cell]) -> list[Path]:
    """Puts the run's tables between the page's lines `<!-- table NAME -->` and `<!-- end -->`, and its figures, of which the page shows NAME.svg, beside the page.
    Returns the files written; raises ReportError, before it writes any, where the run does not give one of them."""
    text = page.read_text(encoding="utf-8")
    tables = {table.name: table_text(table) for table in summary_tables(cells)}
    names = [name for _, name, _ in BLOCK.findall(text)]
    figures = {name: readme_figure(runs, cells, name) for name in FIGURE.findall(text)}
    lacking = [f"table {name}" for name in names if name not in tables] + [f"figure {name}" for name, figure in figures.items() if figure is None]
    if lacking:
        raise ReportError(f"{page}: what was timed gives no {lacking[0]}")
    if not names and not figures:
        raise ReportError(f"{page}: has neither tables nor figures of a run")
    written = {page: BLOCK.sub(lambda block: f"{block[1]}{tables[block[2]]}\n{block[3]}", text)}
    written |= {page.parent / f"{name}.svg": figure for name, figure in figures.items() if figure is not None}
    for path, content in written.items():
        path.write_text(content, encoding="utf-8")
    return list(written)

"""Command line of scripts/report.py."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from .cells import load_cells
from .document import make_report
from .figures import README_FIGURE, readme_figure
from .html import html
from .markdown import markdown
from .page import refresh
from .records import ReportError, read_run

EPILOG = """example: scripts/report.py results/quick/20261122T170000Z_1a2b3c4_myhost

One folder: report.md, report.html and plots/ are written into it. Several folders, for example shards of one run or the same run of two
commits: one combined report is written into the folder "combined" in the first of them. A technique that several of them measured gets
the name of the folder behind its label.

--page takes a page of words with lines "<!-- table NAME -->" and "<!-- end -->", as results/reference/side_by_side.md."""


def parse_arguments(argv: Sequence[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="report.py", description="Makes a report from results folders of raymeter.", epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folders", nargs="+", type=Path, metavar="DIR", help="results folder")
    parser.add_argument("--out", type=Path, metavar="DIR", help="write the report into this folder")
    parser.add_argument("--readme-figure", type=Path, metavar="OUT.svg", help="write only a figure, as the README has it, to this file")
    parser.add_argument("--page", type=Path, metavar="PAGE.md", help="write only the tables that this page has, into it, and the figures that it shows, beside it")
    parser.add_argument("--figure", default=README_FIGURE, metavar="NAME", help="which one, by its name in plots/ (default: %(default)s)")
    return parser.parse_args(argv)


def main(argv: Sequence[str]) -> int:
    """Exit codes: 0 written, 1 could not write, 2 the input is no results folder or lacks a column."""
    arguments = parse_arguments(argv)
    out = arguments.page or arguments.readme_figure or arguments.out or arguments.folders[0]
    try:
        runs = [read_run(folder) for folder in dict.fromkeys(arguments.folders)]
        if arguments.page:
            print(*refresh(arguments.page, runs, load_cells(runs)), sep="\n")
            return 0
        if arguments.readme_figure:
            figure = readme_figure(runs, load_cells(runs), arguments.figure)
            if figure is None:
                raise ReportError(f"{runs[0].folder}: what was timed gives no figure {arguments.figure}")
            arguments.readme_figure.write_text(figure, encoding="utf-8")
            print(arguments.readme_figure)
            return 0
        out = arguments.out or (runs[0].folder if len(runs) == 1 else runs[0].folder / "combined")
        out.mkdir(parents=True, exist_ok=True)
        report = make_report(runs, out)
        (out / "report.md").write_text(markdown(report, out), encoding="utf-8")
        (out / "report.html").write_text(html(report, out), encoding="utf-8")
        for path in (out / "report.md", out / "report.html", *(file for plot in report.plots for file in plot.files)):
            print(path)
    except ReportError as error:
        print(error, file=sys.stderr)
        return 2
    except BrokenPipeError:
        sys.stdout = None  # whoever reads the paths has read enough, and all files are written
    except OSError as error:
        print(f"{error.filename or out}: {error.strerror}", file=sys.stderr)
        return 1
    return 0

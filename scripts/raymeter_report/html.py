"""The report as one HTML file without any reference to the network."""

import base64
import os
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from .document import Report


def html(report: Report, out: Path) -> str:
    """The whole page; CSS, figures and pictures are inside, links to files are relative to `out`."""
    here = Path(__file__).resolve().parent
    templates = Environment(loader=FileSystemLoader(here), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return templates.get_template("report.html.j2").render(
        report=report,
        style=Markup((here / "report.css").read_text(encoding="utf-8")),
        inline=Markup,
        data_uri=data_uri,
        link=lambda path: Path(os.path.relpath(path, out)).as_posix(),
    )


def data_uri(path: Path) -> str:
    """A PNG as the text of a data URI."""
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode("ascii")

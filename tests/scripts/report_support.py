"""What the tests of the report share: a reader of pages, a runner of the command, a folder for each test."""

import contextlib
import io
import shutil
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

import synthetic_run  # puts scripts/ on the path
from raymeter_report import cli

VOID_TAGS = frozenset("area base br col embed hr img input link meta source track wbr".split())


class Page(HTMLParser):
    """Collects ids, references and tables of a page, and what is not well-formed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.errors: list[str] = []
        self.ids: list[str] = []
        self.references: list[str] = []
        self.tables: dict[str, list[list[str]]] = {}
        self.titles: dict[str, list[str]] = {}
        self._table = ""
        self._text: str | None = None
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        if tag not in VOID_TAGS:
            self.open.append(tag)
        self._take(tag, values)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._take(tag, dict(attrs))

    def _take(self, tag: str, values: dict[str, str | None]) -> None:
        if values.get("id"):
            self.ids.append(values["id"] or "")
        self.references += [values[name] or "" for name in ("src", "href", "xlink:href", "srcset", "data", "action") if name in values]
        if tag == "figure" and values.get("class") == "table":
            self._table = values["id"] or ""
            self.tables[self._table], self.titles[self._table] = [], []
        elif tag == "tr" and self._table:
            self.tables[self._table].append([])
        elif tag in ("td", "th") and self._table:
            self._text = ""

    def handle_data(self, data: str) -> None:
        if self._text is not None:
            self._text += data

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open[-1] != tag:
            self.errors.append(f"line {self.getpos()[0]}: </{tag}> closes {self.open[-1:]}")
        else:
            self.open.pop()
        if tag in ("td", "th") and self._text is not None:
            (self.titles if tag == "th" else {self._table: self.tables[self._table][-1]})[self._table].append(self._text)
            self._text = None
        elif tag == "figure":
            self._table = ""


def run_cli(*arguments: object) -> tuple[int, str, str]:
    """Exit code, stdout and stderr of the command."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = cli.main([str(argument) for argument in arguments])
    return code, out.getvalue(), err.getvalue()


class TemporaryFolder(unittest.TestCase):
    """Gives each test a folder of its own."""

    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="raymeter_report_"))
        self.addCleanup(shutil.rmtree, self.folder)

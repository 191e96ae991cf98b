"""The report as Markdown: the same tables, figures as links."""

import os
from pathlib import Path

from .document import Report
from .table import Field, Table

MARKS = {"good": "✔", "aside": "–", "bad": "✘"}


def markdown(report: Report, out: Path) -> str:
    """The whole file; links are relative to `out`."""
    verdict = "\n".join(f"{MARKS[one.level]} {escape(one.text)}  " for one in report.verdict)
    facts = [f"{escape(fact)} (`{run.name}`)" for fact, run in zip(report.facts, report.runs)]
    parts = [f"# raymeter: {escape(report.title)}", *facts, "## Overview", verdict]
    parts += block(report.best, "### Fastest technique") + block(report.at_their_best, "### Techniques at their best")
    parts += block(report.problems, "### Failed cells")
    parts += block(report.left_out, "### Skipped and unfinished cells") + block(report.techniques, "### Techniques")
    parts += block(report.results, "## Results")
    parts += block(report.peer, "### Beside the peer")
    if report.simd:
        parts += block(report.simd, "### Instruction sets and packets")
    if report.plots:
        parts.append("## Plots")
    for plot in report.plots:
        links = ", ".join(f"[{path.suffix[1:].upper()}]({link(path, out)})" for path in plot.files)
        parts += [f"### {plot.title}", f"![{plot.title}]({link(plot.files[0], out)})", f"{escape(plot.caption)} ({links})"]
    parts += block(report.counters, "## Counters") + block(report.builds, "## Builds") + block(report.scaling, "## Scaling") + block(report.price_list, "## Price list")
    parts += block(report.break_even, "## Break-even")
    parts += block(report.volumes, "## Bounding volumes")
    parts += block(report.frames, "## Frames") + block(report.depth_control, "## Adaptive depth control") + block(report.shadow_cache, "## Shadow cache") + block(report.price, "## Price of robustness")
    parts += block(report.hard_cases, "## Hard cases") + block(report.accuracy, "## Accuracy")
    if report.pictures:
        parts.append("## Images and heat maps")
        parts += [f"![{escape(one.title)}]({link(one.path, out)})\n\n{escape(one.title)}. {escape(one.caption)}" for one in report.pictures]
    parts += ["## Reproduce", "```\n" + "\n".join(report.commands) + "\n```"]
    if report.configuration:
        parts += ["### Configuration", "```json\n" + report.configuration + "\n```"]
    if report.environment:
        names = " | ".join(escape(run.name) for run in report.runs)
        rows = [f"| {escape(name)} | {' | '.join(escape(value) for value in values)} |" for name, values in report.environment]
        parts += ["### Environment", "\n".join([f"| property | {names} |", "|" + "---|" * (len(report.runs) + 1), *rows])]
    parts.append("## Glossary")
    for title, terms in report.glossary.items():
        rows = [f"| `{term.name}` | {term.unit} | {escape(term.meaning)} | {term.symbol}{'' if term.verified else ' (unverified)'} |" for term in terms]
        parts += [f"### {title}", "\n".join(["| column | unit | meaning | symbol |", "|---|---|---|---|", *rows])]
    parts.append(escape(report.symbol_note))
    return "\n\n".join(parts) + "\n"


def block(table: Table, heading: str) -> list[str]:
    """Heading, caption and table; nothing for a table without rows."""
    return [heading, escape(table.caption), table_text(table)] if table.rows else []


def table_text(table: Table) -> str:
    heads = " | ".join(column.title + (f" [{column.unit}]" if column.unit else "") for column in table.columns)
    rules = "|".join("---:" if column.number else "---" for column in table.columns)
    rows = [f"| {' | '.join(field_text(field) for field in row)} |" for row in table.rows]
    return "\n".join([f"| {heads} |", f"|{rules}|", *rows])


def field_text(field: Field) -> str:
    return f"**{escape(field.text)}**" if field.tone and field.text else escape(field.text)


def escape(text: str) -> str:
    """Text that Markdown shows as it is, inside tables as well."""
    for character in "\\|*_<":
        text = text.replace(character, "\\" + character)
    return text.replace("\n", " ")


def link(path: Path, out: Path) -> str:
    return Path(os.path.relpath(path, out)).as_posix().replace(" ", "%20")

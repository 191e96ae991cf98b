"""The content of a report, independent of its form: findings, tables, figures, pictures, how to reproduce it."""

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .best_settings import best_settings_table
from .bounding_volumes import volumes_table
from .break_even import break_even_table
from .cells import Cell, best_cells, finite, load_cells, rays_of, scenes_of, techniques_of
from .figures import Plot, write_plots
from .frames import depth_control_table, frames_table
from .glossary import GLOSSARY, SYMBOL_NOTE, Term
from .hard_cases import hard_cases_table
from .peer import peer_table
from .pictures import Picture, pictures_of
from .price_list import price_list_table
from .records import Run
from .scaling import scaling_table
from .shadow_cache import shadow_cache_table
from .work_precision import price_table
from .table import Table, in_order
from .tables import (
    WRONG, accuracy_table, best_table, builds_table, counters_table, left_out_table, problem_table, results_table, simd_table, technique_table,
)

WIDE_INTERVAL = 0.05  # half width of a confidence interval, relative to the median, from which on a cell counts as noisy


@dataclass(frozen=True)
class Finding:
    """One sentence of the verdict; level is good, aside or bad."""

    level: str
    text: str


@dataclass(frozen=True)
class Report:
    """All that both forms of the report show. Tables without rows are left out by the forms."""

    title: str
    runs: list[Run]
    facts: list[str]
    verdict: list[Finding]
    best: Table
    at_their_best: Table
    problems: Table
    left_out: Table
    techniques: Table
    results: Table
    peer: Table
    simd: Table | None
    counters: Table
    builds: Table
    scaling: Table
    price_list: Table
    break_even: Table
    volumes: Table
    frames: Table
    depth_control: Table
    shadow_cache: Table
    price: Table
    hard_cases: Table
    accuracy: Table
    plots: list[Plot]
    pictures: list[Picture]
    environment: list[tuple[str, list[str]]]
    configuration: str
    commands: list[str]
    glossary: dict[str, list[Term]]
    symbol_note: str


def make_report(runs: Sequence[Run], out: Path) -> Report:
    """Draws the figures into `out`/plots and assembles the content."""
    cells = load_cells(runs)
    order = {
        name: {key: place for place, key in enumerate(keys)}
        for name, keys in (("scene", scenes_of(cells)), ("rays", rays_of(cells)), ("technique", techniques_of(cells)))
    }
    cells = in_order(cells, order)
    reasons = {cell_id: run.reason(cell_id) for run in runs for cell_id in (str(record["cell_id"]) for record in run.tables["summary"])}
    names = list(dict.fromkeys(str(run.manifest.get("name") or run.name) for run in runs))
    return Report(
        title=", ".join(names),
        runs=list(runs),
        facts=[run_facts(run) for run in runs],
        verdict=verdict(runs, cells),
        best=best_table(cells),
        at_their_best=best_settings_table(cells),
        problems=problem_table(cells, reasons),
        left_out=left_out_table(cells, reasons),
        techniques=technique_table(cells),
        results=results_table(cells),
        peer=peer_table(cells),
        simd=simd_table(cells),
        counters=counters_table(cells),
        builds=builds_table(cells),
        scaling=scaling_table(cells),
        price_list=price_list_table(runs, cells),
        break_even=break_even_table(cells),
        volumes=volumes_table(cells),
        frames=frames_table(cells),
        depth_control=depth_control_table(cells),
        shadow_cache=shadow_cache_table(cells),
        price=price_table(cells),
        hard_cases=hard_cases_table(cells),
        accuracy=accuracy_table(cells),
        plots=write_plots(runs, cells, out / "plots"),
        pictures=[picture for run in runs for picture in pictures_of(run)],
        environment=environment_rows(runs),
        configuration=configuration_text(runs),
        commands=commands(runs),
        glossary=GLOSSARY,
        symbol_note=SYMBOL_NOTE,
    )


def verdict(runs: Sequence[Run], cells: Sequence[Cell]) -> list[Finding]:
    """Is the run complete, are the answers right, what was fastest, how far can the times be trusted?"""
    states = Counter(cell.state for cell in cells)
    findings = [completeness(runs, cells, states)]
    if states["failed"]:
        failed = plural(states["failed"], "cell")
        findings.append(Finding("bad", f"{failed} failed: wrong hits, a time-out or an error. They have no timing and are listed below."))
    if states["skipped"]:
        findings.append(Finding("aside", f"{plural(states['skipped'], 'cell')} skipped, listed below with the reason."))
    findings += answers(cells)
    findings += fastest(cells)
    findings += steadiness(runs, cells)
    machines = {str(run.manifest.get("cpu")) + str(run.manifest.get("host")) for run in runs}
    if len(machines) > 1:
        findings.append(Finding("bad", "The runs come from different machines: compare their counters, not their times."))
    return findings


def answers(cells: Sequence[Cell]) -> list[Finding]:
    """What was held against the oracle, and what a peer from outside answered."""
    findings = []
    ours, peers = ([cell for cell in cells if cell.is_peer == peer] for peer in (False, True))
    checked, wrong = rays_checked(ours)
    if checked:
        level, text = ("bad", f"{wrong:,.0f} wrong answers") if wrong else ("good", "No wrong answer")
        findings.append(Finding(level, f"{text} among {checked:,.0f} rays held against the exact oracle."))
    elif cells:
        findings.append(Finding("aside", "No rays were held against the oracle."))
    checked, wrong = rays_checked(peers)
    if checked:
        names = ", ".join(dict.fromkeys(cell.technique[0] for cell in peers))
        findings.append(Finding("aside", f"Of the peer {names}: {wrong:,.0f} wrong answers among {checked:,.0f} rays, listed under accuracy; it is timed all the same."))
    return findings


def rays_checked(cells: Sequence[Cell]) -> tuple[float, float]:
    """Rays that were checked, and wrong answers among them."""

    def total(*names: str) -> float:
        return sum(finite(cell.accuracy.get(name)) or 0.0 for cell in cells for name in names)

    return total("rays_checked"), total(*WRONG)


def steadiness(runs: Sequence[Run], cells: Sequence[Cell]) -> list[Finding]:
    """What limits the trust in the times: wide intervals, few samples, and a machine or build that is known to be unsteady."""
    findings = []
    timed = [cell for cell in cells if cell.number("median_ns_per_ray") is not None]
    noisy = [cell for cell in timed if (interval_half_width(cell) or 0) > WIDE_INTERVAL]
    without = [cell for cell in timed if interval_half_width(cell) is None]
    if noisy:
        wide = f"{plural(len(noisy), 'cell')} of {len(timed)} with a confidence interval wider than ±{WIDE_INTERVAL:.0%} of the median"
        findings.append(Finding("aside", f"{wide}: the machine was not quiet."))
    if without:
        findings.append(Finding("aside", f"{plural(len(without), 'cell')} of {len(timed)} without a confidence interval: too few samples."))
    if cells and not timed:
        findings.append(Finding("aside", "No times: this run took no timed samples."))
    doubts = list(dict.fromkeys(doubt for run in runs for doubt in doubts_of(run.environment)))
    if timed and doubts:
        findings.append(Finding("aside", f"Mind when comparing times: {', '.join(doubts)}."))
    return findings


def doubts_of(environment: dict[str, Any]) -> list[str]:
    """Properties of machine and build that make times unsteady or not comparable. What the environment does not tell is not assumed."""
    build, cpu, frequency = (environment.get(name) or {} for name in ("build", "cpu", "frequency"))
    doubts = []
    if build.get("build_type", "Release") != "Release":
        doubts.append(f"the build was {build['build_type']}, not Release")
    if build.get("git_dirty"):
        doubts.append("the build had uncommitted changes")
    if cpu.get("virtual_machine"):
        doubts.append("the machine is virtual")
    if frequency.get("governor") not in (None, "performance"):
        doubts.append(f"the frequency governor was {frequency['governor']}")
    if frequency.get("turbo"):
        doubts.append("turbo was on")
    if frequency.get("smt"):
        doubts.append("hardware threads share cores")
    return doubts


def run_facts(run: Run) -> str:
    """One line on a run: machine, commit, time."""
    manifest = run.manifest
    dirty = " with uncommitted changes" if manifest.get("git_dirty") else ""
    parts = [
        str(manifest.get("cpu") or ""), f"host {manifest['host']}" if manifest.get("host") else "",
        f"commit {manifest['git_sha']}{dirty}" if manifest.get("git_sha") else "", f"begun {manifest['begun_utc']}" if manifest.get("begun_utc") else "",
    ]
    return " · ".join(part for part in parts if part) or run.name


def completeness(runs: Sequence[Run], cells: Sequence[Cell], states: Counter) -> Finding:
    """Whether every planned cell was dealt with."""
    planned = max(len(cells), sum(run.planned for run in runs))
    missing = planned - len(cells) + states["unfinished"]
    lacking = sorted({name for run in runs for name in run.missing_files})
    if not cells:
        what = f" ({', '.join(lacking)} missing)" if lacking else ""
        return Finding("bad", f"Empty: none of {planned} planned cells was measured{what}." if planned else f"Empty: this run holds no results{what}.")
    if missing:
        what = f"Incomplete: {missing} of {planned} planned cells are unfinished."
        return Finding("bad", f"{what} This report shows what there is; raymeter run CONFIG --resume finishes the rest.")
    if lacking:
        return Finding("bad", f"Incomplete: {', '.join(lacking)} missing.")
    parts = [f"{states[name]} {word}" for name, word in (("ok", "measured"), ("skipped", "skipped"), ("failed", "failed")) if states[name]]
    return Finding("aside" if states["failed"] else "good", f"Complete: of {plural(planned, 'planned cell')} {', '.join(parts)}.")


def fastest(cells: Sequence[Cell]) -> list[Finding]:
    """Which technique wins how often, counting clear wins."""
    best = best_cells(cells)
    compared = {key: one for key, one in best.items() if one.runner_up is not None}
    if not compared:
        return []
    wins = Counter(one.winner.label for one in compared.values() if one.clear)
    open_count = len(compared) - sum(wins.values())
    parts = [f"{label} on {count}" for label, count in wins.most_common()]
    parts += [f"undecided on {open_count}"] if open_count else []
    return [Finding("good", f"Fastest of {plural(len(compared), 'pair')} of scene and ray kind: {', '.join(parts)}.")]


def interval_half_width(cell: Cell) -> float | None:
    """Half of the confidence interval relative to the median."""
    median, low, high = (cell.number(name) for name in ("median_ns_per_ray", "ci_lo", "ci_hi"))
    return None if not median or low is None or high is None else (high - low) / 2 / median


def plural(count: int, noun: str) -> str:
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def flatten(value: Any, prefix: str = "") -> list[tuple[str, str]]:
    """Nested JSON as rows of dotted path and text."""
    if isinstance(value, dict):
        return [row for key, one in value.items() for row in flatten(one, f"{prefix}.{key}" if prefix else str(key))]
    if isinstance(value, list):
        return [(prefix, " ".join(one if isinstance(one, str) else json.dumps(one) for one in value))]
    return [(prefix, "" if value is None else value if isinstance(value, str) else json.dumps(value))]


def environment_rows(runs: Sequence[Run]) -> list[tuple[str, list[str]]]:
    """One row per property of the environment and the manifest, one column per run."""
    columns = [dict(flatten({key: one for key, one in run.manifest.items() if key != "config_text"}) + flatten(run.environment)) for run in runs]
    names = list(dict.fromkeys(name for column in columns for name in column))
    return [(name, [column.get(name, "") for column in columns]) for name in names]


def configuration_text(runs: Sequence[Run]) -> str:
    """The configuration that the runs share, or each run's after its name."""
    texts = {run.name: json.dumps(run.manifest["config_text"], indent=2, ensure_ascii=False) for run in runs if run.manifest.get("config_text")}
    if len(set(texts.values())) <= 1:
        return next(iter(texts.values()), "")
    return "\n\n".join(f"// {name}\n{text}" for name, text in texts.items())


def commands(runs: Sequence[Run]) -> list[str]:
    """The commands that give this report again."""
    lines = []
    for run in runs:
        if run.manifest.get("git_sha"):
            lines.append(f"git checkout {run.manifest['git_sha']}")
        lines.append(str(run.manifest.get("command") or "scripts/run config.json"))
    lines.append("scripts/report.py " + " ".join(str(run.folder) for run in runs))
    return list(dict.fromkeys(lines))

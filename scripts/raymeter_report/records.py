"""Reads a results folder: CSV tables, manifest, environment, reasons and images, checked against the columns of the contract."""

import csv
import json
import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

Value = str | float | None
Record = dict[str, Value]

KEY_COLUMNS = (
    "cell_id scene num_prims needs rays phase structure params first_hit occlusion max_depth min_weight isa simd_width packet threads"
).split()
EVENTS = "node_visits leaf_visits empty_leaf_visits volume_tests prim_tests prim_hits cache_tests cache_hits".split()
FILE_COLUMNS: dict[str, list[str]] = {
    "summary": (
        "n median_ns_per_ray ci_lo ci_hi mad mrays_per_s build_ms time_to_image_ms mem_bytes node_visits_per_ray prim_tests_per_ray "
        "simd_utilization ratio_vs_ref ratio_lo ratio_hi hit_mismatch status"
    ).split(),
    "samples": "sample order_index trace_ms rays_traced mrays_per_s ns_per_ray status".split(),
    "builds": (
        "build_ms mprims_per_s nodes interior_nodes leaves empty_leaves references max_depth sah_cost epo mem_bytes bytes_per_prim "
        "break_even_rays"
    ).split(),
    "counters": [
        "ray_count", *EVENTS, *(f"{event}_packets" for event in EVENTS), "node_visits_per_ray", "prim_tests_per_ray", "simd_utilization"
    ],
    "accuracy": (
        "rays_checked false_miss false_hit wrong_prim self_hits t_ulp_p50 t_ulp_p99 t_ulp_max image_rmse image_psnr image_ssim"
    ).split(),
    "frames": (
        "rays_traced primary primary_hit reflection reflection_hit refraction refraction_hit tir shadow shadow_blocked rays_saved mean_depth deepest "
        "generations error_mean error_max bound_mean bound_max bound_exceeded"
    ).split(),
}
OPTIONAL_FILES = frozenset(("frames",))  # runs of earlier versions, which knew no images, lack it
FRAME_PHASES = ("first_hit", "shadow", "reflection", "refraction", "shading")  # parts of a frame; phase "total" is the whole
TEXT_COLUMNS = frozenset("cell_id scene needs rays phase structure params first_hit occlusion isa status generations".split())
# max_depth is a key (recursion depth of the rays) and a property of a build (depth of the tree): the second one is renamed on reading.
DUPLICATE_COLUMNS = {("builds", "max_depth"): "tree_depth"}


class ReportError(Exception):
    """What the user gave cannot be reported on; the message is one line and names the file."""


@dataclass(frozen=True)
class Run:
    """One results folder in memory. Tables of a run that was interrupted may be empty."""

    folder: Path
    manifest: dict[str, Any] = field(default_factory=dict)
    environment: dict[str, Any] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)
    tables: dict[str, list[Record]] = field(default_factory=dict)
    break_even: dict[str, dict[str, str]] = field(default_factory=dict)
    missing_files: list[str] = field(default_factory=list)
    images: list[Path] = field(default_factory=list)

    @property
    def planned(self) -> int:
        """Cells that the run set out to measure; 0 where it does not say."""
        cells = self.manifest.get("cells")
        return cells if isinstance(cells, int) else 0

    @property
    def reference(self) -> dict[str, Value]:
        """What the config says of the cells that ratio_vs_ref is held against; empty where it names none."""
        return (self.manifest.get("config_text") or {}).get("measure", {}).get("reference") or {}

    def reason(self, cell_id: Value) -> str:
        """Why a cell was skipped or failed. The log knows cells by the part of their id before the scene's hash."""
        return self.reasons.get(str(cell_id).split("-", 1)[0], "")

    @property
    def name(self) -> str:
        """The folder's name, which holds the time, the commit and the host."""
        return self.folder.resolve().name


def whole(records: Iterable[Record]) -> list[Record]:
    """The records of whole passes, without those of single phases of a frame."""
    return [record for record in records if record["phase"] not in FRAME_PHASES]


def parse_value(text: str, column: str) -> Value:
    """Text of a CSV field as a value; empty and NaN mean "not measured". Raises ValueError where a number was expected."""
    if column in TEXT_COLUMNS:
        return text
    if text.strip() == "":
        return None
    if column == "break_even_rays" and text in ("always", "never"):
        return text
    if column == "threads" and text == "all":
        return text  # a cell that did not come so far as to know the machine's number
    number = float(text)
    return None if math.isnan(number) else number


def parse_table(lines: Iterable[str], kind: str, origin: Path) -> list[Record]:
    """Rows of one CSV. The last row of an interrupted run may be cut short: it is left out."""
    reader = csv.reader(lines)
    header = next(reader, None)
    if header is None:
        return []
    for column in (*KEY_COLUMNS, *FILE_COLUMNS[kind]):
        wanted = 2 if column in KEY_COLUMNS and column in FILE_COLUMNS[kind] else 1
        if header.count(column) < wanted:
            raise ReportError(f"{origin}: column '{column}' is missing")
    names = [DUPLICATE_COLUMNS.get((kind, name), name) if name in header[:i] else name for i, name in enumerate(header)]
    records: list[Record] = []
    rows = [(reader.line_num, row) for row in reader if row]
    for line, row in rows:
        if len(row) != len(names):
            if line == rows[-1][0]:
                break
            raise ReportError(f"{origin}:{line}: {len(row)} fields, expected {len(names)}")
        try:
            records.append({name: parse_value(text, name) for name, text in zip(names, row)})
        except ValueError:
            bad = next(name for name, text in zip(names, row) if not _is_value(text, name))
            raise ReportError(f"{origin}:{line}: column '{bad}': '{row[names.index(bad)]}' is not a number") from None
    return records


def _is_value(text: str, column: str) -> bool:
    try:
        parse_value(text, column)
    except ValueError:
        return False
    return True


def _read_json(path: Path) -> dict[str, Any]:
    if not path.is_file():
        return {}
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise ReportError(f"{path}: not JSON: {error}") from None
    if not isinstance(content, dict):
        raise ReportError(f"{path}: expected a JSON object")
    return content


def _read_reasons(path: Path) -> dict[str, str]:
    """Reasons for skipped and failed cells from the run's log, up to its first broken line (an interrupted run may leave one at the end)."""
    reasons: dict[str, str] = {}
    if path.is_file():
        for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
            try:
                record = json.loads(line)
            except json.JSONDecodeError:
                break
            if isinstance(record, dict) and record.get("cell") and record.get("reason"):
                reasons[str(record["cell"])] = str(record["reason"])
    return reasons


def _read_break_even(path: Path) -> dict[str, dict[str, str]]:
    """Per cell the rays, or the word, against each other cell, up to the first broken line."""
    pairs: dict[str, dict[str, str]] = {}
    if path.is_file():
        with path.open(newline="", encoding="utf-8", errors="replace") as lines:
            for row in list(csv.reader(lines))[1:]:
                if len(row) != 3:
                    break
                pairs.setdefault(row[0], {})[row[1]] = row[2]
    return pairs


def read_run(folder: Path) -> Run:
    """Reads a results folder; raises ReportError when `folder` is none or when a table lacks a column."""
    if not folder.is_dir():
        raise ReportError(f"{folder}: no such folder")
    if not (folder / "manifest.json").is_file() and not (folder / "summary.csv").is_file():
        raise ReportError(f"{folder}: not a results folder (neither manifest.json nor summary.csv in it)")
    tables: dict[str, list[Record]] = {}
    missing_files: list[str] = []
    for kind in FILE_COLUMNS:
        path = folder / f"{kind}.csv"
        if path.is_file():
            with path.open(newline="", encoding="utf-8", errors="replace") as lines:
                tables[kind] = parse_table(lines, kind, path)
        else:
            tables[kind] = []
            if kind not in OPTIONAL_FILES:
                missing_files.append(path.name)
    return Run(
        folder=folder,
        manifest=_read_json(folder / "manifest.json"),
        environment=_read_json(folder / "environment.json"),
        reasons=_read_reasons(folder / "samples.jsonl"),
        tables=tables,
        break_even=_read_break_even(folder / "break_even.csv"),
        missing_files=missing_files,
        images=sorted((folder / "images").glob("*.png")),
    )

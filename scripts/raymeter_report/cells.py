"""Cells of one or several runs: joined tables, technique labels, status, and the choice of cells that may be compared."""

import math
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

from .records import FRAME_PHASES, Record, Run, Value, whole

STRUCTURE_ORDER = "list bvh octree kdtree bsp grid recursive_grid ray_classification embree".split()
PEERS = ("embree",)
RAY_ORDER = "primary shadow reflection ambient_occlusion diffuse vertices edges faces invalid random case image".split()
ISA_ORDER = "scalar sse42 avx2 avx512".split()
SETTING = ("isa", "packet", "threads", "max_depth", "min_weight")


def rank(order: Sequence[str], name: str) -> tuple[int, str]:
    """Sort key: the place in `order`, unknown names behind it by alphabet."""
    return (order.index(name) if name in order else len(order), name)


@dataclass
class Cell:
    """One configuration that was (to be) measured, with all that is known of it."""

    run: str
    summary: Record
    build: Record
    counters: Record
    accuracy: Record
    frame: Record = field(default_factory=dict)  # of images: rays by kind, depths
    phases: dict[str, Record] = field(default_factory=dict)  # of images: the summary of each phase
    shadow: Record = field(default_factory=dict)  # what was counted over shadow rays alone
    break_even: dict[str, str] = field(default_factory=dict)
    samples: dict[Value, Record] = field(default_factory=dict)  # timed passes by round
    label: str = ""
    rays: str = ""

    @property
    def scene(self) -> str:
        return str(self.summary["scene"])

    @property
    def state(self) -> str:
        """ok, skipped, unfinished (the run was interrupted) or failed, which covers wrong hits, time-outs and errors."""
        word = str(self.summary["status"]).strip().lower()
        return word if word in ("ok", "skipped", "unfinished") else "failed"

    @property
    def setting(self) -> tuple[Value, ...]:
        return tuple(self.summary[column] for column in SETTING)

    @property
    def technique(self) -> tuple[str, str, str, str]:
        """What stands in the slots, with the parameters that were asked for."""
        structure, params, first_hit, occlusion = (str(self.summary[column]) for column in ("structure", "params", "first_hit", "occlusion"))
        return structure, params.partition("; ")[0], first_hit, occlusion

    @property
    def choice(self) -> str:
        """What the structure settled on by looking at the rays; records have it behind its parameters."""
        return str(self.summary["params"]).partition("; ")[2]

    @property
    def is_peer(self) -> bool:
        """From outside: its answers are listed, not held against it."""
        return self.summary["structure"] in PEERS

    def number(self, column: str) -> float | None:
        """A finite number of the summary, or None."""
        return finite(self.summary[column])


def finite(value: Value) -> float | None:
    """The value if it is a finite number, else None."""
    return value if isinstance(value, float) and math.isfinite(value) else None


def parse_params(params: str) -> dict[str, str]:
    """`density=4,max_resolution=256` as a dictionary."""
    pairs = (part.split("=", 1) for part in re.split(r"[,;]\s*", params) if "=" in part)
    return {key.strip(): value.strip() for key, value in pairs}


def load_cells(runs: Sequence[Run]) -> list[Cell]:
    """All cells of the runs in the order of their summaries, labelled."""
    cells: list[Cell] = []
    for run in runs:
        kinds = ("builds", "counters", "accuracy", "frames")
        joined = {kind: {record["cell_id"]: record for record in whole(run.tables.get(kind, []))} for kind in kinds}
        phases: dict[Value, dict[str, Record]] = defaultdict(dict)
        for record in run.tables["summary"]:
            if record["phase"] in FRAME_PHASES:
                phases[record["cell_id"]][str(record["phase"])] = record
        samples: dict[Value, dict[Value, Record]] = defaultdict(dict)
        for record in whole(run.tables["samples"]):
            if record["status"] == "ok":
                samples[record["cell_id"]][record["sample"]] = record
        shadow = {record["cell_id"]: record for record in run.tables["counters"] if record["phase"] in ("any", "shadow")}
        for summary in whole(run.tables["summary"]):
            key = summary["cell_id"]
            build, counters, accuracy, frame = (joined[kind].get(key, {}) for kind in kinds)
            others = (phases.get(key, {}), shadow.get(key, {}), run.break_even.get(str(key), {}), samples.get(key, {}))
            cells.append(Cell(run.name, summary, build, counters, accuracy, frame, *others))
    _label(cells)
    return cells


def slots_of(cell: Cell) -> list[tuple[str, str]]:
    """What stands in the slots, with its parameters; slots that hold their default are left out."""
    structure, params, first_hit, occlusion = cell.technique
    others = [tuple(text.partition(":")[::2]) for text in (first_hit, occlusion) if text not in ("", "cast", "none")]
    return [(structure, params), *others]  # type: ignore[list-item]


def _label(cells: list[Cell]) -> None:
    """Labels in the command line's form, with only the parameters that tell a technique from the others of its structure."""
    variants: dict[str, list[dict[str, str]]] = defaultdict(list)  # of what stands in each slot
    phases: dict[str, set[str]] = defaultdict(set)
    for cell in cells:
        for name, params in slots_of(cell):
            variants[name].append(parse_params(params))
        phases[str(cell.summary["rays"])].add(str(cell.summary["phase"]))
    # A parameter that means nothing to some of them is told by those that it depends on.
    varying = {name: {key for one in all_of for key in one if len({p[key] for p in all_of if key in p}) > 1} for name, all_of in variants.items()}
    seen = Counter(comparison_key(cell) for cell in cells)
    for cell in cells:
        parts = []
        for name, params in slots_of(cell):
            shown = [f"{key}={value}" for key, value in parse_params(params).items() if key in varying[name]]
            parts.append(name + (":" + ",".join(shown) if shown else ""))
        cell.label = "+".join(parts)
        cell.label += " (needs=all)" if cell.summary.get("needs") == "all" else ""
        if seen[comparison_key(cell)] > 1 and len({other.run for other in cells}) > 1:
            cell.label += f" @{cell.run}"
        rays = str(cell.summary["rays"])
        cell.rays = f"{rays} ({cell.summary['phase']})" if len(phases[rays]) > 1 else rays


def comparison_key(cell: Cell) -> tuple[Value, ...]:
    """What identifies a cell within a run; equal keys of two runs are the same measurement repeated."""
    return (cell.scene, cell.summary["rays"], cell.summary["phase"], *cell.technique, cell.summary.get("needs") == "all", *cell.setting)


def techniques_of(cells: Iterable[Cell]) -> list[str]:
    """Labels in the registry's order."""
    labels = {cell.label: rank(STRUCTURE_ORDER, cell.technique[0]) for cell in cells}
    return sorted(labels, key=lambda label: (labels[label], label))


def scenes_of(cells: Iterable[Cell]) -> list[str]:
    """Scenes from the smallest to the largest."""
    sizes: dict[str, float] = {}
    for cell in cells:
        sizes[cell.scene] = max(sizes.get(cell.scene, 0.0), cell.number("num_prims") or 0.0)
    return sorted(sizes, key=lambda scene: (sizes[scene], scene))


def rays_of(cells: Iterable[Cell]) -> list[str]:
    """Ray kinds from coherent to incoherent."""
    return sorted({cell.rays for cell in cells}, key=lambda rays: (rank(RAY_ORDER, rays.split(" ")[0]), rays))


def isa_rank(isa: Value) -> tuple[int, str]:
    return rank(ISA_ORDER, str(isa))


def setting_key(column: str) -> Callable[[Value], tuple]:
    """Sort key for the values of a setting column: ISAs by width, numbers by size, missing first, words last."""
    if column == "isa":
        return isa_rank
    return lambda value: (value is not None, isinstance(value, str), value if isinstance(value, float) else 0.0)


def main_setting(cells: Sequence[Cell]) -> dict[str, Value]:
    """The one setting at which figures compare techniques: widest ISA, fewest threads, deepest rays, no adaptive depth, and the packet size
    that most measured cells have (the larger of equals)."""
    remaining = [cell for cell in cells if cell.state == "ok"]
    setting: dict[str, Value] = {}
    for column, choose in (("isa", max), ("threads", min), ("max_depth", max), ("min_weight", min)):
        values = {cell.summary[column] for cell in remaining}
        if values:
            setting[column] = choose(values, key=setting_key(column))
            remaining = [cell for cell in remaining if cell.summary[column] == setting[column]]
    counts = Counter(cell.summary["packet"] for cell in remaining)
    if counts:
        setting["packet"] = max(counts, key=lambda packet: (counts[packet], setting_key("packet")(packet)))
    return setting


def at_setting(cells: Iterable[Cell], setting: dict[str, Value], free: str | None = None) -> list[Cell]:
    """The measured cells at a setting, one of whose columns may be left free."""
    return [
        cell
        for cell in cells
        if cell.state == "ok" and all(cell.summary[column] == value for column, value in setting.items() if column != free)
    ]


def varying_settings(cells: Iterable[Cell]) -> list[str]:
    """The setting columns that have more than one value."""
    cells = list(cells)
    return [column for column in SETTING if len({cell.summary[column] for cell in cells}) > 1]


@dataclass(frozen=True)
class Best:
    """The fastest technique for one scene and ray kind, and the next one."""

    winner: Cell
    runner_up: Cell | None

    @property
    def clear(self) -> bool:
        """True when the confidence intervals do not overlap."""
        if self.runner_up is None:
            return True
        high, low = self.winner.number("ci_hi"), self.runner_up.number("ci_lo")
        return high is not None and low is not None and high < low


def best_cells(cells: Iterable[Cell]) -> dict[tuple[str, str], Best]:
    """Per scene and ray kind the fastest technique, each at its own best ISA and packet size, on the fewest threads that were measured."""
    timed = [cell for cell in cells if cell.state == "ok" and cell.number("median_ns_per_ray") is not None]
    groups: dict[tuple[str, str], list[Cell]] = defaultdict(list)
    for cell in timed:
        groups[cell.scene, cell.rays].append(cell)
    best: dict[tuple[str, str], Best] = {}
    for scene in scenes_of(timed):
        for rays in rays_of(timed):
            group = groups.get((scene, rays), [])
            if not group:
                continue
            threads = min((cell.summary["threads"] for cell in group), key=setting_key("threads"))
            ordered = sorted(
                (cell for cell in group if cell.summary["threads"] == threads), key=lambda cell: cell.number("median_ns_per_ray") or math.inf
            )
            others = [cell for cell in ordered if cell.label != ordered[0].label]
            best[scene, rays] = Best(ordered[0], others[0] if others else None)
    return best


def describe_setting(setting: dict[str, Value], without: str | None = None) -> str:
    """`avx512, packets of 16 rays, 1 thread` for captions."""
    parts: list[str] = []
    for column in SETTING:
        value = setting.get(column)
        if value is None or value == "" or column == without:
            continue
        text = value if isinstance(value, str) else f"{value:g}"
        if column == "packet":
            parts.append("rays one by one" if value == 1 else f"packets of {text} rays")
        elif column == "threads":
            parts.append(f"{text} thread" if value == 1 else f"{text} threads")
        elif column == "max_depth":
            parts.append(f"depth {text}")
        elif column == "min_weight":
            if value:
                parts.append(f"minimum weight {text}")
        else:
            parts.append(str(text))
    return ", ".join(parts)

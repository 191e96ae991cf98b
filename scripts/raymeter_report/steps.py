"""What each ingredient brings: structures that a config lists as steps, each beside the one before it."""

from collections.abc import Sequence
from dataclasses import dataclass

from .cells import Cell, at_setting, main_setting, rays_of, scenes_of
from .numbers import geometric_mean, with_interval
from .peer import Ratio, ratio_of
from .records import Run
from .table import Column, Field, Table

FIRST = 1.0


@dataclass(frozen=True)
class Step:
    """One technique against the one before it on one scene and ray kind: how many times as fast."""

    scene: str
    rays: str
    before: str
    technique: str
    ratio: Ratio


def asks_for_steps(runs: Sequence[Run]) -> bool:
    """Whether a run's config says that its structures are steps."""
    return any((run.manifest.get("config_text") or {}).get("report", {}).get("steps") is True for run in runs)


def steps(runs: Sequence[Run], cells: Sequence[Cell]) -> list[Step]:
    """In the order of the config, at the setting at which figures compare; none where no config asks for them. A step that a scene lacks is passed over."""
    if not asks_for_steps(runs):
        return []
    place = {record["cell_id"]: i for i, record in enumerate(record for run in runs for record in run.tables["summary"])}
    chosen = sorted(at_setting(cells, main_setting(cells)), key=lambda cell: place[cell.summary["cell_id"]])
    found = []
    for scene in scenes_of(chosen):
        for rays in rays_of(chosen):
            here = [cell for cell in chosen if (cell.scene, cell.rays) == (scene, rays)]
            for before, cell in zip(here, here[1:]):
                ratio = ratio_of(cell, before)
                if ratio:
                    found.append(Step(scene, rays, before.label, cell.label, ratio))
    return found


def techniques_in_order(all_of: Sequence[Step]) -> list[str]:
    """The first technique and those that follow it."""
    return list(dict.fromkeys(label for one in all_of for label in (one.before, one.technique)))


def mean_of(all_of: Sequence[Step], rays: str, technique: str) -> Ratio | None:
    """Geometric mean over scenes, with the range of the single scenes."""
    values = [one.ratio.value for one in all_of if (one.rays, one.technique) == (rays, technique)]
    return Ratio(geometric_mean(values), min(values), max(values)) if values else None


def steps_table(runs: Sequence[Run], cells: Sequence[Cell]) -> Table:
    """Each step on each scene."""
    rows = []
    for one in steps(runs, cells):
        ratio, interval = with_interval(one.ratio.value, one.ratio.low, one.ratio.high)
        rows.append([Field(one.scene), Field(one.rays), Field(one.technique), Field(one.before), Field(ratio, one.ratio.value), Field(interval)])
    columns = [
        Column("scene", number=False), Column("rays", number=False), Column("step", number=False), Column("after", number=False), Column("times as fast", "×"),
        Column("95 % interval", "×"),
    ]
    return Table("steps", "What each step brings: how many times as fast as the one before it, medians over the rounds of the run.", columns, rows, 2)

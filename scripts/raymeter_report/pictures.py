"""Images and heat maps of a results folder, with captions from the STATS.json that `raymeter image` writes beside them."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .numbers import integer, significant
from .records import ReportError, Run


@dataclass(frozen=True)
class Picture:
    """A PNG and what it shows."""

    path: Path
    title: str
    caption: str


def pictures_of(run: Run) -> list[Picture]:
    """The run's pictures by scene, each scene's images before its heat maps; NAME.json describes NAME.png."""
    described = [(path, _read_stats(path.with_suffix(".json"))) for path in run.images]
    described.sort(key=lambda one: (one[1].get("scene", ""), "heatmap" in one[1], one[0].name))
    everything = [stats for _, stats in described]
    return [Picture(path, str(stats.get("scene") or path.stem), caption(stats, technique(stats, everything))) for path, stats in described]


def technique(stats: dict[str, Any], everything: list[dict[str, Any]]) -> str:
    """The technique in the command line's form, with only the parameters that tell it from the others of its structure."""
    alike = [one.get("params", {}) for one in everything if one.get("structure") == stats.get("structure")]
    shown = [f"{key}={value}" for key, value in stats.get("params", {}).items() if any(other.get(key, value) != value for other in alike)]
    return stats.get("structure", "") + (":" + ",".join(shown) if shown else "")


def caption(stats: dict[str, Any], made_by: str) -> str:
    """What a picture shows and how it was made; "" where nothing is known."""
    if not stats:
        return ""
    made = f"{made_by}, {stats.get('width')} × {stats.get('height')} pixels"
    heat = stats.get("heatmap")
    if heat:
        what = "Node visits" if heat.get("event") == "node_visits" else "Primitive tests"
        return f"{what} of each eye ray, from 0 (violet) to {integer(float(heat['most']))} (yellow), mean {significant(float(heat['mean']))}: {made}."
    kinds = [(name, stats.get(name)) for name in ("primary", "reflection", "refraction", "shadow")]
    rays = ", ".join(f"{integer(float(count))} {name}" for name, count in kinds if count)
    return f"Image: {made}" + (f"; rays: {rays}." if rays else ".")


def _read_stats(path: Path) -> dict[str, Any]:
    if not path.is_file():
        return {}
    try:
        stats = json.loads(path.read_text(encoding="utf-8"))
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise ReportError(f"{path}: not JSON: {error}") from None
    return stats if isinstance(stats, dict) else {}

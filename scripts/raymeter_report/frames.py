"""Whole images: where a frame's time goes, what rays it has, and what cutting the tree of rays saves and costs."""

from collections.abc import Sequence
from dataclasses import dataclass

from .cells import Cell, at_setting, finite, main_setting, varying_settings
from .numbers import integer, significant
from .records import FRAME_PHASES
from .table import Column, Field, Table, fixed_settings, key_columns, key_fields, number_field

# The rays that a phase's time per ray is per; shading is shared out among all.
RAYS_OF_PHASE = {"first_hit": "primary", "shadow": "shadow", "reflection": "reflection", "refraction": "refraction", "shading": "rays_traced"}


def frame_ms(cell: Cell) -> float | None:
    """Median time of a frame."""
    time, rays = cell.number("median_ns_per_ray"), finite(cell.frame.get("rays_traced"))
    return None if time is None or rays is None else time * rays * 1e-6


def phase_ms(cell: Cell, phase: str) -> float | None:
    """Median time of one phase of a frame; None where it traced nothing."""
    time = finite(cell.phases.get(phase, {}).get("median_ns_per_ray"))
    rays = finite(cell.frame.get(RAYS_OF_PHASE[phase]))
    return None if time is None or rays is None else time * rays * 1e-6


def images(cells: Sequence[Cell]) -> list[Cell]:
    return [cell for cell in cells if cell.frame]


def frames_table(cells: Sequence[Cell]) -> Table:
    """Time and rays of each image."""
    cells = images(cells)
    varying = varying_settings(cells)
    counts = (
        ("rays_traced", "rays"), ("primary", "eye rays"), ("shadow", "shadow rays"), ("shadow_blocked", "blocked"), ("reflection", "reflections"),
        ("refraction", "refractions"), ("tir", "total reflections"), ("deepest", "greatest depth"),
    )
    columns = [
        *key_columns(varying, with_rays=False), Column("frame", "ms"), *(Column(phase.replace("_", " "), "ms") for phase in FRAME_PHASES),
        *(Column(title, hint=name) for name, title in counts), Column("mean depth", hint="mean_depth"), Column("eye, reflection and refraction rays by depth"),
    ]
    rows = []
    for cell in cells:
        rows.append([
            *key_fields(cell, varying, with_rays=False), number_field(frame_ms(cell)), *(number_field(phase_ms(cell, phase)) for phase in FRAME_PHASES),
            *(number_field(cell.frame.get(name), integer) for name, _ in counts), number_field(cell.frame.get("mean_depth")),
            Field(str(cell.frame.get("generations", ""))),
        ])
    caption = (
        "Complete frames: median times of the whole and of its phases (each phase's own median: they need not add up), and rays by kind. Shading is all that "
        "is not tracing. Mean depth: over the eye rays, the depth of the deepest ray that comes of each, the eye ray having 1." + fixed_settings(cells)
    )
    return Table("frames", caption if rows else "", columns, rows, 2).without_empty()


@dataclass(frozen=True)
class Cut:
    """An image beside the one that is cut nowhere but is the same otherwise."""

    cell: Cell
    full: Cell

    @property
    def weight(self) -> float:
        return finite(self.cell.summary["min_weight"]) or 0.0

    @property
    def error(self) -> float | None:
        return finite(self.cell.accuracy.get("image_rmse"))

    @property
    def speed_up(self) -> float | None:
        time, full = frame_ms(self.cell), frame_ms(self.full)
        return full / time if time and full else None


def cuts(cells: Sequence[Cell]) -> list[Cut]:
    """All images whose rays were cut, and their whole ones, at the main setting but for depth and least weight."""
    setting = {key: value for key, value in main_setting(images(cells)).items() if key not in ("max_depth", "min_weight")}
    chosen = at_setting(images(cells), setting)

    def key(cell: Cell) -> tuple:
        return (cell.run, cell.scene, cell.label, cell.summary["max_depth"])

    full = {key(cell): cell for cell in chosen if cell.summary["min_weight"] == 0}
    compared = {key(cell) for cell in chosen if cell.summary["min_weight"] != 0} & set(full)
    return [Cut(cell, full[key(cell)]) for cell in chosen if key(cell) in compared]


def depth_control_table(cells: Sequence[Cell]) -> Table:
    """What each least weight saves, and its error beside what was promised."""
    measures = (
        ("image_rmse", "RMSE", ""), ("image_psnr", "PSNR", "dB"), ("image_ssim", "SSIM", "")
    )
    columns = [
        Column("scene", number=False), Column("technique", number=False), Column("depth", hint="max_depth"), Column("min. weight", hint="min_weight"),
        Column("rays", hint="rays_traced"), Column("rays saved", "%", hint="rays_saved"), Column("mean depth", hint="mean_depth"),
        Column("greatest depth", hint="deepest"), Column("frame", "ms"), Column("speed-up", "×"), *(Column(title, unit, hint=name) for name, title, unit in measures),
        Column("mean error", hint="error_mean"), Column("its bound", hint="bound_mean"), Column("largest error", hint="error_max"),
        Column("largest bound", hint="bound_max"), Column("pixels above their bound", hint="bound_exceeded"),
    ]
    rows = []
    for cut in cuts(cells):
        frame, rays, saved = cut.cell.frame, finite(cut.cell.frame.get("rays_traced")), finite(cut.cell.frame.get("rays_saved"))
        share = 100.0 * saved / (rays + saved) if rays is not None and saved is not None and rays + saved > 0 else None
        exceeded = number_field(frame.get("bound_exceeded"), integer)
        psnr = cut.cell.accuracy.get("image_psnr")
        rows.append([
            Field(cut.cell.scene), Field(cut.cell.label), number_field(cut.cell.summary["max_depth"], integer), number_field(cut.weight),
            number_field(rays, integer), number_field(share), number_field(frame.get("mean_depth")), number_field(frame.get("deepest"), integer),
            number_field(frame_ms(cut.cell)), number_field(cut.speed_up), number_field(cut.error),
            Field("inf") if psnr == float("inf") else number_field(psnr), number_field(cut.cell.accuracy.get("image_ssim"), lambda value: f"{value:.6f}"),
            *(number_field(frame.get(name), significant) for name in ("error_mean", "bound_mean", "error_max", "bound_max")),
            Field(exceeded.text, exceeded.value, "bad" if exceeded.value else ""),
        ])
    caption = (
        "Adaptive depth control: rays that count for less than the least weight in every channel are not followed. Errors are against the image of the same "
        "depth that is cut nowhere; the bound of a pixel is the sum over its cut rays of weight times the largest radiance that such a ray can carry."
    )
    return Table("depth-control", caption if rows else "", columns, rows, 3).without_empty()

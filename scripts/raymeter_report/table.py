"""The form of a table: fields, columns, and what all tables of cells have in common."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from .cells import SETTING, Cell, describe_setting, setting_key, varying_settings
from .numbers import plain, significant
from .records import Value


@dataclass(frozen=True)
class Field:
    """One field of a table; `value` is the unrounded number, `tone` how it is set off: best, bad or nothing."""

    text: str
    value: float | None = None
    tone: str = ""


@dataclass(frozen=True)
class Column:
    """Heading with its unit; numbers are aligned to the right."""

    title: str
    unit: str = ""
    number: bool = True
    hint: str = ""


@dataclass(frozen=True)
class Table:
    """A captioned table; rows are as long as `columns`. `groups` columns at the left repeat in consecutive rows that belong together."""

    name: str
    caption: str
    columns: Sequence[Column]
    rows: Sequence[Sequence[Field]] = field(default_factory=list)
    groups: int = 0

    def without_empty(self, named: bool = True) -> "Table":
        """The table without the columns in which nothing was measured; the caption names them if `named`."""
        filled = [any(row[i].text for row in self.rows) for i in range(len(self.columns))]
        if all(filled) or not self.rows:
            return self
        names = ", ".join(column.hint or column.title for column, keep in zip(self.columns, filled) if not keep)
        columns = [column for column, keep in zip(self.columns, filled) if keep]
        rows = [[one for one, keep in zip(row, filled) if keep] for row in self.rows]
        caption = f"{self.caption} Not measured in this run: {names}." if named else self.caption
        return Table(self.name, caption, columns, rows, self.groups)


SETTING_TITLES = {"isa": "ISA", "packet": "packet", "threads": "threads", "max_depth": "depth", "min_weight": "min. weight"}


def key_columns(varying: Sequence[str], with_rays: bool = True) -> list[Column]:
    """Scene, rays, technique and those settings that vary."""
    columns = [Column("scene", number=False)] + ([Column("rays", number=False)] if with_rays else []) + [Column("technique", number=False)]
    return columns + [Column(SETTING_TITLES[name], number=name != "isa", hint=name) for name in varying]


def key_fields(cell: Cell, varying: Sequence[str], with_rays: bool = True) -> list[Field]:
    fields = [Field(cell.scene)] + ([Field(cell.rays)] if with_rays else []) + [Field(cell.label)]
    return fields + [setting_field(cell.summary[name]) for name in varying]


def setting_field(value: Value) -> Field:
    return Field(plain(value), value if isinstance(value, float) else None)


def number_field(value: Value, form: Callable[[Value], str] = significant, factor: float = 1.0) -> Field:
    """A field for a number that may not have been measured: then it is empty."""
    if not isinstance(value, float):
        return Field("")
    return Field(form(value * factor), value * factor)


def in_order(cells: Sequence[Cell], order: dict[str, dict[str, int]]) -> list[Cell]:
    """Cells by scene, rays, technique, setting; `order` holds the places of scenes, rays and techniques."""
    def key(cell: Cell) -> tuple:
        settings = tuple(setting_key(name)(cell.summary[name]) for name in SETTING)
        return (order["scene"][cell.scene], order["rays"][cell.rays], order["technique"][cell.label], settings)

    return sorted(cells, key=key)


def fixed_settings(cells: Sequence[Cell]) -> str:
    """Caption text for the settings that all cells share."""
    varying = varying_settings(cells)
    shared = {name: cells[0].summary[name] for name in SETTING if name not in varying} if cells else {}
    text = describe_setting(shared)
    return f" All cells: {text}." if text else ""

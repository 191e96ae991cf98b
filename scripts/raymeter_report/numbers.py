"""Numbers as readers expect them: three significant digits, thin thousands separators, nothing where nothing was measured."""

import math
from collections.abc import Sequence

from .records import Value

THIN_SPACE = "\u202f"


def significant(value: Value, digits: int = 3) -> str:
    """A number rounded to `digits` significant digits; "" where it was not measured."""
    if value is None or isinstance(value, str):
        return value or ""
    if math.isnan(value):
        return ""
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(float(f"{value:.{digits - 1}e}"))))
    if exponent < -4 or exponent >= 12:
        mantissa = value / 10.0**exponent
        return f"{mantissa:.{digits - 1}f}e{exponent}"
    return grouped(value, digits - 1 - exponent)


def precise(value: Value) -> str:
    """An exact mean, such as counts per ray: four significant digits, all digits before the point."""
    return integer(value) if isinstance(value, float) and 1000 <= abs(value) < math.inf else significant(value, 4)


def plain(value: Value) -> str:
    """A setting as it was configured."""
    return f"{value:g}" if isinstance(value, float) else value or ""


def integer(value: Value) -> str:
    """A count; "" where it was not measured."""
    if not isinstance(value, float) or not math.isfinite(value):
        return significant(value)
    return grouped(value, 0)


def grouped(value: float, decimals: int) -> str:
    """Rounded to `decimals` (negative: to tens, hundreds ...), groups of three digits from 10 000 on."""
    value = round(value, decimals)
    decimals = max(0, decimals)
    text = f"{value:.{decimals}f}"
    if abs(value) < 10_000:
        return text
    return f"{value:,.{decimals}f}".replace(",", THIN_SPACE)


def with_interval(median: float | None, low: float | None, high: float | None) -> tuple[str, str]:
    """A median and its interval with as many decimals as the interval supports (two digits of its width), but three digits of the median."""
    if median is None:
        return "", ""
    if low is None or high is None or not (math.isfinite(low) and math.isfinite(high)) or high <= low:
        same = low is not None and low == high
        return significant(median, 4), f"[{significant(low, 4)}, {significant(high, 4)}]" if same else ""
    decimals = 1 - math.floor(math.log10(high - low))
    decimals = min(6, max(decimals, 2 - math.floor(math.log10(abs(median)))) if median else decimals)
    return grouped(median, decimals), f"[{grouped(low, decimals)}, {grouped(high, decimals)}]"


def shortened(text: str, limit: int = 24) -> str:
    """A name for a figure: of a long path only the end."""
    return text if len(text) <= limit else "…" + text[1 - limit :]


def axis_number(value: float) -> str:
    """A tick label: 0.1, 10, 2k, 5M."""
    if value == 0:
        return "0"
    for factor, suffix in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if abs(value) >= factor:
            return f"{value / factor:g}{suffix}"
    return f"{value:g}"


def median_interval(values: Sequence[float]) -> tuple[float, float] | None:
    """An interval that covers the median with at least 95 %: the order statistics at which a sign test would reject (Thompson 1936). None below 6 values."""
    ordered = sorted(values)
    count = len(ordered)
    tail, rank = 0.0, 0
    for heads in range(count // 2):
        tail += math.comb(count, heads) * 0.5**count
        if 2 * tail > 0.05:
            break
        rank = heads + 1
    return (ordered[rank - 1], ordered[count - rank]) if rank else None


def geometric_mean(values: Sequence[float]) -> float:
    """Of positive values, at least one."""
    return math.exp(sum(math.log(value) for value in values) / len(values))

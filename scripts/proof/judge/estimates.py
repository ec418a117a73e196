"""Numbers with their 90 % intervals, and the measures that they are made of."""

import math
import statistics
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

Z = statistics.NormalDist().inv_cdf(0.95)
Interval = tuple[float, float]


def wilson(hits: int, n: int) -> Interval:
    """90 % interval of a share by Wilson's method."""
    if n == 0:
        return 0.0, 1.0
    share, spread = hits / n, Z * Z / n
    middle = (share + spread / 2) / (1 + spread)
    half = Z * math.sqrt(share * (1 - share) / n + spread / (4 * n)) / (1 + spread)
    return max(0.0, middle - half), min(1.0, middle + half)


def bootstrap(values: Sequence, measure: Callable[[list], float], draws: int = 1000) -> Interval:
    """90 % interval of a measure of the cases by drawing them again."""
    random = np.random.default_rng(1)
    picks = random.integers(0, len(values), (draws, len(values)))
    results = [measure([values[k] for k in pick]) for pick in picks]
    low, high = np.quantile(results, [0.05, 0.95])
    return float(low), float(high)


def overlap(found: Sequence[Sequence[float]], true: Sequence[Sequence[float]]) -> float:
    """Intersection over union of two lists of intervals."""
    edges = sorted({float(edge) for pair in [*found, *true] for edge in pair})
    both = either = 0.0
    for start, end in pairwise(edges):
        inside = [any(a <= start and end <= b for a, b in pairs) for pairs in (found, true)]
        both += (end - start) * all(inside)
        either += (end - start) * any(inside)
    return both / either if either else 0.0


Claim = tuple[float, bool]  # a probability that was told, and whether that was right


def bins(claims: Sequence[Claim], count: int = 10) -> list[dict]:
    """Claims by probability: how many, what was told on average, how often it was right."""
    result = []
    for k in range(count):
        own = [claim for claim in claims if min(count - 1, int(count * claim[0])) == k]
        if own:
            hits = sum(right for _, right in own)
            low, high = wilson(hits, len(own))
            told = statistics.fmean(p for p, _ in own)
            result.append({"n": len(own), "told": told, "right": hits / len(own), "low": low, "high": high})
    return result


def calibration_error(claims: Sequence[Claim]) -> float:
    """Mean distance between what was told and how often it was right, over ten bins."""
    return sum(b["n"] * abs(b["told"] - b["right"]) for b in bins(claims)) / len(claims)


def calibration_error_by_chance(claims: Sequence[Claim], draws: int = 1000) -> float:
    """The calibration error that these claims have on average where each is right exactly as often as it says: with
    few of them chance alone keeps told and right apart."""
    random = np.random.default_rng(1)
    told = [p for p, _ in claims]
    drawn = random.random((draws, len(told))) < np.array(told)
    return statistics.fmean(calibration_error(list(zip(told, right, strict=True))) for right in drawn.tolist())

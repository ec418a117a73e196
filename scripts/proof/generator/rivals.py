"""Which look-alikes would do as well as the truth on the recordings given."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .families import rivals_of, rivals_there
from .signal import Ruler, left_beside
from .simulator import Undrivable, Window
from .sizes import ways

SAME = 5.0  # sigma: what a look-alike may leave of an effect
ALL_OF_IT = -1e6  # a boundary that a window lies beyond: the other soil fills it


class Bench:
    """Rulers on several recordings with the span of their starts, the columns of the soil, what each effect changed there,
    and where it acts if not throughout."""

    def __init__(self, rulers: list[Ruler], starts: list[np.ndarray], soils: list[np.ndarray],
                 changes: list[dict[str, np.ndarray]], windows: list[Mapping[str, Window]]):
        self.rulers, self.starts, self.soils, self.changes, self.windows = rulers, starts, soils, changes, windows
        self._known: dict[tuple[str, int, Window | None], tuple[np.ndarray, list[bool]] | None] = {}

    def _ways(self, rival: str, at: int, window: Window | None) -> tuple[np.ndarray, list[bool]] | None:
        """What a look-alike can do to a recording, throughout or in a window, and which of it in one direction only."""
        key = rival, at, window
        if key not in self._known:
            case = self.rulers[at].case
            try:
                all_ways = ways(rival, 0.5, case.setup.vehicle, case.setup.soil, case.drive.seconds)
                if window is not None and rival == "terrain_change":
                    all_ways = [(values | {"over": 0.0, "position": ALL_OF_IT}, one_sided) for values, one_sided in all_ways]
                columns = [self.rulers[at].response(rival, values, window) for values, _ in all_ways]
                self._known[key] = np.column_stack(columns), [one_sided for _, one_sided in all_ways]
            except Undrivable:
                self._known[key] = None
        return self._known[key]

    def rivals(self, names: list[str], recordings: int) -> list[str]:
        """Look-alikes of any size that, with the soil re-tuned, leave less than SAME of an effect in the first recordings:
        throughout, and where the effect is confined to a window, in the same window."""
        found = set()
        for name in names:
            windows = [own.get(name) for own in self.windows[:recordings]]
            asked = [(rival, [None] * recordings) for rival in rivals_of(name)]
            if all(windows):
                asked += [(rival, windows) for rival in rivals_there(name)]
            for rival, where in asked:
                if rival in names or rival in found:
                    continue
                each = [self._ways(rival, at, window) for at, window in enumerate(where)]
                if any(one is None for one in each):
                    continue
                changes = [change[name] for change in self.changes[:recordings]]
                left = left_beside(changes, self.starts[:recordings], self.soils[:recordings],
                                   [columns for columns, _ in each], each[0][1])
                if left < SAME:
                    found.add(rival)
        return sorted(found)

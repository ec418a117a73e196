"""Which look-alikes would do as well as the truth on the recordings given."""

from __future__ import annotations

import numpy as np

from .families import rivals_of
from .signal import Ruler, left_beside
from .simulator import Undrivable
from .sizes import ways

SAME = 5.0  # sigma: what a look-alike may leave of an effect


class Bench:
    """Rulers on several recordings with the span of their starts, the columns of the soil, and what each effect changed there."""

    def __init__(self, rulers: list[Ruler], starts: list[np.ndarray], soils: list[np.ndarray],
                 changes: list[dict[str, np.ndarray]]):
        self.rulers, self.starts, self.soils, self.changes = rulers, starts, soils, changes
        self._known: dict[tuple[str, int], tuple[np.ndarray, list[bool]] | None] = {}

    def _ways(self, rival: str, at: int) -> tuple[np.ndarray, list[bool]] | None:
        """What a look-alike can do to a recording, and which of it in one direction only."""
        if (rival, at) not in self._known:
            case = self.rulers[at].case
            try:
                all_ways = ways(rival, 0.5, case.setup.vehicle, case.setup.soil, case.drive.seconds)
                columns = [self.rulers[at].response(rival, values) for values, _ in all_ways]
                self._known[rival, at] = np.column_stack(columns), [one_sided for _, one_sided in all_ways]
            except Undrivable:
                self._known[rival, at] = None
        return self._known[rival, at]

    def rivals(self, names: list[str], recordings: int) -> list[str]:
        """Look-alikes of any size that, with the soil re-tuned, leave less than SAME of an effect in the first recordings."""
        found = set()
        for name in names:
            for rival in set(rivals_of(name)) - set(names) - found:
                each = [self._ways(rival, at) for at in range(recordings)]
                if any(one is None for one in each):
                    continue
                changes = [change[name] for change in self.changes[:recordings]]
                left = left_beside(changes, self.starts[:recordings], self.soils[:recordings],
                                   [columns for columns, _ in each], each[0][1])
                if left < SAME:
                    found.add(rival)
        return sorted(found)

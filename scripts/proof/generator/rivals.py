"""Which look-alikes would do as well as the truth on the recordings given."""

from __future__ import annotations

import numpy as np

from .catalogue import EFFECTS
from .families import rivals_of
from .signal import Ruler, project
from .simulator import Undrivable
from .sizes import draw_effect

SAME = 5.0  # sigma: what a look-alike may leave of an effect


class Bench:
    """Rulers on several recordings with their columns of starts and soil, and what each effect changed there."""

    def __init__(self, rulers: list[Ruler], starts: list[np.ndarray], soils: list[np.ndarray],
                 changes: list[dict[str, np.ndarray]]):
        self.rulers, self.starts, self.soils, self.changes = rulers, starts, soils, changes
        self._shapes: dict[tuple[str, int], np.ndarray | None] = {}

    def _shape(self, rival: str, at: int) -> np.ndarray | None:
        """Soil columns of a recording with those of a look-alike beside them."""
        if (rival, at) not in self._shapes:
            case = self.rulers[at].case
            shapes = 1 if len(EFFECTS[rival].switches) == 1 else 2
            try:
                columns = [self.rulers[at].response(rival, draw_effect(
                    rival, [7, i], 0.5, case.setup.vehicle, case.setup.soil, case.drive.seconds, (0.0, 0.0, 0.0)))
                    for i in range(shapes)]
                self._shapes[rival, at] = np.column_stack([self.soils[at], *columns])
            except Undrivable:
                self._shapes[rival, at] = None
        return self._shapes[rival, at]

    def rivals(self, names: list[str], recordings: int) -> list[str]:
        """Look-alikes of any size that, with the soil re-tuned, leave less than SAME of an effect in the first recordings."""
        found = set()
        for name in names:
            for rival in set(rivals_of(name)) - set(names) - found:
                shapes = [self._shape(rival, at) for at in range(recordings)]
                if any(shape is None for shape in shapes):
                    continue
                changes = [change[name] for change in self.changes[:recordings]]
                if project(changes, self.starts[:recordings], shapes).left < SAME:
                    found.add(rival)
        return sorted(found)

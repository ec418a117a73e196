"""What is counted, over which cases, against which target."""

import statistics
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace

from .case import SILENT, Judged
from .estimates import Claim, bins, bootstrap, calibration_error, calibration_error_by_chance, wilson

Cases = Sequence[Judged]


@dataclass(frozen=True)
class Target:
    """What the design asks for."""

    sense: str  # "at least", "at most" or "within"
    value: float
    high: float | None = None

    def met(self, value: float) -> bool:
        if self.sense == "within":
            return self.value <= value <= (self.high or self.value)
        return value >= self.value if self.sense == "at least" else value <= self.value


@dataclass(frozen=True)
class Metric:
    """A number of some cases with its 90 % interval."""

    key: str
    label: str
    unit: str  # share, probability, number, s
    n: int
    value: float | None
    low: float | None
    high: float | None
    target: Target | None
    note: str = ""

    @property
    def met(self) -> bool | None:
        return None if self.target is None or self.value is None else self.target.met(self.value)

    def json(self) -> dict:
        return asdict(self) | {"met": self.met}


def share(key: str, label: str, hits: Sequence[bool], target: Target | None = None, note: str = "") -> Metric:
    """How often something is so."""
    n = len(hits)
    low, high = wilson(sum(hits), n) if n else (None, None)
    return Metric(key, label, "share", n, sum(hits) / n if n else None, low, high, target, note)


def of(key: str, label: str, values: Sequence, measure: Callable[[list], float], unit: str = "number",
       target: Target | None = None, note: str = "") -> Metric:
    """A measure of values, its interval by drawing cases again."""
    values = list(values)
    if not values:
        return Metric(key, label, unit, 0, None, None, None, target, note)
    low, high = bootstrap(values, measure)
    return Metric(key, label, unit, len(values), float(measure(values)), low, high, target, note)


def _parameters(cases: Cases) -> list[Metric]:
    pairs = [[(error, held) for _, error, held in case.parameters] for case in cases if case.parameters]

    def middle(drawn: list) -> float:
        return statistics.median(error for own in drawn for error, _ in own)

    def held(drawn: list) -> float:
        return statistics.fmean(inside for own in drawn for _, inside in own)

    return [
        of("parameter_error", "parameter error, share of the strength, median", pairs, middle, "share", Target("at most", 0.1)),
        of("coverage", "90 % intervals of parameters that hold the truth", pairs, held, "share", Target("within", 0.85, 0.95)),
    ]


def _gain(cases: Cases) -> list[Metric]:
    result = []
    for key, label, outside, least in (
        ("gain", "gain on the unseen drive, share of the oracle's, median", False, 0.9),
        ("gain_outside", "the same outside the catalogue, against a perfect model, median", True, 0.5),
    ):
        asked = [case for case in cases if case.plain and ("unknown" in case.names) == outside]
        gains = [case.gain for case in asked if case.gain is not None]
        lost = Counter(case.oracle for case in asked if case.gain is None and case.oracle not in ("done", "not run"))
        late, failed = lost["timeout"], lost.total() - lost["timeout"]
        note = (f"{len(asked) - len(gains) - late - failed} left out: no oracle, or it gains too little"
                + (f"; {late}: the oracle took too long" if late else "") + (f"; {failed}: the oracle failed" if failed else ""))
        result.append(of(key, label, gains, statistics.median, "share", Target("at least", least), note))
    return result


def _alike(cases: Cases) -> list[Metric]:
    """Of look-alikes; where silence is allowed, silent answers do not count. How large a set is tells something where one
    recording leaves a choice."""
    alike = [c for c in cases if c.family == "lookalike" and (c.detected or not set(c.truth["expected"]) & SILENT)]
    named = [c for c in alike if c.detected and not c.resolvable]
    twice = [c.resolved for c in alike if c.resolvable]
    return [
        share("alike_in_set", "look-alikes: truth in the set", [c.detected and c.in_set for c in alike], Target("at least", 0.97)),
        of("alike_size", "look-alikes: size of the set, mean (one recording)", [len(c.group) for c in named], statistics.fmean,
           target=Target("at most", 2)),
        share("alike_resolved", "look-alikes: told apart with a second recording", twice, Target("at least", 0.85)),
    ]


def _calibration(claims: Sequence[Claim]) -> Metric:
    """Drawing again adds scatter, which this measure takes for error, so the interval is reflected about the value."""
    note = f"{calibration_error_by_chance(claims):.2f} is what chance gives so many claims that are right as often as they say" if claims else ""
    drawn = of("calibration", "calibration error of the first finding's probability", claims, calibration_error, "probability",
               Target("at most", 0.05), note)
    if drawn.value is None or drawn.low is None or drawn.high is None:
        return drawn
    return replace(drawn, low=max(0.0, 2 * drawn.value - drawn.high), high=max(drawn.value, 2 * drawn.value - drawn.low))


def metrics(cases: Cases) -> list[Metric]:
    """Everything that is counted."""
    nothing = [c for c in cases if not c.truth["effects"]]
    plain = [c for c in cases if c.plain]
    named = [c for c in plain if c.identifiable]
    clear = [c for c in cases if c.identifiable or not c.truth["effects"]]
    claims = [c.claim for c in cases if c.claim]
    unlisted = [c for c in cases if "unknown" in c.names and c.answered]
    sharp = [c for c in cases if not c.truth["effects"] or (c.plain and not c.truth["rivals"])]
    shown = [c for c in cases if not c.timed and c.unseen.get("own") is not None and c.unseen.get("retuned") is not None]
    pairs = [c for c in plain if len(c.real) > 1]
    found = [c for c in (case.located for case in cases) if c is not None]
    classed = [c for c in plain if c.true_mechanisms]
    inside, beyond = ([c.right_mechanism for c in classed if ("unknown" in c.names) == outside] for outside in (False, True))
    others = bool(named) and all(c.other for c in named)
    seconds = [c.seconds for c in cases if c.seconds is not None]
    return [
        share("right", "answers that the truth allows", [c.right for c in cases]),
        share("exact", "all that is missing by name, and nothing else (8 or more left, no look-alike, or nothing missing)", [c.exact for c in sharp]),
        share("failed", "no answer (crash, timeout)", [not c.answered for c in cases]),
        share("false_alarms", "false alarms where nothing is missing", [c.verdict not in SILENT for c in nothing], Target("at most", 0.02)),
        share("detection", "detected where the signal left is 8 or more", [c.detected for c in plain], Target("at least", 0.95)),
        share("first", "name right, first (where identifiable)", [c.first for c in named], Target("at least", 0.8 if others else 0.9)),
        share("two", "name right, among the first two", [c.two for c in named], Target("at least", 0.97)),
        share("in_set", "name right, first or in the first finding's set (where identifiable)", [c.in_set for c in named], Target("at least", 0.9)),
        of("set_size", "names in the first finding's set, mean (identifiable and detected)", [len(c.group) for c in named if c.detected],
           statistics.fmean, target=Target("at most", 2.5)),
        share("mechanism", "class of mechanism right", inside, Target("at least", 0.95)),
        share("mechanism_outside", "outside the catalogue: class of mechanism right", beyond, Target("at least", 0.8)),
        share("sure_wrong", "sure (0.9 or more) and wrong", [c.sure_and_wrong for c in cases if c.plain or not c.truth["effects"]],
              Target("at most", 0.02)),
        share("extra_names", "a false name beside the first", [bool(c.extra_names) for c in cases if c.answered], Target("at most", 0.05)),
        share("both", "both names right (two effects)", [c.both for c in pairs]),
        share("false_names", "a name of what is not there, anywhere in the answer", [bool(c.false_names) for c in cases if c.answered]),
        of("p_truth", "probability on the truth, mean (identifiable, or nothing missing)", [c.p_truth for c in clear], statistics.fmean,
           "probability", Target("at least", 0.85)),
        _calibration(claims),
        of("located", "overlap of the located seconds, median", found, statistics.median, "share", Target("at least", 0.7)),
        *_parameters(cases),
        *_gain(cases),
        share("harm", "unseen drive worse than with the soil re-tuned alone, by 10 % and 5 mm", [c.harmful for c in shown]),
        *_alike(cases),
        share("misnamed", "outside the catalogue: wrongly named", [c.misnamed for c in unlisted], Target("at most", 0.1)),
        of("seconds", "seconds per case, median", seconds, statistics.median, "s"),
    ]


def confusion(cases: Cases) -> dict[str, Counter]:
    """How often what was told of each truth."""
    table: dict[str, Counter] = {}
    for case in cases:
        effects = [effect["effect"] for effect in case.truth["effects"]] or ["nothing_missing"]
        true = "outside" if "unknown" in case.names else "two effects" if len(effects) > 1 else effects[0]
        if not case.answered:
            told = "no answer"
        elif case.verdict in SILENT or len(case.group) == 1:
            told = case.verdict if case.verdict in SILENT else case.told[0]
        else:
            told = "set with it" if case.in_set else "set without it"
        if true == "two effects" and told in case.names:
            told = "one or both of them"
        table.setdefault(true, Counter())[told] += 1
    return table


def reliability(cases: Cases) -> list[dict]:
    """Claims by probability."""
    return bins([c.claim for c in cases if c.claim])

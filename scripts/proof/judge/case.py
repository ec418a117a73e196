"""One case, judged: an answer in the format of diagnosis.json beside the truth."""

from dataclasses import dataclass

from generator.catalogue import MECHANISMS, mechanisms
from generator.conditions import OTHER, condition_of

from .estimates import overlap
from .gauge import told_by, windows

SILENT = {"nothing_missing", "insufficient_data"}
NONE = "none"  # the verdict where there is no answer: crash, timeout
HARM_SHARE, HARM = 0.1, 0.005  # of the re-tuned error, and m, by which a model must be worse than that one to do harm
PLAIN = 8.0  # signal left after re-tuning, in sigma, from which on an effect should be found
IDENTIFIABLE = {"single", "sensor", "absorbed", "local", "vehicle"}
VECTORS = {"grade", "lever_arm", "com_shift"}  # effects whose strengths are components of one arrow
SURE = 0.9  # probability from which on an answer is sure
LEAST_SHARE, LEAST_GAIN = 0.1, 0.005  # of the re-tuned error, and m, that the oracle must gain to be compared with


def seconds(finding: dict) -> list[list[float]]:
    """When a finding is said to act in the first recording."""
    where = [w for w in finding.get("where") or [] if w.get("recording", "drive") == "drive"]
    return sorted([w["start"], w["end"]] for w in where if w.get("start") is not None)


def one_over(factor: dict) -> dict:
    """A factor and its interval as seen from the other side."""
    low, high = factor["low"], factor["high"]
    return {"value": 1.0 / factor["value"], "low": 1.0 / high, "high": 1.0 / low if low > 0.0 else float("inf")}


@dataclass
class Judged:
    """What was told of a case and how right that was."""

    name: str
    truth: dict
    said: dict | None  # diagnosis.json, or a peer's answer
    unseen: dict[str, float | None]  # position error [m] of nominal, retuned, oracle, and "own", over the same windows
    seconds: float | None = None
    status: int | str = 0
    oracle: str = "done"  # its status

    def __post_init__(self) -> None:
        truth, said = self.truth, self.said or {}
        self.family, self.signal = truth["family"], truth["signal_left"]
        self.condition, self.other = condition_of(self.family), self.family.startswith(OTHER)
        self.verdict = said.get("verdict") or NONE
        self.findings: list[dict] = said.get("findings") or []
        ranked = sorted(said.get("candidates") or [], key=lambda c: -(c.get("probability") or 0.0))
        self.probabilities = {c["effect"]: c.get("probability") or 0.0 for c in ranked}
        silent = ["nothing_missing"] if self.verdict in SILENT else []
        other = [f["effect"] for f in self.findings] + [c["effect"] for c in ranked]
        self.told = list(dict.fromkeys(silent + other)) if self.said else []
        self.group = set(self.told[:1])
        if not silent:
            self.group |= {name for f in self.findings[:1] for name in f.get("ambiguous_with") or []}
        self.names: list[str] = truth["names"]
        self.real = [name for name in self.names if name != "nothing_missing"]
        self.parameters = self._parameters()

    @property
    def answered(self) -> bool:
        return self.verdict != NONE

    @property
    def detected(self) -> bool:
        return self.answered and self.verdict not in SILENT

    @property
    def first(self) -> bool:
        """The first name is right."""
        return bool(self.told) and self.told[0] in self.names

    @property
    def two(self) -> bool:
        """A right name is among the first two; that nothing is missing takes a place as any other."""
        return bool(set(self.told[:2]) & set(self.names))

    @property
    def in_set(self) -> bool:
        """A right name is among those that the first finding is said to be one of."""
        return bool(self.group & set(self.names))

    @property
    def both(self) -> bool:
        """Of several effects, all are named, and before anything else."""
        return self.detected and set(self.real) <= {finding["effect"] for finding in self.findings[: len(self.real)]}

    @property
    def plain(self) -> bool:
        """There is something, and it should be found."""
        return bool(self.truth["effects"]) and self.signal >= PLAIN

    @property
    def identifiable(self) -> bool:
        """One name is right, no other does as well on these recordings, and it should be found."""
        return self.plain and self.condition in IDENTIFIABLE and "unknown" not in self.names and not self.truth["rivals"]

    @property
    def p_truth(self) -> float:
        """Probability on the truth; 0 where there is no answer."""
        return min(1.0, sum(self.probabilities.get(name, 0.0) for name in self.names))

    @property
    def claim(self) -> tuple[float, bool] | None:
        """Probability of the first thing that was told, and whether it is right."""
        if not self.probabilities:
            return None
        if self.detected and self.findings:
            return self.findings[0].get("probability") or 0.0, self.first
        return self.probabilities.get("nothing_missing", 0.0), not self.truth["effects"]

    @property
    def misnamed(self) -> bool:
        """Something outside of the catalogue was given a catalogue name first, whatever the verdict."""
        return self.detected and bool(self.told) and "unknown" not in self.group and not self.first

    @property
    def false_names(self) -> list[str]:
        """What is told by a name of the catalogue and is not there: findings that are neither the truth nor a look-alike
        of it, nor said to be one of a set in which either, or "unknown", is."""
        there = {*self.names, *self.truth["rivals"], "unknown"}
        findings = self.findings if self.detected else []
        return [f["effect"] for f in findings if not there & {f["effect"], *(f.get("ambiguous_with") or [])}]

    @property
    def extra_names(self) -> list[str]:
        """Those of them that ride along: beside the first finding."""
        return self.false_names[1:] if self.findings[:1] and self.findings[0]["effect"] in self.false_names[:1] else self.false_names

    @property
    def sure_and_wrong(self) -> bool:
        """The first claim is wrong, its set lacks the truth, and its probability is SURE or more."""
        probability, right = self.claim or (0.0, True)
        return probability >= SURE and not right and not (self.detected and self.in_set)

    @property
    def true_mechanisms(self) -> list[str]:
        """Classes of what is missing. Truths without them are those of the catalogue's formulas."""
        classes = self.truth.get("mechanism") or {}
        each = (classes.get(e["effect"]) or mechanisms(e["effect"], e["parameters"]) for e in self.truth["effects"])
        return sorted({name for names in each for name in names})

    @property
    def told_mechanisms(self) -> list[str]:
        """Classes that the answer claims: its likeliest claim of the level "mechanism", else those of its first name."""
        claims = [c for c in (self.said or {}).get("claims") or [] if c.get("level") == "mechanism"]
        if claims and self.detected:
            name = max(claims, key=lambda c: c.get("probability") or 0.0).get("name") or ""
            return [name] if name in MECHANISMS else mechanisms(name)
        if not self.detected or not self.told:
            return []
        first = next((f for f in self.findings if f["effect"] == self.told[0]), {})
        values = {key.rpartition(".")[2]: p["value"] for key, p in (first.get("parameters") or {}).items()}
        return mechanisms(self.told[0], values)

    @property
    def right_mechanism(self) -> bool:
        """A class that is claimed is one of those of what is missing."""
        return bool(set(self.told_mechanisms) & set(self.true_mechanisms))

    @property
    def exact(self) -> bool:
        """All that is missing by its name, and nothing else."""
        if not self.truth["effects"]:
            return self.answered and not self.detected
        alone = not any(f.get("ambiguous_with") for f in self.findings)
        return self.detected and alone and sorted(f["effect"] for f in self.findings) == sorted(self.names)

    @property
    def right(self) -> bool:
        """The answer is one that the truth allows."""
        if self.verdict not in self.truth["expected"]:
            return False
        if self.resolvable:
            return self.resolved
        return self.verdict in SILENT or self.in_set

    @property
    def resolvable(self) -> bool:
        """A look-alike with a second recording that tells it apart."""
        return self.family == "lookalike" and "second" in self.truth["drives"]

    @property
    def resolved(self) -> bool:
        return self.detected and self.first and len(self.group) == 1

    @property
    def located(self) -> float | None:
        """Overlap of the told seconds with the true ones; 0 where nothing was told."""
        acts = [act for act in self.truth["drives"]["drive"].get("acts") or [] if act["intervals"]]
        if self.condition != "local" or not self.plain or not acts:
            return None
        right = [f for f in self.findings if f["effect"] in self.names] or self.findings[:1]
        found = [pair for f in right[:1] for pair in self._seconds(f)]
        return overlap(found, [pair for act in acts for pair in act["intervals"]])

    def _seconds(self, finding: dict) -> list[list[float]]:
        """When a finding acts; of a change of soil told from its other side, when it does not."""
        told = seconds(finding)
        return self._rest(told) if self._turned_round(finding["effect"], told) else told

    def _rest(self, told: list[list[float]]) -> list[list[float]]:
        """The seconds of the drive that are left."""
        edges = [0.0, *(edge for pair in told for edge in pair), self.truth["drives"]["drive"]["seconds"]]
        return [[a, b] for a, b in zip(edges[::2], edges[1::2], strict=True) if b > a]

    def _turned_round(self, effect: str, told: list[list[float]]) -> bool:
        """Whether a change of soil is told as one of the seconds in which it truly is not: the other soil is the base."""
        if effect != "terrain_change":
            return False
        acts = self.truth["drives"]["drive"].get("acts") or []
        true = [pair for act in acts if act["effect"] == effect for pair in act["intervals"]]
        return overlap(self._rest(told), true) > overlap(told, true)

    def _parameters(self) -> list[tuple[str, float, bool]]:
        """Of each strength that was told of a right effect: error over that strength, interval holds truth. What is truly
        off, and a component of an arrow, is compared with the effect's largest; of what each of several recordings has for
        itself the first's counts."""
        right = {f["effect"]: f for f in self.findings if f["effect"] in self.names}
        result = []
        for effect in map(told_by, self.truth["effects"]):
            finding = right.get(effect["effect"]) or {}
            told: dict[str, dict] = {}
            for key, value in (finding.get("parameters") or {}).items():
                told.setdefault(key.rpartition(".")[2], value)
            turned = self._turned_round(effect["effect"], seconds(finding))
            off = effect.get("off") or {}
            true = off | effect["parameters"]
            strengths = {key: min(abs(true[key] - off[key]), abs(true[key])) for key in off}
            largest = max(strengths.values(), default=0.0)
            for key in off:
                if key in told and largest > 0:
                    p = one_over(told[key]) if turned else told[key]
                    own = 0.0 if effect["effect"] in VECTORS else strengths[key]
                    error = abs(p["value"] - true[key]) / (own or largest)
                    result.append((f"{effect['effect']}.{key}", error, p["low"] <= true[key] <= p["high"]))
        return result

    @property
    def comparable(self) -> bool:
        """The oracle gains enough over the re-tuned model for a share of it to mean something."""
        before, best = self.unseen.get("retuned"), self.unseen.get("oracle")
        return before is not None and best is not None and before - best > max(LEAST_SHARE * before, LEAST_GAIN)

    @property
    def gain(self) -> float | None:
        """Share of the oracle's gain on the unseen recording, within -1..1; 0 where there is no model."""
        if not self.comparable:
            return None
        before, best, own = (self.unseen.get(key) for key in ("retuned", "oracle", "own"))
        return 0.0 if own is None else max(-1.0, min(1.0, (before - own) / (before - best)))

    @property
    def timed(self) -> bool:
        """Something acts in seconds of the drive that are not those of the unseen one, which no model can know."""
        changes = any(effect["parameters"].get("over") == "time" for effect in self.truth["effects"])
        return changes or any(window["kind"] == "time" for window in windows(self.truth))

    @property
    def harmful(self) -> bool:
        """On the unseen recording the model is worse than the re-tuned one."""
        before, own = self.unseen.get("retuned"), self.unseen.get("own")
        return before is not None and own is not None and own - before > max(HARM_SHARE * before, HARM)

    @property
    def short(self) -> str:
        """What was told, in one cell."""
        if not self.answered:
            return f"no answer ({self.status})"
        if self.verdict in SILENT:
            return self.verdict.replace("_", " ")
        names = sorted(self.group - set(self.told[:1]))
        more = [f["effect"] for f in self.findings[1:] if f["effect"] not in names]
        return self.told[0] + "".join(f" or {name}" for name in names) + "".join(f" + {name}" for name in more)

    @property
    def true_short(self) -> str:
        """The truth, in one cell."""
        formulas = {name: f", formula {number}" for name, number in (self.truth.get("formula") or {}).items()}
        each = (f"{e['effect'].removeprefix('outside:')} ({e['size']}{formulas.get(e['effect'], '')})" for e in self.truth["effects"])
        return " + ".join(each) or "nothing missing"

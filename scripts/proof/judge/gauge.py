"""Truths as recordings can tell them."""


def windows(truth: dict) -> list[dict]:
    """The windows of all effects, in all recordings."""
    return [window for effect in truth["effects"] for window in (effect.get("windows") or {}).values()]


def told_by(effect: dict) -> dict:
    """An effect with latencies counted from the gyro, which is the clock: what makes pose and gyro late alike makes the
    wheels early."""
    late = effect["parameters"].get("yaw_rate", 0.0) if effect["effect"] == "latency" else 0.0
    if not late:
        return effect
    parameters = {key: effect["parameters"].get(key, 0.0) - late for key in ("pose", "wheels")}
    return effect | {"parameters": parameters, "off": {key: 0.0 for key in parameters}}

"""What the sensors report of a drive: rates, coloured noise, drop-outs, outliers, counted wheel turns."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

import numpy as np

from .disturbances import NONE, Disturbances
from .simulator import Drive

POSE_CHANNELS = ("x", "y", "heading")
BODY_CHANNELS = ("v_x", "v_y")


@dataclass(frozen=True)
class Channel:
    """White noise [sd], and a Gauss-Markov part [sd, correlation time in s]."""

    white: float
    coloured: float
    time: float

    def draw(self, rng: np.random.Generator, times: np.ndarray) -> np.ndarray:
        """One realisation."""
        noise = rng.normal(0.0, self.white, len(times))
        part = rng.normal(0.0, self.coloured)
        for i in range(len(times)):
            if i:
                keep = math.exp(-(times[i] - times[i - 1]) / self.time)
                part = keep * part + math.sqrt(1.0 - keep**2) * rng.normal(0.0, self.coloured)
            noise[i] += part
        return noise

    def covariance(self, times: np.ndarray) -> np.ndarray:
        """Of samples at these times."""
        apart = np.abs(times[:, None] - times[None, :])
        return self.coloured**2 * np.exp(-apart / self.time) + self.white**2 * np.eye(len(times))


@dataclass(frozen=True)
class Sensors:
    """A set of sensors; `channels` are those recorded."""

    channels: dict[str, Channel]
    pose_rate: float
    counts: int  # per turn of a wheel
    dropouts: int
    outliers: int
    jitter: float

    def numbers(self) -> dict:
        """For the truth."""
        return asdict(self)

    def text(self) -> dict[str, str]:
        """For the sidecar."""
        return {"position": f"GNSS, about {100 * self.channels['x'].white:.0f} cm, {self.pose_rate:g} Hz",
                "heading": "dual antenna", "yaw_rate": "gyroscope, 20 Hz",
                "wheels": f"encoders, {self.counts} counts per turn, 20 Hz"}


@dataclass
class Samples:
    """When what was sampled."""

    wheel_times: np.ndarray
    pose_times: np.ndarray


def draw_sensors(rng: np.random.Generator) -> Sensors:
    """Sensors of a robot that costs some thousands."""
    position = Channel(rng.uniform(0.006, 0.02), rng.uniform(0.005, 0.025), rng.uniform(3.0, 15.0))
    heading = Channel(rng.uniform(0.002, 0.008), rng.uniform(0.001, 0.006), rng.uniform(2.0, 10.0))
    gyro = Channel(rng.uniform(0.003, 0.012), rng.uniform(0.0002, 0.001), rng.uniform(0.5, 3.0))
    channels = {"x": position, "y": position, "heading": heading, "yaw_rate": gyro}
    if rng.random() < 0.3:
        speed = Channel(rng.uniform(0.02, 0.05), rng.uniform(0.005, 0.02), rng.uniform(1.0, 5.0))
        channels |= {"v_x": speed, "v_y": speed}
    return Sensors(channels, float(rng.choice([5.0, 8.0, 10.0])), int(rng.choice([4096, 8192, 16384])),
                   int(rng.integers(0, 3)), int(rng.integers(0, 4)), rng.uniform(0.0, 0.003))


def draw_samples(rng: np.random.Generator, sensors: Sensors, seconds: float) -> Samples:
    """Times of the samples, with jitter; the pose's with drop-outs."""
    wheels = np.arange(0.05, seconds - 0.05, 0.05)
    poses = np.arange(rng.uniform(0.0, 1.0 / sensors.pose_rate), seconds - 0.05, 1.0 / sensors.pose_rate)
    keep = rng.random(len(poses)) > 0.01
    for _ in range(sensors.dropouts):
        begin = rng.uniform(0.1, 0.9) * seconds
        keep &= (poses < begin) | (poses > begin + rng.uniform(0.4, 1.6))
    poses = poses[keep]
    wheels = wheels + rng.uniform(-sensors.jitter, sensors.jitter, len(wheels))
    poses = poses + rng.uniform(0.0, sensors.jitter, len(poses))
    return Samples(np.round(wheels, 4), np.unique(np.round(poses, 4)))


def interpolate(records: np.ndarray, step: float, times: np.ndarray) -> np.ndarray:
    """Pose and velocities at any time within the records: cubic Hermite on both."""
    u = np.clip(times / step, 0.0, len(records) - 1.0)
    i = np.minimum(u.astype(int), len(records) - 2)
    s = (u - i)[:, None]
    a, b = records[i], records[i + 1]
    h_0, h_1 = (1 + 2 * s) * (1 - s) ** 2, s**2 * (3 - 2 * s)
    g_0, g_1 = s * (1 - s) ** 2 * step, s**2 * (s - 1) * step
    out = np.empty((len(times), 6))
    out[:, 3:] = h_0 * a[:, 3:6] + h_1 * b[:, 3:6] + g_0 * a[:, 6:9] + g_1 * b[:, 6:9]
    out[:, :3] = h_0 * a[:, :3] + h_1 * b[:, :3] + g_0 * _world_rates(a) + g_1 * _world_rates(b)
    return out


def _world_rates(records: np.ndarray) -> np.ndarray:
    c, s = np.cos(records[:, 2]), np.sin(records[:, 2])
    return np.stack([records[:, 3] * c - records[:, 4] * s, records[:, 3] * s + records[:, 4] * c, records[:, 5]], 1)


def report(records: np.ndarray, step: float, samples: Samples, channels: list[str],
           faults: dict[str, dict[str, float]]) -> dict[str, np.ndarray]:
    """Each channel without noise, as the sensors' effects make it."""
    late = faults.get("latency", {})
    pose = interpolate(records, step, samples.pose_times - late.get("pose", 0.0))
    gyro = interpolate(records, step, samples.wheel_times - late.get("yaw_rate", 0.0))[:, 5]
    ahead, left = faults.get("lever_arm", {}).get("ahead", 0.0), faults.get("lever_arm", {}).get("left", 0.0)
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    values = {"x": pose[:, 0] + ahead * c - left * s, "y": pose[:, 1] + ahead * s + left * c,
              "heading": pose[:, 2] + faults.get("heading_offset", {}).get("offset", 0.0),
              "yaw_rate": gyro + faults.get("yaw_rate_bias", {}).get("bias", 0.0)}
    direct = interpolate(records, step, samples.pose_times)
    values["v_x"], values["v_y"] = direct[:, 3], direct[:, 4]
    return {name: values[name] for name in channels}


def encoder(rng: np.random.Generator, drive: Drive, samples: Samples, counts: int, late: float) -> np.ndarray:
    """Wheel speeds from counts between the middles of neighbouring samples."""
    t = samples.wheel_times
    edges = np.concatenate([[1.5 * t[0] - 0.5 * t[1]], 0.5 * (t[1:] + t[:-1]), [1.5 * t[-1] - 0.5 * t[-2]]]) - late
    grid = np.arange(len(drive.speeds)) * drive.step
    out = np.empty((len(t), 2))
    for side in range(2):
        w = drive.speeds[:, side]
        angle = np.concatenate([[0.0], np.cumsum(0.5 * (w[1:] + w[:-1]) * drive.step)])
        at = np.interp(edges, grid, angle) + rng.uniform(0.0, 2.0 * math.pi / counts)
        turns = np.floor(at * counts / (2.0 * math.pi))
        out[:, side] = np.diff(turns) * 2.0 * math.pi / counts / np.diff(edges)
    return out


def sample_times(samples: Samples, channel: str) -> np.ndarray:
    """When a channel was sampled."""
    return samples.wheel_times if channel == "yaw_rate" else samples.pose_times


def record(rng: np.random.Generator, drive: Drive, records: np.ndarray, step: float, sensors: Sensors,
           samples: Samples, faults: dict[str, dict[str, float]], disturbances: Disturbances = NONE,
           disturbing: np.random.Generator | None = None) -> str:
    """The recording as CSV text: rows of the wheels with the gyro, rows of the pose in between.

    `disturbing` is the generator of the disturbances, so that without them all else is the same.
    """
    channels = list(sensors.channels)
    values = report(records, step, samples, channels, faults)
    for name in channels:
        values[name] = values[name] + sensors.channels[name].draw(rng, sample_times(samples, name))
    if disturbing is not None:
        disturbances.disturb(disturbing, values, samples.pose_times)
    for _ in range(sensors.outliers):
        at = int(rng.integers(0, len(samples.pose_times)))
        toward, size = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(0.3, 1.2)
        values["x"][at] += size * math.cos(toward)
        values["y"][at] += size * math.sin(toward)
    values["heading"] = np.arctan2(np.sin(values["heading"]), np.cos(values["heading"]))
    wheels = encoder(rng, drive, samples, sensors.counts, faults.get("latency", {}).get("wheels", 0.0))
    wheels *= 1.0 + disturbances.wheel_scale
    rows = []
    pose_names = [name for name in channels if name != "yaw_rate"]
    blank = {name: "" for name in channels}
    for i, t in enumerate(samples.wheel_times):
        cells = blank | {"yaw_rate": f"{values['yaw_rate'][i]:.6f}"}
        rows.append((t, f"{wheels[i, 0]:.6f},{wheels[i, 1]:.6f}", cells))
    for i, t in enumerate(samples.pose_times):
        rows.append((t, ",", blank | {name: f"{values[name][i]:.6f}" for name in pose_names}))
    rows.sort(key=lambda row: row[0])
    lines = ["time,omega_left,omega_right," + ",".join(channels)]
    last = -1.0
    for t, wheel, cells in rows:
        t = max(t, last + 1e-4)
        last = t
        lines.append(f"{t:.4f},{wheel}," + ",".join(cells[name] for name in channels))
    return "\n".join(lines) + "\n"

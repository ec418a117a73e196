"""Vehicles, terrains and models, as the JSON files of the tool describe them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from . import _native


class _Description:
    """Numbers with names, checked; read as attributes, never changed."""

    _numbers: dict[str, Any]

    def _keep(self, text: str) -> None:
        object.__setattr__(self, "_numbers", json.loads(text))

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["_numbers"][name]
        except KeyError:
            raise AttributeError(f"{type(self).__name__} has no `{name}`") from None

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"set it in a copy: .replace({name}={value!r})")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._numbers]

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and other._numbers == self._numbers  # type: ignore[attr-defined]

    def __hash__(self) -> int:
        return hash(json.dumps(self._numbers, sort_keys=True))

    def __repr__(self) -> str:
        numbers = ", ".join(f"{name}={value!r}" for name, value in self._numbers.items())
        return f"{type(self).__name__}({numbers})"

    def to_dict(self) -> dict[str, Any]:
        """The numbers by name."""
        return json.loads(json.dumps(self._numbers))

    def replace(self, **changes: Any) -> Self:
        """A copy with other numbers."""
        return type(self)(**{**self._numbers, **changes})

    @classmethod
    def from_file(cls, path: str | Path) -> Self:
        """Reads a JSON file of the tool."""
        return cls(**json.loads(Path(path).read_text(encoding="utf-8")))


class Vehicle(_Description):
    """A skid-steer vehicle. Numbers that are not given are those of Tran et al. (2007).

    mass [kg]; yaw_inertia [kg m^2]; wheel_radius, wheel_width [m]; row_positions: each row of wheels ahead of the
    centroid [m]; half_track: from the middle to the wheels [m]; com_offset: centre of mass ahead of the centroid [m];
    com_height [m]. `ugv vehicle --help` says more.

    >>> Vehicle(mass=520.0).half_track
    0.61
    """

    def __init__(self, **numbers: Any) -> None:
        given = {**json.loads(_native.tran2007()), **numbers}
        self._keep(_native.vehicle(json.dumps(given)))

    @classmethod
    def tran2007(cls) -> Vehicle:
        """The vehicle of the paper."""
        return cls()


class Terrain(_Description):
    """A soil: the name of one of the paper's, numbers, or both; then the numbers replace those of the name.

    cohesion [Pa]; friction_angle_deg [deg]; cohesive_modulus [N/m^(n+1)]; frictional_modulus [N/m^(n+2)];
    sinkage_exponent n [-]; shear_modulus [m].

    >>> Terrain("dry_sand", cohesion=500.0).cohesion
    500.0
    """

    def __init__(self, name: str | None = None, **numbers: float) -> None:
        named = json.loads(_native.terrain(json.dumps(name))) if name is not None else {}
        self._keep(_native.terrain(json.dumps({**named, **numbers})))

    @staticmethod
    def presets() -> list[str]:
        """Names of the paper's soils."""
        return _native.terrain_presets()


class Model:
    """A vehicle on a terrain, with effects beyond the paper's physics.

    `effects` maps names to parameters, as `ugv effects NAME` prints them: {"drag": {"coefficient": 60.0}}.
    """

    def __init__(
        self,
        vehicle: Vehicle | None = None,
        terrain: Terrain | str = "clayed_soil",
        effects: Mapping[str, Mapping[str, Any]] | None = None,
    ) -> None:
        terrain = terrain if isinstance(terrain, Terrain) else Terrain(terrain)
        document = {
            "format": "ugv-model/1",
            "vehicle": (vehicle or Vehicle()).to_dict(),
            "terrain": terrain.to_dict(),
            "effects": dict(effects or {}),
        }
        self._native = _native.Model(json.dumps(document))

    @classmethod
    def from_json(cls, text: str) -> Self:
        """From the text of a model's file, such as model.json of a diagnosis."""
        model = cls.__new__(cls)
        document = json.loads(text)
        document.pop("fitted_to", None)
        model._native = _native.Model(json.dumps(document))
        return model

    @classmethod
    def from_file(cls, path: str | Path) -> Self:
        """Reads a model's file."""
        return cls.from_json(Path(path).read_text(encoding="utf-8"))

    def to_json(self) -> str:
        """The text of the model's file: `ugv simulate --model FILE`, `ugv package --model FILE`."""
        return self._native.to_json()

    def to_dict(self) -> dict[str, Any]:
        """The model's file as a dict."""
        return json.loads(self.to_json())

    @property
    def vehicle(self) -> Vehicle:
        return Vehicle(**self.to_dict()["vehicle"])

    @property
    def terrain(self) -> Terrain:
        return Terrain(**self.to_dict()["terrain"])

    @property
    def effects(self) -> dict[str, Any]:
        """Parameters of the effects that are on, by name."""
        return self.to_dict()["effects"]

    @property
    def outputs(self) -> list[str]:
        """Names of the outputs: those of the FMU."""
        return self._native.outputs()

    def __repr__(self) -> str:
        return f"Model({self.vehicle!r}, {self.terrain!r}, effects={self.effects!r})"

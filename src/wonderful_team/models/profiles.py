"""What is known of a model because it was measured: saved by `probe --save NAME`, used by `--model NAME` from then on.

One JSON file for each profile in the user's configuration folder. A profile holds no key.
"""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any, Literal, TypeAlias

from pydantic import TypeAdapter, ValidationError

from wonderful_team.core.filesystem import make_private_folder, write_redacted
from wonderful_team.core.text import user_path
from wonderful_team.errors import ConfigError, UnknownNameError, reading
from wonderful_team.models.conventions import PIXELS, Convention, Resize, Shape
from wonderful_team.models.error_profile import ErrorProfile
from wonderful_team.models.providers.vendors import VENDORS

SCHEMA_VERSION = 1
CONFIG_VARIABLE = "WONDERFUL_TEAM_CONFIG"
"""Environment variable with the folder of our configuration, instead of the user's usual one."""
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}")
_RESERVED = frozenset({"offline", "simulated", "scripted", "replay", "http", "https", *(name for name, vendor in VENDORS.items() if vendor.words)})  # fmt: skip

Schemas: TypeAlias = Literal["enforced", "ignored", "refused", "unknown"]
Thinking: TypeAlias = Literal["never", "switchable", "always", "unknown"]


@dataclass(frozen=True)
class FitFigures:
    """How well the measured convention fits.

    Attributes:
        asked, answered, outliers: Marks asked for, answered, and answered far off.
        median_px, p90_px, worst_px: Residual over the marks that are no outliers [px of the pictures sent].
        checked_median_px: The same on fresh pictures, asked in the fitted convention; None when that was not done.
        clamped: Numbers in its unit that the model never passes (low, high), each None where there is no such end.
    """

    asked: int = 0
    answered: int = 0
    outliers: int = 0
    median_px: float | None = None
    p90_px: float | None = None
    worst_px: float | None = None
    checked_median_px: float | None = None
    checked_box_iou: float | None = None
    clamped: tuple[float | None, float | None] | None = None


@dataclass(frozen=True)
class Profile:
    """A model as it was measured.

    Attributes:
        name: What the user calls it; `--model NAME`.
        model: Its full name as `--model` takes it, such as http://host:8000/v1#my-planner or google:NAME.
        model_id: What the server says that it is.
        base_url: Address of the service; None for the vendor's own or for a model that is no service.
        convention: Numbers for places; what stands here is used only when `native_boxes` or `native_points` holds.
        native_points, native_boxes: Its own points and boxes can be relied on. When not, labelled axes are drawn.
        resize_measured: The convention's resize is the model's own; False when it only keeps pictures to the sizes probed.
        axes: Whole views are sent with labelled axes.
        max_pictures: Most pictures in one request that were answered rightly; 1 means that they are pasted on one sheet.
        max_pictures_reached: That is the limit; False when more may fit.
        context_tokens: As the service says; None when it does not.
        context_source: Where that number comes from.
        latency_s: Median time of a request with one picture [s].
        usd_in, usd_out: US dollars per million tokens; None when unknown.
        warnings: What a user should know, in words.
        probed: Date of the measurement (YYYY-MM-DD).
        library: Name and version of the client library.
        errors: What `--full` measured; None without it.
    """

    name: str
    model: str
    model_id: str = ""
    base_url: str | None = None
    convention: Convention = PIXELS
    resize_measured: bool = True
    native_points: bool = True
    native_boxes: bool = True
    axes: bool = False
    max_pictures: int | None = None
    max_pictures_reached: bool = False
    schemas: Schemas = "unknown"
    thinking: Thinking = "unknown"
    context_tokens: int | None = None
    context_source: str = ""
    latency_s: float | None = None
    usd_in: float | None = None
    usd_out: float | None = None
    fit: FitFigures = field(default_factory=FitFigures)
    warnings: tuple[str, ...] = ()
    probed: str = ""
    library: str = ""
    errors: ErrorProfile | None = None

    @property
    def one_picture(self) -> bool:
        """All pictures of a request must be pasted into one."""
        return self.max_pictures == 1

    @property
    def line(self) -> str:
        """The profile in one line, for lists and headers."""
        where = f" at {self.base_url}" if self.base_url else ""
        return f"{self.model_id or self.model}{where} (probed {self.probed or 'at an unknown date'}: {self.summary})"

    @property
    def summary(self) -> str:
        """Convention, error and picture limit in a few words."""
        if not self.native_points:
            spoken = "no convention fits: labelled axes, no native boxes"
        else:
            spoken = f"{convention_words(self.convention, self.resize_measured)}, error {_px(self.fit.median_px)}"
            spoken += "" if self.native_boxes else ", no native boxes"
        errs = "" if self.errors is None else f"; its errors: simulated:{self.name}"
        return f"{spoken}, {pictures_words(self.max_pictures, self.max_pictures_reached)}{errs}"


def convention_words(convention: Convention, resize_measured: bool = True) -> str:
    """A convention in a few words: "0-1000 x-first", "pixels y-first, after its own resize (…), offset (4, -3)".

    Args:
        convention: The convention.
        resize_measured: The resize is the model's own, not just a bound of what is sent.
    """
    unit = {"pixels": "pixels", "thousandths": "0-1000", "percent": "0-100", "unit": "0-1"}[convention.unit]
    words = [f"{unit} {convention.order[0]}-first"]
    if convention.resize is not None and resize_measured:
        words.append(f"after its own resize ({resize_words(convention.resize)})")
    if convention.scale != (1.0, 1.0):
        words.append(f"scale ({convention.scale[0]:.4g}, {convention.scale[1]:.4g})")
    if convention.offset != (0.0, 0.0):
        words.append(f"offset ({convention.offset[0]:.4g}, {convention.offset[1]:.4g})")
    if convention.offset_px != (0.0, 0.0):
        words.append(f"offset ({convention.offset_px[0]:.4g}, {convention.offset_px[1]:.4g}) px")
    return ", ".join(words)


def clamp_words(clamped: tuple[float | None, float | None]) -> str:
    """The ends of a model's range in words."""
    low, high = clamped
    ends = [] if low is None else [f"less than {low:g}"]
    ends += [] if high is None else [f"more than {high:g}"]
    return f"never says {' or '.join(ends)}"


def resize_words(resize: Resize) -> str:
    """A model's own resize in words."""
    words = []
    if resize.longest_side is not None:
        words.append(f"longest side {'always' if resize.always else 'at most'} {resize.longest_side} px")
    if resize.shortest_side is not None:
        words.append(f"shorter side at most {resize.shortest_side} px")
    if resize.max_pixels is not None:
        words.append(f"at most {resize.max_pixels} pixels")
    if resize.min_pixels is not None:
        words.append(f"at least {resize.min_pixels} pixels")
    if resize.multiple > 1:
        words.append(f"multiples of {resize.multiple} px")
    return ", ".join(words) or "none"


def pictures_words(most: int | None, reached: bool) -> str:
    """How many pictures a request may hold, in words."""
    if most is None:
        return "pictures per request unknown"
    if most == 1:
        return "1 picture per request"
    return f"{most} pictures" if reached else f"at least {most} pictures"


def _px(value: float | None) -> str:
    return "unknown" if value is None else f"{value:.2g} px" if value < 10 else f"{value:.0f} px"


# -- files ---------------------------------------------------------------------------------------------------------


def config_folder(environment: Mapping[str, str] | None = None) -> Path:
    """Where our configuration lies: $WONDERFUL_TEAM_CONFIG, else the platform's usual place."""
    held = os.environ if environment is None else environment
    if held.get(CONFIG_VARIABLE):
        return user_path(held[CONFIG_VARIABLE])
    if sys.platform == "win32":
        return Path(held.get("APPDATA") or Path.home() / "AppData" / "Roaming") / "wonderful-team"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "wonderful-team"
    return user_path(held.get("XDG_CONFIG_HOME") or Path.home() / ".config") / "wonderful-team"


def profiles_folder() -> Path:
    """Where profiles lie."""
    return config_folder() / "profiles"


def check_name(name: str) -> str:
    """The name, when a profile may have it.

    Raises:
        ConfigError: It is reserved or cannot be told from a model's full name or a file.
    """
    if not _NAME.fullmatch(name) or name.lower() in _RESERVED or name.lower().endswith(".py"):
        raise ConfigError(
            f"profile name {name!r}: valid are up to 64 letters, digits, '.', '_' and '-', starting with a letter or digit, "
            f"and none of {', '.join(sorted(_RESERVED))}"
        )
    return name


def profile_names(folder: Path | None = None) -> list[str]:
    """Names of all saved profiles, sorted."""
    place = profiles_folder() if folder is None else folder
    return sorted(path.stem for path in place.glob("*.json") if _NAME.fullmatch(path.stem))


def save_profile(profile: Profile, folder: Path | None = None) -> Path:
    """Write a profile; one of the same name is replaced, never half written.

    Raises:
        ConfigError: The name is not valid.
        FileNotWrittenError: The place cannot be written to.
    """
    place = profiles_folder() if folder is None else folder
    path = place / f"{check_name(profile.name)}.json"
    hint = f"set {CONFIG_VARIABLE} to another folder"
    make_private_folder(place, hint)
    write_redacted(path, profile_to_json(profile) + "\n", hint=hint)
    return path


def load_profile(name: str, folder: Path | None = None) -> Profile:
    """A saved profile.

    Raises:
        UnknownNameError: None of that name; lists those there are.
        ConfigError: Its file cannot be read; names the file.
    """
    place = profiles_folder() if folder is None else folder
    path = place / f"{name}.json"
    if not _NAME.fullmatch(name) or not path.is_file():
        raise UnknownNameError("profile", name, profile_names(folder))
    with reading(f"profile {str(path)!r}", f"a file that probe wrote; probe the model again with --save {name}"):
        return replace(profile_from_json(path.read_text(encoding="utf-8")), name=name)


def saved_profiles(folder: Path | None = None) -> dict[str, Profile | str]:
    """Every saved profile by name; for one that cannot be read, what is wrong with it."""
    found: dict[str, Profile | str] = {}
    for name in profile_names(folder):
        try:
            found[name] = load_profile(name, folder)
        except ConfigError as error:
            found[name] = str(error)
    return found


def profile_to_json(profile: Profile) -> str:
    """The profile as a JSON document with a schema version."""
    return json.dumps(profile_to_dict(profile), indent=2, ensure_ascii=False)


def profile_to_dict(profile: Profile) -> dict[str, Any]:
    """The profile as plain values."""
    errors = None if profile.errors is None else profile.errors.model_dump(mode="json")
    plain = asdict(replace(profile, errors=None)) | {"errors": errors}
    return {"schema_version": SCHEMA_VERSION, **plain}


def profile_from_json(text: str) -> Profile:
    """The inverse of `profile_to_json`.

    Raises:
        ValueError: It is no profile, or one of a newer version.
    """
    held = json.loads(text)
    if not isinstance(held, dict) or held.pop("schema_version", None) != SCHEMA_VERSION:
        raise ValueError(f"it is no profile of schema version {SCHEMA_VERSION}")
    try:
        profile = _adapter().validate_python(held)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise ValueError(f"{'.'.join(map(str, first['loc']))}: {first['msg']}") from error
    return profile


@cache
def _adapter() -> TypeAdapter[Profile]:
    return TypeAdapter(Profile)


__all__ = [
    "Convention",
    "FitFigures",
    "Profile",
    "Resize",
    "Shape",
    "clamp_words",
    "config_folder",
    "convention_words",
    "load_profile",
    "pictures_words",
    "profile_from_json",
    "profile_names",
    "profile_to_dict",
    "profile_to_json",
    "profiles_folder",
    "resize_words",
    "save_profile",
    "saved_profiles",
]

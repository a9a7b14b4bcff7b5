"""2 and 5: the picture of the whole plan, and one strip per target that tells how its box and points came about."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from markupsafe import Markup

from wonderful_team.core.geometry import Box
from wonderful_team.core.text import counted, recorded_names
from wonderful_team.pages.figures import (
    arrow_layer,
    box_layer,
    crop_drawing,
    cross_layer,
    mark_size,
    outline_layer,
    point_layer,
    shade,
    tag_layer,
    tag_size,
    turn_layer,
    view_drawing,
    window_round,
)
from wonderful_team.pages.look_up import chapters, main_key, scene_of
from wonderful_team.pages.pictures import Album
from wonderful_team.pages.requests import Asked

_EDGES = ("x0", "y0", "x1", "y1")
_GOES_THERE = ("place", "push_end")


def overviews(record: dict[str, Any], album: Album) -> list[dict[str, Any]]:
    """2: one picture per plan; the bare scene when nothing was grounded; none without a picture."""
    drawn: list[tuple[str, dict[str, Any] | None]] = [
        (name, content) for _, name, content in chapters(record) if content["grounded"] or content["actions"]
    ]
    scenes = [(name, content, scene_of(record, content)) for name, content in drawn or [("", None)]]
    planner = record["planner"]
    if planner.get("plan_scene") and planner["observations"] and not planner["executions"]:
        scenes.append(("The scene when it was to run", None, planner["observations"][0]))
    return [_overview(record, album, *one) for one in scenes if one[2] is not None]


def _overview(
    record: dict[str, Any], album: Album, name: str, current: dict[str, Any] | None, scene: Any
) -> dict[str, Any]:
    """Targets, boxes, points, moves in order, workspace and keep-out."""
    size = 0.6 * mark_size((0, 0, *scene["size_px"]))
    layers = [outline_layer(item["corners_px"], item["kind"], item["name"]) for item in record["planner"]["outlines"]]
    grounded = list(current["grounded"].values()) if current else []
    moves = [planned["sources"] for planned in (current["actions"] if current else []) if len(planned["sources"]) > 1]
    layers += [
        box_layer(item["box"], shade(position)) for position, item in enumerate(grounded) if item["box"] is not None
    ]
    turns = [
        planned for planned in (current["actions"] if current else []) if planned.get("step", {}).get("rotate_deg")
    ]
    layers += [
        turn_layer(planned["sources"][-1]["point_px"], planned["step"]["rotate_deg"], size)
        for planned in turns
        if planned["sources"]
    ]
    layers += [
        arrow_layer([source["point_px"] for source in sources], number, size)
        for number, sources in enumerate(moves, start=1)
    ]
    # Once there are moves, things go where the arrows end: the point of "left of T4" lies beside T4, not on it.
    for position, item in enumerate(grounded):
        taken = {role: point for role, point in item["points"].items() if not moves or role not in _GOES_THERE}
        layers += _points(taken, size, shade(position))
    shades = {item["target"]["id"]: shade(position) for position, item in enumerate(grounded)}
    layers += [
        cross_layer(sources[-1]["point_px"], 0.5 * size, shades.get(sources[-1]["target"], "move")) for sources in moves
    ]
    layers += _tags(grounded, moves, size, scene["size_px"])
    legend = [
        {
            "id": item["target"]["id"],
            "words": _words(item["target"]),
            "shade": shade(position),
            "status": item["status"],
        }
        for position, item in enumerate(grounded)
    ]
    alt = "the scene with " + (counted(len(grounded), "target") if grounded else "no targets")
    alt += f" and {counted(len(moves), 'move')}" if moves else ""
    return {
        "name": name,
        "drawing": view_drawing(album, main_key(scene), alt, layers, "overview"),
        "legend": legend,
        "moves": len(moves),
        "turns": len(turns),
        "kinds": sorted({item["kind"] for item in record["planner"]["outlines"]}),
    }


def _points(points: dict[str, Sequence[float]], size: float, css: str) -> list[Markup]:
    return [
        cross_layer(point, 0.5 * size, css) if role in _GOES_THERE else point_layer(point, 0.4 * size, css)
        for role, point in points.items()
    ]


def _tags(
    grounded: Sequence[dict[str, Any]], moves: Sequence[Any], size: float, size_px: Sequence[int]
) -> list[Markup]:
    """Names beside the boxes and points, on the side where no arrow leaves or arrives."""
    tags: list[Markup] = []
    taken = [Box(*(item["box"][edge] for edge in _EDGES)) for item in grounded if item["box"] is not None]
    upward = {sources[0]["target"] for sources in moves if sources[-1]["point_px"][1] < sources[0]["point_px"][1]}
    upward |= {sources[-1]["target"] for sources in moves if sources[-1]["point_px"][1] > sources[0]["point_px"][1]}
    for position, item in enumerate(grounded):
        name, box = item["target"]["id"], item["box"]
        width, height = tag_size(name, size)
        point = next(iter(item["points"].values()), None)
        if box is not None:
            above, below = (box["x0"], box["y0"] - 0.15 * size), (box["x0"], box["y1"] + 1.45 * size)
            middle = (box["y0"] + box["y1"]) / 2 + 0.65 * size
            beside = [(box["x1"] + 0.15 * size, middle), (box["x0"] - width - 0.15 * size, middle)]
            places = [*((below, above) if name in upward else (above, below)), *beside]
        elif point is not None:
            places = [(point[0] + 0.6 * size, point[1] - 0.5 * size)]
        else:
            continue
        plates = [_plate(place, (width, height), size_px) for place in places]
        plate = min(plates, key=lambda one: round(_covered(one, taken)))
        taken.append(plate)
        tags.append(tag_layer(plate.x0, plate.y1, name, size, shade(position)))
    return tags


def _plate(corner: Sequence[float], own: tuple[float, float], size_px: Sequence[int]) -> Box:
    """A plate of a size with its lower left corner at a point, held inside the picture."""
    (x, y), (width, height) = corner, own
    x, y = min(max(x, 0.0), size_px[0] - width), min(max(y, height), size_px[1])
    return Box(x, y - height, x + width, y)


def _covered(plate: Box, taken: Sequence[Box]) -> float:
    """How much of a plate others cover [px squared], twice where two do."""
    return sum(shared.area for shared in map(plate.intersection, taken) if shared is not None)


def _words(target: dict[str, Any]) -> str:
    part = f" ({target['part']})" if target["part"] else ""
    where = f", {target['where']}" if target["where"] else ""
    return f"{target['words']}{part}{where}"


def targets(record: dict[str, Any], album: Album, asked: Sequence[Asked]) -> list[dict[str, Any]]:
    """5: for every plan one strip per target."""
    return [
        {"name": name, "strips": _strips(record, current, album, [one for one in asked if one.attempt == number])}
        for number, name, current in chapters(record)
        if current["grounded"]
    ]


def detected(record: dict[str, Any], album: Album) -> list[dict[str, Any]]:
    """5: every look of a detector: who, for what, and the picture with all boxes and scores."""
    return [
        {
            "name": ", ".join(
                f"{key} {value}" if key != "name" else value for key, value in look["detector"].items() if value
            ),
            "words": [(words, sum(one["words"] == words for one in look["found"])) for words in look["words"]],
            "refused": look.get("refused", ""),
            "failed": look.get("failed", ""),
            "drawing": album.image(look["drawn"], f"what {look['detector'].get('name', 'the detector')} found", "wide"),
        }
        for look in record["planner"].get("detections", [])
    ]


def _strips(
    record: dict[str, Any], current: dict[str, Any], album: Album, asked: Sequence[Asked]
) -> list[dict[str, Any]]:
    strips = []
    for position, (name, item) in enumerate(current["grounded"].items()):
        target = item["target"]
        strips.append(
            {
                "id": name,
                "shade": shade(position),
                "words": _words(target),
                "kind": target["kind"],
                "status": item["status"].replace("_", " "),
                "found": item["status"] == "found",
                "box": _box_words(item["box"]),
                "points": [
                    f"{role.replace('_', ' ')} ({x:.1f}, {y:.1f}) px" for role, (x, y) in item["points"].items()
                ],
                "frames": _frames(record, current, item, album, position),
                "asked": [one for one in asked if name in one.entry["targets"] and len(one.entry["targets"]) == 1],
            }
        )
    return strips


def _box_words(box: dict[str, float] | None) -> str:
    return "" if box is None else "box ({x0:.0f}, {y0:.0f}) to ({x1:.0f}, {y1:.0f}) px".format(**box)


def _examples(target: dict[str, Any], said: dict[str, Any], album: Album) -> list[dict[str, Any]]:
    """The instruction's pictures that show what the target looks like."""
    names = recorded_names(said)
    found = []
    for name in target["like"]:
        slot = said["slots"].get(name)
        if slot is not None:
            picture = album.image(
                next(iter(slot["views"].values())), f"{names[name]} of the instruction", "wide example"
            )
            found.append({"what": "looks like", "text": names[name], "provenance": "", "tone": "", "drawing": picture})
    return found


def history_frames(
    record: dict[str, Any], plan: dict[str, Any], item: dict[str, Any], album: Album, position: int
) -> list[dict[str, Any]]:
    """How one target's box and points came about, picture by picture."""
    return _frames(record, plan, item, album, position)


def _frames(
    record: dict[str, Any], plan: dict[str, Any], item: dict[str, Any], album: Album, position: int
) -> list[dict[str, Any]]:
    """The history as pictures; every one shows the same window, so that changes can be seen."""
    scene, said = scene_of(record, plan), record["planner"]["instruction"]
    # A plan that was read for another instruction was made from other pictures, which this record does not hold.
    own = said is not None and plan["instruction"]["text"] == said["text"]
    frames = _examples(item["target"], said, album) if own else []
    if scene is None:
        return frames
    history = list(item["history"])
    boxes = [event["box"] for event in history if event["box"] is not None] + ([item["box"]] if item["box"] else [])
    points = [point for event in history for point in event["points"]] + list(item["points"].values())
    near = [point for point in points if not item["box"] or _near(point, item["box"])]
    window = window_round(boxes, near or points, scene["size_px"])
    size = 1.3 * mark_size(window)
    standing: dict[str, float] | None = None
    for event in history:
        standing = event["box"] or standing
        wide = any(not _inside(point, window) for point in event["points"])
        shown = (0.0, 0.0, float(scene["size_px"][0]), float(scene["size_px"][1])) if wide else window
        layers = _event_layers(event, standing, 1.3 * mark_size(shown), position)
        alt = f"{item['target']['id']}: {event['what']}: {event['text']}"
        frames.append(
            {**event, "tone": _tone(event), "drawing": crop_drawing(album, main_key(scene), shown, alt, layers)}
        )
    layers = ([box_layer(item["box"], shade(position))] if item["box"] else []) + _points(
        item["points"], 0.8 * size, shade(position)
    )
    if item["box"] or item["points"]:
        text = (
            "; ".join(role.replace("_", " ") for role in item["points"]) + " point" if item["points"] else "best so far"
        )
        last = crop_drawing(album, main_key(scene), window, f"{item['target']['id']}: as used", layers)
        frames.append({"what": "as used", "text": text, "provenance": "", "tone": "final", "drawing": last})
    return frames


def _event_layers(event: dict[str, Any], standing: dict[str, float] | None, size: float, position: int) -> list[Markup]:
    layers = [] if standing is None else [box_layer(standing, shade(position))]
    many = len(event["points"]) > 1
    for number, point in enumerate(event["points"], start=1):
        layers.append(point_layer(point, (0.55 if many else 0.4) * size, shade(position), str(number) if many else ""))
    return layers


def _tone(event: dict[str, Any]) -> str:
    if event["what"] in ("absent", "clamped"):
        return "odd"
    if event["what"] != "verdict":
        return ""
    word = event["text"].lower()
    for start, tone in (("accept", "good"), ("revise", "odd"), ("reject", "bad")):
        if start in word[:24]:
            return tone
    return ""


def _inside(point: Sequence[float], window: Sequence[float]) -> bool:
    x, y, width, height = window
    return x <= point[0] <= x + width and y <= point[1] <= y + height


def _near(point: Sequence[float], box: dict[str, float]) -> bool:
    width, height = box["x1"] - box["x0"], box["y1"] - box["y0"]
    return box["x0"] - width <= point[0] <= box["x1"] + width and box["y0"] - height <= point[1] <= box["y1"] + height

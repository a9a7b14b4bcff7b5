"""`probe`: find out how a model says where things are, what its service can do, and save that as a profile."""

from __future__ import annotations

import shlex
import time
from typing import Any

import click

from wonderful_team.cli.options import ENCODING, LOCAL_ONLY, TIMEOUT
from wonderful_team.cli.output import finish, print_document


@click.command(
    short_help="Measure a model: its coordinates, its limits, its errors; save a profile.",
    epilog="\b\nwonderful-team probe http://localhost:8000/v1 --save mine --price 0,0"
    '\nwonderful-team plan desk.jpg "put the red mug left of the laptop" --model mine',
)
@click.argument("model", metavar="MODEL")
@click.option("--save", metavar="NAME", help="Save the profile; --model NAME uses it from then on.")
@click.option("--full", is_flag=True, help="Also measure errors at pointing and judging boxes (many more calls).")
@click.option("--scenes", type=click.IntRange(1), default=12, show_default=True, help="Drawn scenes of --full.")
@click.option(
    "--rendered", type=click.IntRange(0), default=4, show_default=True, help="Rendered scenes (tabletop) of --full."
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of all pictures.")
@click.option(
    "--most-pictures", type=click.IntRange(1, 64), default=16, show_default=True, help="Largest request that is tried."
)
@click.option(
    "--price", metavar="IN,OUT", help="USD per million tokens, for a model without a price; kept in the profile."
)
@click.option("--allow-unpriced", is_flag=True, help="Accept a model of unknown price without --max-tokens.")
@LOCAL_ONLY
@TIMEOUT
@ENCODING
@click.option("--max-calls", type=click.IntRange(1), help="Most calls of the model.")
@click.option("--max-tokens", type=click.IntRange(1), help="Most tokens.")
@click.option("--max-seconds", type=click.FloatRange(0, min_open=True), help="Longest time of all.")
@click.option("--max-usd", type=click.FloatRange(0, min_open=True), help="Most money, where the price is known.")
@click.option("--concurrency", type=click.IntRange(1), default=4, show_default=True, help="Calls at once.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON document instead of text.")
def command(model: str, save: str | None, as_json: bool, **options: Any) -> int:
    """Show MODEL pictures with known marks and find out how it says where they are.

    MODEL is a name as --model takes it, such as http://localhost:8000/v1 or google:NAME.
    Fits order, unit, scale, offset, clamping and the model's own resize; checks the fit on fresh pictures; finds how many
    pictures a request may hold, whether schemas are enforced and thinking can be switched off, context, latency, price.
    Where nothing fits, the profile says so, and planning draws labelled axes instead of trusting native coordinates.
    A model that points at nothing at all ends with exit code 1, and no profile is saved.
    """
    from wonderful_team.api.probe import probe_model
    from wonderful_team.cli.progress import cost_line
    from wonderful_team.errors import FileNotWrittenError
    from wonderful_team.models.profiles import profile_to_dict, save_profile

    started = time.monotonic()
    probed = probe_model(model, save=save, tell=lambda line: click.echo(line, err=True), **options)
    profile = probed.profile
    saved, unwritten = None, []
    try:
        saved = str(save_profile(profile)) if save else None
    except FileNotWrittenError as error:
        unwritten.append(f"the profile is not saved: {error}")
    spent = cost_line(probed.usage, time.monotonic() - started)
    click.echo(spent, err=True)
    code = 5 if probed.stopped else 0
    fits = [{"asked": asked, **_plain(fit)} for asked, fit in probed.fits]
    result = {
        "profile": profile_to_dict(profile),
        "fits": fits,
        "notes": list(probed.notes),
        "saved": saved,
        "cost": spent,
    }
    if as_json and probed.stopped:
        stopped = {"type": "BudgetReached", "message": probed.stopped, "stage": "budget"}
        print_document("probe", code, result, stopped)
        return code
    return finish("probe", text=report(profile, saved), result=result, as_json=as_json, code=code, unwritten=unwritten)


def report(profile: Any, saved: str | None) -> str:
    """What was found, one line each."""
    from wonderful_team.models.profiles import clamp_words, convention_words, pictures_words

    fit = profile.fit
    lines = [f"model       {profile.model}" + (f" ({profile.model_id})" if profile.model_id else "")]
    if profile.native_points:
        clamp = "" if fit.clamped is None else f"; {clamp_words(fit.clamped)}"
        lines += [
            f"convention  {convention_words(profile.convention, profile.resize_measured)}{clamp}",
            f"residual    median {fit.median_px:.1f} px, 90 % within {fit.p90_px:.1f} px, worst {fit.worst_px:.1f} px; "
            f"{fit.answered} of {fit.asked} marks answered, {fit.outliers} far off",
            f"checked     fresh pictures, asked in that convention: median {fit.checked_median_px:.1f} px, "
            f"boxes overlap by {fit.checked_box_iou:.2f}",
        ]
    else:
        lines.append("convention  none fits")
    boxes = "use its own boxes" if profile.native_boxes else "do not use native boxes: labelled axes are drawn instead"
    lines += [
        f"boxes       {boxes}",
        f"pictures    {pictures_words(profile.max_pictures, profile.max_pictures_reached)}"
        + (", pasted on one sheet" if profile.one_picture else ""),
        f"schemas     {profile.schemas}",
        f"thinking    {_THINKING[profile.thinking]}",
        f"context     {f'{profile.context_tokens} tokens' if profile.context_tokens else 'unknown'}",
        f"latency     {f'{profile.latency_s:.2f} s (median)' if profile.latency_s is not None else 'unknown'}",
        f"price       {_price(profile)}",
    ]
    lines += [f"warning     {text}" for text in profile.warnings]
    if profile.errors is not None:
        lines += error_lines(profile.errors)
    if saved:
        lines.append(f"saved       {saved}; use it with --model {shlex.quote(profile.name)}")
        if profile.errors is not None:
            lines.append(
                f"simulated   --model {shlex.quote(f'simulated:{profile.name}')} answers from a simulator's truth with these errors"
            )
    else:
        lines.append("not saved   add --save NAME to use this from then on with --model NAME")
    return "\n".join(lines)


_THINKING = {
    "never": "does not think unless asked to",
    "switchable": "thinks; can be switched off with --thinking off",
    "always": "thinks; could not be switched off",
    "unknown": "unknown",
}


def _price(profile: Any) -> str:
    if profile.usd_in is None or profile.usd_out is None:
        return "unknown"
    return f"{profile.usd_in:g} USD in, {profile.usd_out:g} USD out per million tokens"


def error_lines(errors: Any) -> list[str]:
    """The measured errors, with n and 95 % intervals."""
    scenes = ", ".join(f"{len(kind.seeds)} {kind.kind} ({kind.targets} targets)" for kind in errors.scenes)
    radial, iou = errors.pointing.radial, errors.boxes.iou
    lines = [
        f"measured    on {scenes}; seeds {', '.join(_seeds(kind.seeds) for kind in errors.scenes)}",
        f"missed      {_count(errors.detection.missed)}; found although not there {_count(errors.detection.imagined)}",
    ]
    if radial.n:
        lines.append(
            f"pointing    median {100 * radial.quantiles[3]:.2f} % of the diagonal (n={radial.n}, 95 % interval "
            f"{100 * radial.median_low:.2f} to {100 * radial.median_high:.2f}), wild {_count(errors.pointing.wild)}"
        )
    if iou.n:
        lines.append(
            f"boxes       median overlap {iou.quantiles[3]:.2f} (n={iou.n}, 95 % interval {iou.median_low:.2f} to "
            f"{iou.median_high:.2f}), beside the thing {_count(errors.boxes.wild)}"
        )
    lines += [
        f"judging     bad boxes accepted {_count(errors.judgement.wrongly_accepted)}; "
        f"good boxes refused {_count(errors.judgement.wrongly_refused)}",
        *(f"  {state:<10}" + "  ".join(f"{word} {n}" for word, n in row.items()) for state, row in errors.judgement.counts.items()),
        f"no answer   {_count(errors.failed_requests)} requests",
    ]  # fmt: skip
    return lines


def _seeds(seeds: list[int]) -> str:
    return f"{min(seeds)}-{max(seeds)}" if len(seeds) > 1 else str(seeds[0])


def _count(count: Any) -> str:
    if not count.n:
        return "no data"
    return f"{count.count} of {count.n} (95 % interval {100 * count.low:.0f} to {100 * count.high:.0f} %)"


def _plain(value: Any) -> dict[str, Any]:
    from dataclasses import asdict

    held = asdict(value)
    return {
        key: None if isinstance(item, float) and item != item or item in (float("inf"),) else item
        for key, item in held.items()
    }

"""The picture of the verdict: what speaks for the merge and what against, a bar each."""

from __future__ import annotations

from math import exp

from algorithms.common.robot_names import UNNAMED, RobotNames
from algorithms.verdict.decision import Outcome, Verdict
from algorithms.verdict.probability_model import LITTLE, OTHERS, QUANTITIES
from app.drawing.palette import LIGHT, Palette, Rgb, css
from app.drawing.svg.svg_canvas import INK, WIDE, SvgCanvas, worded
from app.model import verdict_text as words

AMBER: Rgb = (0x7A, 0x52, 0x00)  # as words, on a light page
COLOURS: dict[Outcome, Rgb] = {
    Outcome.MERGED: LIGHT.mov,
    Outcome.BENT: AMBER,
    Outcome.REFUSED: LIGHT.conflict,
}
FULL = 6.0  # log-odds of a bar over its whole half; 400 to 1
ROW, TOP = 40.0, 44.0


def values(verdict: Verdict) -> dict[str, str]:
    """Each quantity of a verdict in words."""
    left = verdict.contradiction * verdict.shared_wall
    searched = exp(verdict.quantities.get("searched", 0.0)) - LITTLE
    said = {
        "contradiction": f"{verdict.rigid_contradiction:.1%}",
        "unbent": f"{left:.1f} m on {verdict.shared_floor:.0f} m²",
        "across": f"{verdict.wall_across:.1f} m",
        "misfit": f"{verdict.deviation:.1f} σ" if verdict.deviation > 0 else "–",
        "searched": f"{searched:,.0f} m²",
        OTHERS: words.odds_of_rival(verdict) if verdict.rival is not None else "none",
    }
    return {name: text for name, text in said.items() if name in verdict.contributions}


def titles(verdict: Verdict) -> dict[str, str]:
    """What is written beside each bar of a verdict."""
    weighed = {name: quantity.title for name, quantity in QUANTITIES.items() if name in verdict.contributions}
    return {**weighed, OTHERS: "other answers"}


def bars(verdict: Verdict, palette: Palette, names: RobotNames = UNNAMED, remark: str = "") -> str:
    """A bar per quantity: by how much it moves the log-odds from those of a typical right merge.

    remark : words beside the outcome
    """
    sheet = SvgCanvas(height_of(verdict))
    draw_bars(sheet, verdict, palette, names, remark)
    return sheet.svg("What speaks for the merge and what against it")


def height_of(verdict: Verdict) -> float:
    """Pixels that the bars take."""
    return TOP + ROW * len(titles(verdict)) + 26


def draw_bars(
    sheet: SvgCanvas, verdict: Verdict, palette: Palette, names: RobotNames = UNNAMED, remark: str = ""
) -> None:
    """The same at the top of a sheet."""
    named = titles(verdict)
    head = worded(COLOURS[verdict.outcome], palette)
    sheet.text(0, 13, f"{verdict.outcome.value.capitalize()}: {words.likelihood(verdict.probability)}", 15,
               colour=head, bold=True)  # fmt: skip
    middle = WIDE / 2
    if remark:
        sheet.text(WIDE, 13, remark, 10.5, "end", alpha=0.8)
    sheet.text(middle - 6, 33, "◀ speaks against", 10.5, "end", alpha=0.8)
    sheet.text(middle + 6, 33, "speaks for ▶", 10.5, alpha=0.8)
    shown = values(verdict)
    for row, name in enumerate(named):
        y, moved = TOP + ROW * row, verdict.contributions.get(name, 0.0)
        colour = LIGHT.mov if moved >= 0 else LIGHT.conflict
        sheet.text(0, y + 11, names.told(named[name]), 11)
        sheet.text(WIDE, y + 11, shown[name], 12, "end", bold=True)
        sheet.rect(0, y + 17, WIDE, 10, palette.margin, alpha=0.15)
        long = middle * min(1.0, abs(moved) / FULL)
        sheet.rect(middle if moved >= 0 else middle - long, y + 17, long, 10, css(colour))
        sheet.path([(middle, y + 14), (middle, y + 30)], INK, 1.5)
        inside = long > middle - 34
        beside = long - 4 if inside else long + 4
        sheet.text(
            middle + beside if moved >= 0 else middle - beside, y + 26, _signed(moved), 10.5,
            "start" if (moved >= 0) != inside else "end", "#fff" if inside else INK,
        )  # fmt: skip
    total = verdict.typical_score + sum(verdict.contributions.values())
    sheet.text(
        0, TOP + ROW * len(named) + 14,
        f"log-odds: a typical right merge {_signed(verdict.typical_score)}, this one {_signed(total)}",
        11, alpha=0.85,
    )  # fmt: skip


def _signed(value: float) -> str:
    rounded = f"{abs(value):.1f}"
    sign = "" if rounded == "0.0" else "+" if value > 0 else "−"
    return f"{sign}{rounded}"

"""The lists of a fleet: its robots, and who saw whom."""

from __future__ import annotations

from html import escape

from algorithms.fleets.pair_hypotheses import PairOrder
from app.drawing.palette import css, robot_colour
from app.model import verdict_text
from app.model.fleet_state import ALONE, ISLAND, PLACED, REFUSED, WAITING, FleetState
from app.model.status_text import typeset
from app.page.panels.html_widgets import box, table
from app.report.fleet_report import ROBOT_COLUMNS, robot_rows

MOODS = {PLACED: "accepted", ISLAND: "bent", ALONE: "refused", REFUSED: "refused", WAITING: "idle"}
ANCHOR = ' <abbr title="The result is in this robot\'s frame.">⚓</abbr>'


def robots_html(state: FleetState, chosen: str) -> str:
    """A row per robot: press it to choose it, or its eye to hide its map."""
    rows = []
    for number, name in enumerate(state.robots):
        standing = state.standing(name)
        shown = name not in state.hidden
        eye = "Hide" if shown else "Show"
        anchor = ANCHOR if name == state.fleet.anchor else ""
        rows.append(
            f'<div class="mm-robot" data-mood="{MOODS[standing]}">'
            f'<button type="button" data-mm-robot="{number}" aria-pressed="{str(name == chosen).lower()}">'
            f'<i style="background:{css(robot_colour(number))}"></i><b>{escape(name)}{anchor}</b>'
            f"<span>{escape(typeset(_told(state, name, standing)))}</span>{_how(state, name)}</button>"
            f'<button type="button" data-mm-eye="{number}" aria-pressed="{str(shown).lower()}" '
            f'title="{eye} the map of {escape(name)}">{"●" if shown else "○"}</button></div>'
        )
    for name in state.live:
        if name not in state.robots:  # it has sent no map yet
            head = f"<i></i><b>{escape(name)}</b>{_how(state, name)}"
            rows.append(f'<div class="mm-robot" data-mood="idle"><button type="button">{head}</button></div>')
    return f'<div class="mm-fleet">{"".join(rows)}</div>'


def _how(state: FleetState, name: str) -> str:
    """How a robot that runs does."""
    does = state.live.get(name)
    return "" if does is None else f'<em data-mood="{does.mood}">{escape(typeset(does.told))}</em>'


def poses_html(state: FleetState) -> str:
    """Where every robot lies; before all are merged, what is to be done."""
    if state.result is None:
        return box("Press Merge: where every robot lies, and how sure that is, appears here.", "plain")
    rows = [ROBOT_COLUMNS, *robot_rows(state.fleet, state.result)]
    head, *shown = ((name, x, y, turn, likely) for name, _, x, y, turn, likely, _ in rows)
    return table(shown, head)


def _told(state: FleetState, name: str, standing: str) -> str:
    """What has become of a robot, in a few words."""
    if state.result is None or name == state.fleet.anchor:
        return "" if state.result is None else "the anchor"
    for number, island in enumerate(state.result.islands, 1):
        if name in island.poses and standing in (PLACED, ISLAND):
            where = standing if number == 1 else f"island {number}"
            likely = verdict_text.likelihood(island.probability[name])
            return where if name == island.root else f"{where}, {likely}"
    return standing


def pairs_html(state: FleetState, orders: list[PairOrder]) -> str:
    """A row per pair: press it to open it in the page of two maps."""
    if not orders:
        return '<p class="mm-quiet">No robot has seen another. Merge looks for where their walls agree.</p>'
    rows = []
    for number, order in enumerate(orders):
        mood, said = _pair_told(state, order)
        verb = "saw" if order.sightings else "and"
        times = f" {len(order.sightings)} times" if len(order.sightings) > 1 else ""
        rows.append(
            f'<button type="button" class="mm-pair" data-mm-pair="{number}" data-mood="{mood}" '
            f'title="Open this pair: spectra, swarm, proof, by hand.">'
            f"<b>{escape(order.ref)} {verb} {escape(order.mov)}{times}</b>"
            f"<span>{escape(typeset(said))}</span></button>"
        )
    return f'<div class="mm-fleet">{"".join(rows)}</div>'


def _pair_told(state: FleetState, order: PairOrder) -> tuple[str, str]:
    """The mood of a pair, and what is said of it."""
    found, result = state.finding(order), state.result
    if result is not None:
        left = [each for each in result.left_out if each.number in order.sightings]
        if left:
            return "refused", f"left out: {left[0].reason}"
        for number, finding in enumerate(result.findings):
            if finding.order == order and number in result.likely:
                alone = "" if finding.accepted else " by the others; alone it was refused"
                return "accepted", f"{verdict_text.likelihood(result.likely[number])} right{alone}"
    if found is None:
        return "idle", "not merged yet"
    if not found.hypotheses:
        return "refused", found.said
    first = verdict_text.likelihood(found.hypotheses[0].probability)
    if found.accepted:
        return "accepted", f"{first} right by itself"
    return "bent", f"open: {first} right, {len(found.hypotheses) - 1} more to choose from"

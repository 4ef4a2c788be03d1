"""A result as one page to read, print and send on: no script, nothing from elsewhere, every name escaped."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from math import degrees
from typing import Any

from algorithms.common.robot_names import RobotNames
from algorithms.files.observation_file import known_to_bytes
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.registry import METHODS
from algorithms.verdict.contradictions import Contradictions, find_conflicts
from algorithms.verdict.decision import Outcome, merges_of
from app.drawing.palette import LIGHT
from app.drawing.svg.verdict_bars import bars
from app.model import chart_data as charts
from app.model import status_text as words
from app.model import verdict_text
from app.model.contradiction_text import MOST_PLACES, signed, summary, whose
from app.model.knowledge import counted
from app.model.merge_inputs import MergeInputs
from app.model.objective_label import measure_of
from app.model.settings import Setting, settings_of, text_for, value_at
from app.model.status_text import typeset
from app.report import report_figures as outcome
from app.report.export_frame import AS_MERGED, ExportedMap
from app.report.result_rows import STAGES, numbers
from app.report.ros_transform import publish_commands
from app.system.cancellation import Check, never_cancelled
from app.system.data_paths import asset

_STYLE = asset("report.css")
# what the file may fetch, said to the browser: nothing; its pictures are in it
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"

Row = Sequence[str]
STRONG = {
    Outcome.REFUSED: "<strong>REFUSED</strong>",
    Outcome.BENT: "<strong>Merged, but the maps are bent</strong>",
}


def report_page(
    result: MergeResult,
    inputs: MergeInputs,
    config: Any,
    report: Mapping[str, Any],
    exported: ExportedMap | None = None,
    check: Check = never_cancelled,
) -> bytes:
    """The content of report.html.

    config   : the settings that were used
    report   : what report.json says
    exported : the merged map as it is given away; None: as it was merged
    check    : is called between the pictures
    """
    found, name = find_conflicts(result.fusion), inputs.title or "two maps"
    title = f"{result.verdict.outcome.value.capitalize()}: {name}"
    names = inputs.names
    parts = [
        _verdict(result, inputs),
        _pictures(result, inputs, found, check),
        _section("How likely it is right", *_likely(result, names)),
        _section("Contradictions, place by place", *_places(found, names)),
        _section("The numbers", _table(numbers(result, inputs, config), "two")),
        _proof(result, config, names),
        _section("What was known", *_known(inputs)),
        _section("How it was merged", *_settings(result, config, report, names)),
        _section("How to use it", *_use(result, names, exported)),
    ]
    made_by = f"{report['made']}, mapmeld {report['versions']['mapmeld']}"
    made = ", ".join(f"{package} {number}" for package, number in report["versions"].items())
    html = (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">'
        f"<title>{escape(title)}</title><style>{_STYLE}</style></head><body>"
        f"<header><b>mapmeld</b><span>Report of a merge</span></header><h1>{escape(name)}</h1>"
        f'<p class="made">{escape(made_by)}</p>'
        f"{''.join(parts)}<footer>Made with {escape(made)}.</footer></body></html>\n"
    )
    return html.encode()


# --- parts ----------------------------------------------------------------------------------------


def _verdict(result: MergeResult, inputs: MergeInputs) -> str:
    verdict, T, told = result.verdict, result.T_ref_mov, inputs.names.told
    then = told(verdict_text.remedy(result))
    stop, reason = STRONG.get(verdict.outcome, ""), verdict.reason
    if stop:  # what follows "Refused: " or "Merged, bent: ", as a sentence
        reason = reason.partition(": ")[2]
        reason = reason[:1].upper() + reason[1:]
    reason = told(reason)
    more = f'<p class="then">{escape(then)}</p>' if then else ""
    found = "No robot should act on this transform or on a map made with it. The best place that was found:"
    where = told("Map 2 lies in map 1 at") if verdict.accepted else found
    place = typeset(f"{where} x {T.x:.3f} m, y {T.y:.3f} m, turned by {degrees(T.theta):.2f}°.")
    read = "".join(f"<p>{escape(told(remark))}</p>" for remark in inputs.readings())
    return (
        f'<div class="verdict {verdict_text.mood(verdict)}">{stop}<p>{escape(reason)}</p>{more}</div>'
        f"{read}<p>{escape(place)}</p>"
    )


def _pictures(result: MergeResult, inputs: MergeInputs, found: Contradictions, check: Check) -> str:
    check(0.3)
    figures, told = [], inputs.names.told
    if inputs.ref is not None and inputs.mov is not None:
        drawn = outcome.sources(inputs.ref, inputs.mov, inputs.observations, result.encounters, inputs.names)
        said = "The maps as they came, each in its own frame"
        said += told(", and what robot 1 saw of robot 2.") if inputs.observations else "."
        figures.append(_figure(drawn, said))
    check(0.45)
    said = told(
        "Map 2 on map 1 under the transform. A contradiction is a wall of one map on the other's free floor, "
        "with no wall of that map near by."
    )
    figures.append(_figure(outcome.overlay(result, inputs.observations, inputs.names), said))
    check(0.65)
    said = "Only what contradicts. The numbers are those of the table."
    figures.append(_figure(outcome.difference(result, found, inputs.names), said))
    check(0.85)
    return _section("Pictures", *figures)


def _likely(result: MergeResult, names: RobotNames) -> list[str]:
    verdict = result.verdict
    said = (
        f"{merges_of(verdict.probability).capitalize()}, as learned from merges of simulated buildings: "
        f"{verdict_text.likelihood(verdict.probability)}."
    )
    caption = (
        "What moves the probability: to the right what speaks for the merge, to the left what speaks against "
        "it, beside a typical right merge."
    )
    figure = _figure(bars(verdict, LIGHT, names), caption)
    cleared = ""
    if verdict.cleared_cells:
        cleared = (
            f"<p>{verdict.cleared_cells} cells around where robots stood were taken for the robots "
            "themselves: they speak neither for nor against, and are floor in the merged map.</p>"
        )
    return [f"<p>{escape(said)}</p>", figure, cleared]


def _places(found: Contradictions, names: RobotNames) -> list[str]:
    said = f"<p>{escape(names.told(summary(found)))}</p>"
    if not found.places:
        return [said]
    rows = []
    for n, place in enumerate(found.places[:MOST_PLACES], 1):
        sizes = (f"{place.wall:.1f} m", f"{2 * place.radius:.1f} m")
        rows.append((str(n), names.told(whose(place)), *sizes, signed(place.x), signed(place.y)))
    return [said, _table(rows, "places", ("place", "whose", "wall", "across", "x (m)", "y (m)"))]


def _proof(result: MergeResult, config: Any, names: RobotNames) -> str:
    state, measure = result.proof, measure_of(config)
    if state is None:
        return ""
    says = names.told(words.proof_says(state, measure))
    parts = [f"<p>{escape(says)} {state.nodes:,} blocks were bounded.</p>"]
    if len(state.turns):
        said = names.told("The best value at every turn of map 2.")
        parts.append(_figure(outcome.proof(state, measure, names), said))
    if rows := charts.proof_rows(state, measure):
        head = ("on the search's raster", "turn", measure.unit or measure.name, "of the best")
        parts.append(_table(rows, head=head))
    return _section("Is there a better place?", *parts)


def _known(inputs: MergeInputs) -> list[str]:
    if not inputs.known:
        return ["<p>Nothing but the maps: the place was found by their walls alone.</p>"]
    said = counted(inputs.known)
    text = escape(inputs.names.told(known_to_bytes(inputs.known).decode().rstrip()))
    return [f"<p>{said[0].upper()}{said[1:]}. As it stands in observation.yaml:</p><pre>{text}</pre>"]


def _settings(result: MergeResult, config: Any, report: Mapping[str, Any], names: RobotNames) -> list[str]:
    method = METHODS.get(result.method)
    title = method.title if method else result.method
    rows = [("method", title), ("seed", str(result.seed)), *report["inputs"].items()]
    parts = [_table(rows, "words")]
    if report["files"]:
        read = [
            (names.told(what.replace("map", "map ")), file["name"], file["sha256"])
            for what, files in report["files"].items()
            for file in files
        ]
        parts.append(_table(read, "words files", ("read", "file", "SHA-256 of its bytes")))
    if config is not None:
        if method:
            parts.append(f"<p>{escape(_changed(config, report['changed_settings']))}</p>")
        standard = method.defaults if method and type(method.defaults) is type(config) else config
        rows = [_setting(setting, standard) for setting in settings_of(config)]
        parts.append(_table(rows, "two", ("setting", "value")))
    times = ((STAGES.get(stage, stage), f"{1000 * took:.0f} ms") for stage, took in result.timings_s.items())
    return [*parts, _table(times, "", ("time per stage", ""))]


def _changed(config: Any, changed: Mapping[str, Any]) -> str:
    """Which settings are not the method's defaults, in a sentence."""
    if not changed:
        return "All settings are the method's defaults."
    labels = [each.label for each in settings_of(config) if ".".join(each.path) in changed]
    differ = "1 setting differs" if len(labels) == 1 else f"{len(labels)} settings differ"
    return f"{differ} from the method's defaults: {', '.join(labels)}."


def _setting(setting: Setting, standard: Any) -> Row:
    usual = value_at(standard, setting.path)
    shown, instead = (text_for(setting, value, "yes", "no") for value in (setting.default, usual))
    return setting.label, shown if usual == setting.default else f"{shown} (usually {instead})"


def _use(result: MergeResult, names: RobotNames, exported: ExportedMap | None) -> list[str]:
    if not result.verdict.accepted:
        return ["<p>Refused: there is nothing to publish. See what would help, at the top.</p>"]
    frame = AS_MERGED if exported is None else exported.frame
    lies = {
        "ref": "map 2's frame lies in map 1's",
        "mov": "map 1's frame lies in map 2's",
    }.get(str(frame.frame), f"both maps' frames lie in {frame.said}")
    serve = f"Serve the merged map, which is in {frame.said}, to Nav2:"
    if exported is not None and not exported.as_merged:
        serve = f"{exported.said} Serve it to Nav2:"
    said = (
        f"Tell ROS 2 where {lies}, while both robots run:",
        serve,
        "The transform takes points of map 2 to map 1: p₁ = R(θ) p₂ + (x, y). It is in transform.yaml, "
        "with all its digits; its covariance, the verdict and every setting are in report.json.",
    )
    publish, serve, where = (f"<p>{escape(names.told(each), quote=False)}</p>" for each in said)
    commands = "\n".join(publish_commands(result.T_ref_mov, names, frame))
    return [
        f"{publish}<pre>{escape(commands)}</pre>",
        f"{serve}<pre>ros2 run nav2_map_server map_server --ros-args -p yaml_filename:=merged.yaml</pre>",
        where,
    ]


# --- pieces of HTML -------------------------------------------------------------------------------


def _section(title: str, *parts: str) -> str:
    return f"<section><h2>{escape(title)}</h2>{''.join(parts)}</section>"


def _figure(svg: str, caption: str) -> str:
    return f"<figure>{svg}<figcaption>{escape(caption)}</figcaption></figure>"


def _table(rows: Iterable[Row], kind: str = "", head: Row = ()) -> str:
    """A table, first column words; kind "two" sets it in two columns, "words" has words beside words."""

    def row(cells: Row, tag: str) -> str:
        shown = cells if kind.startswith("words") else map(typeset, cells)  # words may be names of files
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in shown) + "</tr>"

    body = "".join(row(cells, "td") for cells in rows)
    top = row(head, "th") if head else ""
    return f'<div class="{escape(kind)}"><table>{top}{body}</table></div>'

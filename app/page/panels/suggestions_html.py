"""What a refused merge suggests, as small pictures to press."""

from __future__ import annotations

from html import escape

from algorithms.common.robot_names import RobotNames
from algorithms.methods.merge_result import MergeResult
from algorithms.methods.suggestions import Suggestion, are_wanted, suggestions_of
from algorithms.verdict.ranking import Weighed
from app.drawing.palette import Palette
from app.drawing.png import png_base64
from app.drawing.svg.thumbnail import thumbnail
from app.model.merge_inputs import MergeInputs
from app.report import suggestion_text as words


class SuggestionPictures:
    """Made once for a result: with large maps they take a while, and its page is written again and again."""

    def __init__(self) -> None:
        self._made: tuple[tuple[Weighed, ...], Palette, RobotNames, str] | None = None

    def html(self, result: MergeResult, inputs: MergeInputs, palette: Palette) -> str:
        """A button per suggestion; "" where none is wanted."""
        if not are_wanted(result) or inputs.ref is None or inputs.mov is None:
            return ""
        made = self._made
        names = inputs.names
        if made is None or made[0] is not result.weighed or made[1] is not palette or made[2] != names:
            buttons = [
                _button(each, names, png_base64(thumbnail(inputs.ref, inputs.mov, each.T_ref_mov, palette)))
                for each in suggestions_of(result)
            ]
            made = self._made = result.weighed, palette, names, "".join(buttons)
        said = "Is it one of these? Press one to see it; then take it, or correct it first under “By hand”."
        take = '<button type="button" class="mm-take">Take it</button>'
        return (
            f'<div class="mm-suggestions"><p>{escape(names.told(said), quote=False)}</p>{made[3]}{take}</div>'
        )


def _button(suggestion: Suggestion, names: RobotNames, picture: str) -> str:
    title = f"{words.place(suggestion)}. Agrees on {words.speaks_for(suggestion)}."
    against = f"against it: {names.told(words.speaks_against(suggestion))}"
    return (
        f'<button type="button" data-mm-suggestion="{suggestion.number}" title="{escape(title)}">'
        f'<img alt="" src="data:image/png;base64,{picture}"><b>{escape(words.likely(suggestion))}</b>'
        f"<span>{escape(words.speaks_for(suggestion))}</span><small>{escape(against)}</small></button>"
    )

"""Typeset the equations: ``python tests/tools/equations.py [FOLDER]`` makes NAME.svg of every NAME.tex.

The page shows the SVG as it is, so nothing is typeset while anyone waits, and ziamath is needed only
here. The colour is that of the words around it; the sizes are in em, so that it grows with them.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from xml.sax.saxutils import quoteattr

from algorithms.files.atomic_write import write_files
from app.page.lesson.equations import Equation, folder, read_equation

SIZE = 15.0  # px per em while typesetting


def typeset(equation: Equation) -> str:
    """The SVG of an equation; the same source gives the same bytes."""
    import ziamath

    ziamath.config.svg2 = False  # paths in place: ids would clash where many stand on one page
    drawn = ziamath.Latex(equation.latex, size=SIZE, color="currentColor").svg()
    width, height, box = (
        re.search(rf'{name}="([^"]+)"', drawn)[1]  # type: ignore[index]
        for name in ("width", "height", "viewBox")
    )
    inside = drawn[drawn.index(">") + 1 :]
    short = re.sub(r"-?\d+\.\d{3,}", lambda found: f"{float(found[0]):.2f}", inside)
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" class="mm-equation" '
        f'data-source="{equation.digest}" aria-label={quoteattr(equation.latex)} '
        f'width="{float(width) / SIZE:.3f}em" height="{float(height) / SIZE:.3f}em" viewBox="{box}">'
    )
    return head + short + "\n"


def main(where: Path) -> None:
    """Typeset all of a folder."""
    made = {}
    for source in sorted(where.glob("*.tex")):
        equation = read_equation(source)
        made[source.with_suffix(".svg")] = typeset(equation).encode()
    write_files(made)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else folder())

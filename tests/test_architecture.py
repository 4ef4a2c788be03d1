"""The layers of CONTRIBUTING.md, asked of the source: inside functions and under TYPE_CHECKING, too."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections import Counter
from functools import cache
from pathlib import Path

import pytest
from repository import ROOT

PLOTTERS = {"matplotlib", "plotly", "bokeh", "seaborn"}

# A package imports packages of lower rows only; what lies in its folders belongs to it.
ROWS = (
    ("app",),  # __main__
    ("app.cli",),
    ("app.page",),
    ("app.evaluation", "app.live"),
    ("app.report",),
    ("app.web", "app.jobs"),
    ("app.drawing",),
    ("app.model",),
    ("app.system",),
    ("algorithms.simulator", "algorithms.fleets"),
    ("algorithms.methods",),
    ("algorithms.verdict",),
    ("algorithms.optimisation",),
    ("algorithms.detection",),
    ("algorithms.spectra", "algorithms.files"),
    ("algorithms.observations",),
    ("algorithms.maps", "algorithms.sensors"),
    ("algorithms.common",),
    ("algorithms",),
)
RANK = {package: len(ROWS) - row for row, packages in enumerate(ROWS) for package in packages}

MOST_LINES = 300  # of a module
MOST_STATEMENT_LINES = 93  # of a function
MOST_MODULES = 15  # of a folder, its __init__ apart


@cache
def sources() -> dict[str, ast.Module]:
    """The syntax tree of every module by its dotted name."""
    return {module: ast.parse(path.read_text("utf-8")) for module, path in paths().items()}


@cache
def paths() -> dict[str, Path]:
    """The file of every module by its dotted name; a package is its ``__init__``."""
    found = [path for package in ("algorithms", "app") for path in sorted((ROOT / package).rglob("*.py"))]
    return {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
        for path in found
    }


def modules(package: str) -> list[str]:
    """Names of all modules under a package, entry points left out: importing them would run them."""
    return [name for name in paths() if f"{name}.".startswith(f"{package}.") and "__main__" not in name]


@cache
def imports_of(module: str) -> frozenset[str]:
    """What a module's source imports: our modules by name, others by the name that the source gives."""
    return frozenset(imported(sources()[module]))


def imported(tree: ast.AST) -> set[str]:
    """What a source imports."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"give the whole name in {ast.unparse(node)!r}"
            for alias in node.names:
                full = f"{node.module}.{alias.name}"
                found.add(full if full in paths() else str(node.module))
    return found


def importers(*names: str) -> set[str]:
    """Modules that import one of these, or something in it."""
    return {
        module
        for module in paths()
        if any(f"{found}.".startswith(f"{name}.") for found in imports_of(module) for name in names)
    }


def package_of(module: str) -> str:
    """The row's package that a module belongs to."""
    return max((package for package in RANK if f"{module}.".startswith(f"{package}.")), key=len)


def test_a_package_imports_lower_rows_only():
    wrong = []
    for module in paths():
        for other in imports_of(module) & set(paths()):
            mine, theirs = package_of(module), package_of(other)
            if mine != theirs and RANK[mine] <= RANK[theirs]:
                wrong.append(f"{module} may not import {other}: see CONTRIBUTING.md")
    assert not wrong, "\n".join(wrong)


def circles() -> set[frozenset[str]]:
    """Groups of modules each of which imports, by way of others, every other."""
    reach = {module: {module} for module in paths()}
    while True:
        wider = {
            module: far.union(*(reach[other] for near in far for other in imports_of(near) if other in reach))
            for module, far in reach.items()
        }
        if wider == reach:
            break
        reach = wider
    groups = (frozenset(b for b in far if a in reach[b]) for a, far in reach.items())
    return {group for group in groups if len(group) > 1}


def test_modules_import_each_other_in_no_circle():
    assert circles() == set()


def test_a_folder_holds_few_modules_and_a_module_and_a_function_few_lines():
    long = {module for module, path in paths().items() if path.read_text("utf-8").count("\n") > MOST_LINES}
    assert long == set()
    functions = {
        f"{module}.{node.name}"
        for module, tree in sources().items()
        for node in ast.walk(tree)
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
        and (node.end_lineno or 0) - node.lineno >= MOST_STATEMENT_LINES
    }
    assert functions == set()
    folders = Counter(path.parent.relative_to(ROOT).as_posix() for path in paths().values())
    large = {folder for folder, count in folders.items() if count > MOST_MODULES + 1}
    assert large == set()
    for package in ("app", "algorithms"):
        assert {path.stem for path in (ROOT / package).glob("*.py")} <= {"__init__", "__main__"}


def test_a_package_says_what_it_holds_and_imports_nothing():
    for module, path in paths().items():
        if path.stem == "__init__":
            assert ast.get_docstring(sources()[module]), module
            assert not imports_of(module), module
    for package in ("app", "algorithms"):
        for folder in {path.parent for path in (ROOT / package).rglob("*.py")}:
            assert (folder / "__init__.py").is_file(), folder


def test_no_public_class_has_the_name_of_another():
    names = Counter(
        node.name
        for tree in sources().values()
        for node in tree.body
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
    )
    assert {name for name, count in names.items() if count > 1} == set()


def loaded_by(*names: str) -> set[str]:
    """Top-level names and own modules that a new process has loaded once ``names`` have been imported."""
    code = (
        "import importlib, sys\n"
        "for name in sys.argv[1:]: importlib.import_module(name)\n"
        "print(*sorted(sys.modules))"
    )
    told = subprocess.run(
        [sys.executable, "-c", code, *names], capture_output=True, text=True, cwd=ROOT, check=True
    )
    full = set(told.stdout.split())
    return full | {name.split(".")[0] for name in full}


def test_algorithms_load_neither_the_page_nor_a_plotting_library_nor_a_progress_bar():
    loaded = loaded_by(*modules("algorithms"))
    assert "algorithms.methods.registry" in loaded  # the question was asked of everything
    assert not loaded & ({"app", "viser", "tqdm", "tyro", "rich"} | PLOTTERS)
    named = importers("app", "viser", "tqdm", *PLOTTERS)
    assert {module for module in named if module.startswith("algorithms")} == set()


@pytest.mark.parametrize(
    "package",
    ["app.model", "app.evaluation", "app.jobs", "app.report.result_files", "app.report.html_report"],
)
def test_what_is_tested_without_a_browser_loads_no_server(package):
    assert "viser" not in loaded_by(*modules(package))


def test_a_page_that_nobody_has_opened_has_loaded_nothing_that_only_merges_need():
    loaded = loaded_by("app.page.application")
    assert "viser" in loaded
    assert not loaded & {
        "numba",
        "scipy.fft",
        "scipy.ndimage",
        "scipy.spatial",
        "skimage.measure",
        "distributed",
    }
    assert not loaded & PLOTTERS


def test_only_the_table_of_methods_knows_the_methods():
    knowing = importers("algorithms.methods.registry")
    inside = {module for module in knowing if module.startswith("algorithms")}
    above = ("algorithms.simulator", "algorithms.fleets")
    assert {module for module in inside if not module.startswith(above)} == set()


def test_the_names_for_others_stand_on_algorithms_alone_and_nothing_stands_on_them():
    """The command's launcher, a ``__main__``, is not asked: it has to import the command line."""
    for path in (ROOT / "mapmeld").glob("*.py"):
        named = {name.split(".")[0] for name in imported(ast.parse(path.read_text("utf-8")))}
        assert path.stem == "__main__" or not named & ({"app", "viser", "tqdm"} | PLOTTERS), path
    assert importers("mapmeld") == set()


@pytest.mark.parametrize("module", ["particle_swarm", "monte_carlo", "optimiser"])
def test_an_optimiser_knows_nothing_of_maps(module):
    named = imports_of(f"algorithms.optimisation.{module}")
    assert not {name for name in named if name.startswith(("algorithms.maps", "algorithms.spectra"))}
    assert "algorithms.optimisation.objective" not in named


def test_each_library_is_known_in_its_own_place():
    places = {
        "viser": ("app.drawing.scene", "app.web", "app.page"),
        "websockets": ("app.web",),
        "argparse": ("app.cli",),
        "tqdm": ("app.cli",),
        "sklearn": ("algorithms.detection.svm_training",),
        "distributed": ("app.jobs.dask_executor",),
        "dask": ("app.jobs.dask_executor",),
        "cyclonedds": ("app.live",),
        "roslibpy": ("app.live.rosbridge_link",),
    }
    for library, allowed in places.items():
        assert {module for module in importers(library) if not module.startswith(allowed)} == set(), library
    assert {module for module in importers(*PLOTTERS) if "figure" not in module.rsplit(".", 1)[1]} == set()


def test_the_place_of_a_file_is_known_in_one_place():
    asking = {
        module
        for module, tree in sources().items()
        for node in ast.walk(tree)
        if isinstance(node, ast.Name) and node.id == "__file__"
    }
    models = {"algorithms.verdict.probability_model", "algorithms.detection.model_file"}
    assert asking == {"app.system.data_paths", *models}


def test_every_file_of_the_frontend_is_loaded_somewhere():
    words = "\n".join(path.read_text("utf-8") for path in paths().values())
    folder = ROOT / "app" / "frontend"
    names = [path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()]
    assert len(names) > 10
    assert [name for name in names if f'"{name}"' not in words] == []


def test_no_two_scripts_of_the_page_style_the_same_class():
    """All of their styles are in force at once: a name that two of them use is drawn by both."""
    styled: dict[str, set[str]] = {}
    for script in sorted((ROOT / "app" / "frontend").glob("*.js")):
        # "line" in ".mm-legend i.mm-line{" is styled as well as "legend"
        rules = re.findall(r"^ +([^{}()=]*\.mm-[^{}()=]*)\{", script.read_text("utf-8"), flags=re.M)
        for name in {name for rule in rules for name in re.findall(r"\.(mm-[a-z]+)", rule)}:
            styled.setdefault(name, set()).add(script.name)
    shared = {"mm-tools", "mm-head"}  # where further scripts put what is theirs
    assert len(styled) > 20
    assert {
        name: scripts for name, scripts in styled.items() if len(scripts) > 1 and name not in shared
    } == {}


SETTABLE = {"time", "time_ns", "localtime", "gmtime", "ctime", "now", "today", "utcnow"}


def clocks(tree: ast.AST) -> list[str]:
    """Names by which a source asks for the time of day: ``time.time``, ``datetime.now`` and their like."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.attr in SETTABLE:
            if node.value.id in ("time", "datetime", "date"):
                found.append(f"{node.value.id}.{node.attr}")
        elif isinstance(node, ast.ImportFrom) and node.module == "time":
            found += [f"time.{one.name}" for one in node.names if one.name in SETTABLE]
    return found


def test_no_clock_that_can_be_set_decides_anything():
    """Waits, rates and graces go by the monotonic clock; the time of day stands in the log and in reports."""
    for source in ("import time\ntime.time_ns()", "from time import time", "d = date.today"):
        assert clocks(ast.parse(source))
    others = {path.stem: ast.parse(path.read_text("utf-8")) for path in (ROOT / "mapmeld").glob("*.py")}
    asking = {module: clocks(tree) for module, tree in {**sources(), **others}.items()}
    assert [module for module, found in asking.items() if found] == ["app.system.clock"]
    assert importers("app.system.clock")
    telling = {"app.report", "app.live", "app.cli"}  # files and messages, which carry the time of day
    assert {package_of(module) for module in importers("app.system.clock")} == telling


def test_contributing_lists_the_packages_that_there_are():
    told = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    table = set(re.findall(r"^\| `((?:algorithms|app)/[a-z_/]+)` \|", told, flags=re.M))
    assert table == {package.replace(".", "/") for package in RANK if "." in package}


def test_the_state_of_a_page_is_changed_by_controllers_alone():
    def changes(tree: ast.Module) -> bool:
        for node in ast.walk(tree):
            targets = node.targets if isinstance(node, ast.Assign) else []
            called = [node.func] if isinstance(node, ast.Call) else []
            for at in (*targets, *called):
                writes = at in targets or getattr(at, "attr", "") in ("update", "turn_to_map")
                owner = ast.unparse(at.value) if isinstance(at, ast.Attribute) else ""
                if writes and owner.split(".")[-1] in ("state", "_state"):
                    return True
        return False

    page = {module: tree for module, tree in sources().items() if module.startswith("app.page")}
    writers = {module for module, tree in page.items() if changes(tree)}
    allowed = {module for module in page if module.endswith("_controller")} | {"app.page.page"}
    assert "app.page.run_controller" in writers  # it is seen
    assert writers <= allowed, "who draws reads the state: see CONTRIBUTING.md"


def test_what_draws_knows_no_controller():
    drawing = ("_panel", "_display", "_view")
    for module, tree in sources().items():
        if module.endswith(drawing):
            named = {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
            assert not {name for name in named if name.endswith("_controller")}, module

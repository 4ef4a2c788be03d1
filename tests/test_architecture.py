"""Who may import whom. Each question is asked in a process that has imported nothing else."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PLOTTERS = {"matplotlib", "plotly", "bokeh", "seaborn"}


def modules(package):
    """Names of all modules under a package, entry points left out: importing them would run them."""
    for path in sorted((ROOT / package).rglob("*.py")):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        if not name.endswith("__main__"):
            yield name.removesuffix(".__init__")


def loaded_by(*names):
    """Top-level names and own modules that are loaded once ``names`` have been imported."""
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


def imports_of(module):
    """Own modules that the source of a module names in an import, wherever it stands in the file."""
    path = ROOT / Path(*module.split("."))
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def test_algorithms_load_neither_the_page_nor_a_plotting_library_nor_a_progress_bar():
    loaded = loaded_by(*modules("algorithms"))
    assert "algorithms.methods.registry" in loaded  # the question was asked of everything
    assert not loaded & ({"app", "viser", "tqdm", "tyro", "rich"} | PLOTTERS)


def offenders(package, forbidden):
    """Modules of a package whose source names something forbidden, also inside a function."""
    found = {}
    for module in modules(package):
        bad = {name for name in imports_of(module) if any(f"{name}.".startswith(f"{f}.") for f in forbidden)}
        if bad:
            found[module] = sorted(bad)
    return found


def test_no_algorithm_imports_the_page_even_inside_a_function():
    assert offenders("algorithms", {"app", "viser", "tqdm"} | PLOTTERS) == {}


def test_file_formats_know_no_method():
    above = ("methods", "verdict", "optimisation", "spectra", "maps.map_fusion")
    assert offenders("algorithms/files", {f"algorithms.{name}" for name in above}) == {}


def test_only_the_table_of_methods_knows_the_methods():
    known = offenders("algorithms", {"algorithms.methods.registry"})
    assert [module for module in known if not module.startswith("algorithms.simulator")] == []


def test_the_names_for_others_stand_on_algorithms_alone_and_nothing_stands_on_them():
    """The command's launcher, a ``__main__``, is not asked: it has to import the command line."""
    assert offenders("mapmeld", {"app", "viser", "tqdm"} | PLOTTERS) == {}
    assert {**offenders("app", {"mapmeld"}), **offenders("algorithms", {"mapmeld"})} == {}


@pytest.mark.parametrize("module", ["particle_swarm", "monte_carlo", "optimiser"])
def test_an_optimiser_knows_nothing_of_maps(module):
    named = set(imports_of(f"algorithms.optimisation.{module}"))
    assert not named & {
        "algorithms.maps.grid_map",
        "algorithms.optimisation.objective",
        "algorithms.spectra.augmented_map",
        "algorithms.maps.map_fusion",
    }


def test_the_page_does_not_know_the_command_line():
    knowing = offenders("app", {"app.cli"})
    assert [module for module in knowing if not module.startswith("app.cli")] == []


@pytest.mark.parametrize(
    "module",
    [
        *("jobs.job_thread", "drawing.grid_pixels", "model.settings", "report.result_files"),
        *("evaluation.dataset_evaluation", "evaluation.parameter_sweep", "evaluation.method_comparison"),
    ],
)
def test_what_is_tested_without_a_browser_loads_no_server(module):
    assert "viser" not in loaded_by(f"app.{module}")


def test_only_the_figures_know_a_plotting_library_and_only_the_cluster_knows_dask():
    assert all("figure" in module for module in offenders("app", PLOTTERS))
    assert set(offenders("app", {"dask", "distributed"})) == {"app.jobs.dask_executor"}


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


def clocks(source):
    """Names by which a source asks for the time of day: ``time.time``, ``datetime.now`` and their like."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.attr in SETTABLE:
            if node.value.id in ("time", "datetime", "date"):
                yield f"{node.value.id}.{node.attr}"
        elif isinstance(node, ast.ImportFrom) and node.module == "time":
            yield from (f"time.{one.name}" for one in node.names if one.name in SETTABLE)


def test_no_clock_that_can_be_set_decides_anything():
    """Waits, rates and graces go by the monotonic clock; the time of day stands in the log alone."""
    for source in ("import time\ntime.time_ns()", "from time import time", "d = date.today"):
        assert list(clocks(source))
    asking = {}
    for package in ("mapmeld", "app", "algorithms"):
        for path in sorted((ROOT / package).rglob("*.py")):
            found = list(clocks(path.read_text("utf-8")))
            if found:
                asking[path.relative_to(ROOT).as_posix()] = found
    assert asking == {}

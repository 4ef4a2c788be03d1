"""``import mapmeld``, the names for programs of others; and the command, where another package has taken a
place of its own.
"""

import ast
import dataclasses
import inspect
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from commandline import ROOT, in_a_process

import mapmeld
from mapmeld.__main__ import entry
from mapmeld.own_packages import intruder

HEAVY = {"app", "cv2", "distributed", "matplotlib", "numba", "numpy", "scipy", "viser", "yaml"}


def python(code, *, path=(), cwd=ROOT):
    """Run a text as a program, ``path`` before anything else that may be imported."""
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (*path, ROOT)))}
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=cwd, env=env)


# ---- the names


@pytest.mark.parametrize("name", mapmeld.__all__)
def test_every_name_is_there_and_says_what_it_is(name):
    what = getattr(mapmeld, name)
    if inspect.isclass(what) or inspect.isfunction(what):
        assert inspect.getdoc(what)
        assert not inspect.getdoc(what).startswith(f"{name}("), "the words that a dataclass has by itself"


def test_a_type_checker_sees_the_names_that_are_there_at_run_time():
    seen: dict[str, str] = {}
    for node in ast.walk(ast.parse(Path(mapmeld.__file__).read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module.startswith("algorithms."):
            seen |= {alias.name: node.module for alias in node.names}
    assert seen == mapmeld._MODULE_OF
    assert sorted([*seen, "__version__"]) == sorted(mapmeld.__all__)
    assert set(mapmeld.__all__) <= set(dir(mapmeld))


def test_a_name_that_is_not_there_is_an_error_as_of_any_module():
    with pytest.raises(AttributeError, match="module 'mapmeld' has no attribute 'read_mpa'"):
        mapmeld.read_mpa  # noqa: B018
    with pytest.raises(ImportError, match="cannot import name 'read_mpa'"):
        from mapmeld import read_mpa  # noqa: F401


def test_the_version_is_that_of_what_is_installed_or_unknown(monkeypatch):
    from importlib import metadata

    assert mapmeld.__version__
    monkeypatch.delitem(vars(mapmeld), "__version__")
    monkeypatch.setattr(metadata, "version", lambda name: f"7.8 of {name}")
    assert mapmeld.__version__ == "7.8 of mapmeld"

    def missing(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.delitem(vars(mapmeld), "__version__")
    monkeypatch.setattr(metadata, "version", missing)
    assert mapmeld.__version__ == "unknown"
    del mapmeld.__version__  # asked again by whoever needs it


@pytest.mark.parametrize(
    ("code", "unwanted"),
    [
        ("import mapmeld", HEAVY | {"algorithms", "argparse"}),
        ("import mapmeld; mapmeld.GridMap, mapmeld.Pose2", HEAVY - {"numpy"}),
        ("from mapmeld import *", {"app", "distributed", "matplotlib", "viser"}),
    ],
)
def test_what_is_not_used_is_not_loaded(code, unwanted):
    told = python(f"{code}\nimport sys; print(*sys.modules)")
    assert told.returncode == 0, told.stderr
    assert unwanted & set(told.stdout.split()) == set()


# ---- what they are for


def test_files_are_read_merged_and_written_by_these_names_alone(tmp_path):
    sample = str(ROOT / "sample_maps" / "office_r2_r1")  # a word does as well as a Path
    ref, mov = mapmeld.read_map(f"{sample}/map1.yaml"), mapmeld.read_map(f"{sample}/map2.yaml")
    seen = mapmeld.read_observations(f"{sample}/observation.yaml")
    result = mapmeld.merge(ref, mov, seen)
    assert isinstance(result, mapmeld.MergeResult)
    assert result.verdict.outcome is mapmeld.Outcome.MERGED
    assert result.covariance.shape == (3, 3)

    mapmeld.write_map(f"{tmp_path}/made/merged.yaml", result.fusion.merged)
    back = mapmeld.read_map(f"{tmp_path}/made/merged.yaml")
    assert (back.cells == result.fusion.merged.cells).all()
    assert back.origin == result.fusion.merged.origin
    assert {path.name for path in (tmp_path / "made").iterdir()} == {"merged.yaml", "merged.pgm"}
    mapmeld.write_observations(f"{tmp_path}/seen.yaml", seen)
    assert mapmeld.read_observations(f"{tmp_path}/seen.yaml") == seen


def test_maps_and_sightings_can_be_made_without_any_file():
    cells = np.full((40, 60), 0, np.int8)
    cells[0] = cells[-1] = 100
    grid = mapmeld.GridMap(cells, resolution=0.1, origin=mapmeld.Pose2(-1.0, -2.0, 0.0))
    seen = mapmeld.Observation(mapmeld.Pose2(), observed_x=1.0, observed_y=0.0, range=1.0, bearing=0.0)
    first = next(mapmeld.run("bilateral", grid, grid, dataclasses.replace(seen, bearing_back=0.1)))
    assert isinstance(first, mapmeld.Step)
    assert first.stage == "observe"


def test_what_a_user_can_mend_is_an_error_of_ours(tmp_path):
    with pytest.raises(mapmeld.InputFileError, match="no such file"):
        mapmeld.read_map(tmp_path / "none.yaml")
    grid = mapmeld.GridMap(np.zeros((3, 3), np.int8), resolution=0.1)
    with pytest.raises(mapmeld.OutputError, match=r"let it end in \.yaml"):
        mapmeld.write_map(tmp_path / "map.pgm", grid)
    with pytest.raises(mapmeld.SettingError, match="no method 'spectre'; known are spectra-proven, "):
        mapmeld.run("spectre", grid, grid, ())
    with pytest.raises(mapmeld.SettingError, match="needs an observation"):
        mapmeld.run("spectra-proven", grid, grid, ())
    for name in ("InputFileError", "NoAnswerError", "OutputError", "SettingError", "TooLargeError"):
        assert issubclass(getattr(mapmeld, name), mapmeld.MapMergeError)


# ---- the command


def test_python_m_mapmeld_is_the_command_and_its_help_loads_nothing_heavy():
    told = in_a_process("--help", run=("-m", "mapmeld"))
    assert told.returncode == 0
    assert told.stdout.startswith("mapmeld: merge the grid maps of two robots")
    code = (
        "import sys; from mapmeld.__main__ import entry\n"
        "sys.argv = ['mapmeld', '--help']\n"
        "try: entry()\n"
        "except SystemExit: print('loaded', *sys.modules)"
    )
    loaded = set(python(code).stdout.splitlines()[-1].split())
    assert {"loaded", "app"} <= loaded
    assert loaded & (HEAVY - {"app"}) == set()


@pytest.mark.parametrize("name", ["app", "algorithms"])
@pytest.mark.parametrize("file", ["{}/__init__.py", "{}.py"])
def test_another_package_in_a_place_of_ours_is_told_in_one_line_and_not_run(name, file, tmp_path):
    theirs = tmp_path / file.format(name)
    theirs.parent.mkdir(exist_ok=True)
    theirs.write_text("print('theirs runs')\n")
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])}
    told = subprocess.run(
        [sys.executable, "-m", "mapmeld", "--version"], capture_output=True, text=True, cwd="/", env=env
    )
    assert told.returncode == 2
    assert told.stdout == ""
    assert told.stderr == (
        f"mapmeld: another package named '{name}' ({theirs}) stands in its place; "
        "install mapmeld in an environment of its own (venv or pipx)\n"
    )


def test_a_package_of_ours_that_is_missing_is_named():
    assert intruder("app", "algorithms") == ""
    assert intruder("app", "nowhere").startswith("its package 'nowhere' is missing; install mapmeld in an ")


def test_a_part_that_is_missing_is_told_in_one_line(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "app.cli.main", None)  # as where another package was installed over it
    with pytest.raises(SystemExit) as left:
        entry()
    assert left.value.code == 2
    said = capsys.readouterr().err
    assert said.startswith("mapmeld: a part of it is missing, or another package's (import of app.cli.main ")
    assert said.endswith("; install mapmeld in an environment of its own (venv or pipx)\n")
    assert said.count("\n") == 1


def test_a_program_is_told_the_same_where_algorithms_is_another_package(tmp_path):
    (tmp_path / "algorithms.py").write_text("print('theirs runs')\n")
    told = python("import mapmeld\nmapmeld.merge", path=[tmp_path], cwd=tmp_path)
    assert told.stdout == ""
    assert told.stderr.splitlines()[-1] == (
        f"ImportError: another package named 'algorithms' ({tmp_path / 'algorithms.py'}) stands in its "
        "place; install mapmeld in an environment of its own (venv or pipx)"
    )


def test_a_program_may_have_a_module_named_app(tmp_path):
    (tmp_path / "app.py").write_text("import mapmeld\nprint(mapmeld.Pose2(1.0).x)\n")
    told = python("import app", path=[tmp_path], cwd=tmp_path)
    assert told.stdout == "1.0\n"

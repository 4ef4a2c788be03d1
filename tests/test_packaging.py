"""The wheel, installed elsewhere: it finds its samples and its static files, and its command runs."""

import os
import subprocess
import sys
import sysconfig
import zipfile

import pytest
from repository import ROOT


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel of this source tree, built without asking a registry for anything."""
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    told = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert told.returncode == 0, told.stderr
    (built,) = folder.glob("mapmeld-*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """Folder the wheel is installed in, its dependencies left to those of this environment."""
    folder = tmp_path_factory.mktemp("elsewhere")
    command = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "-q",
        "--no-deps",
        "--no-index",
        "--target",
        str(folder),
    ]
    subprocess.run([*command, str(wheel)], check=True, capture_output=True)
    return folder


def run(installed, tmp_path, *words, before=None):
    """Run Python in an empty folder, with the installed wheel before anything else but ``before``."""
    paths = [*([str(before)] if before else []), str(installed), sysconfig.get_paths()["purelib"]]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    return subprocess.run([sys.executable, *words], cwd=tmp_path, env=env, capture_output=True, text=True)


def test_the_wheel_holds_its_packages_and_what_they_show(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    assert {"mapmeld/__init__.py", "app/cli/main.py", "algorithms/methods/registry.py"} <= names
    assert {"mapmeld/py.typed", "algorithms/py.typed"} <= names  # without the second all names are Any
    kinds = ("*.js", "*.css", "*.html")
    shown = {path.relative_to(ROOT).as_posix() for kind in kinds for path in (ROOT / "app").rglob(kind)}
    assert shown
    assert shown <= names
    for source, target in (("static", "app/_static"), ("sample_maps", "app/_sample_maps")):
        files = {path.relative_to(ROOT / source) for path in (ROOT / source).rglob("*") if path.is_file()}
        assert files, f"{source} is empty"
        assert {f"{target}/{path.as_posix()}" for path in files} <= names


def test_no_test_and_no_cache_is_in_the_wheel(wheel):
    names = zipfile.ZipFile(wheel).namelist()
    assert not [name for name in names if name.startswith("tests/") or "__pycache__" in name]


def test_the_installed_command_explains_itself(installed, tmp_path):
    script = installed / "bin" / "mapmeld"
    told = run(installed, tmp_path, str(script), "--help")
    assert told.returncode == 0, told.stderr
    assert "Examples:" in told.stdout


def test_the_installed_command_tells_of_another_package_in_its_place(installed, tmp_path):
    theirs = tmp_path / "theirs" / "app"
    theirs.mkdir(parents=True)
    (theirs / "__init__.py").write_text("")
    script = installed / "bin" / "mapmeld"
    told = run(installed, tmp_path, str(script), "--help", before=theirs.parent)
    assert told.returncode == 2
    assert f"another package named 'app' ({theirs / '__init__.py'}) stands in its place" in told.stderr
    assert told.stderr.count("\n") == 1


def test_a_program_imports_what_was_installed(installed, tmp_path):
    code = (
        "import mapmeld, app.system.data_paths as p\n"
        "print(mapmeld.__file__, mapmeld.__version__)\n"
        "print(mapmeld.read_map(next(iter(p.samples().values())) / 'map1.yaml').resolution)"
    )
    told = run(installed, tmp_path, "-c", code)
    assert told.returncode == 0, told.stderr
    assert told.stdout == f"{installed / 'mapmeld' / '__init__.py'} 0.1.0\n0.05\n"


def test_the_installed_package_finds_its_samples_and_static_files(installed, tmp_path):
    code = (
        "import app, app.system.data_paths as p\n"
        "print(app.__file__)\n"
        "print(p.static(), p.static().is_dir())\n"
        "print(*sorted(p.samples()))"
    )
    told = run(installed, tmp_path, "-c", code)
    assert told.returncode == 0, told.stderr
    where, static, samples = told.stdout.splitlines()
    assert where.startswith(str(installed))
    assert static == f"{installed / 'app' / '_static'} True"
    assert samples.split() == sorted(path.parent.name for path in ROOT.glob("sample_maps/*/map1.yaml"))


def test_the_installed_command_merges_a_sample_that_came_with_it(installed, tmp_path):
    code = (
        "import sys, app.system.data_paths as p; from app.cli.main import main\n"
        "case = next(iter(p.samples().values()))\n"
        "sys.exit(main(['evaluate', str(case)]))"
    )
    told = run(installed, tmp_path, "-c", code)
    assert told.returncode == 0, told.stderr
    assert "overall" in told.stdout

import pytest

from algorithms.files.case_folder import case_folders, read_case
from algorithms.observations.observation import encounter
from app.cli.main import main


def refused(capsys, *words):
    with pytest.raises(SystemExit) as left:
        main(["samples", *words])
    assert left.value.code == 2
    return capsys.readouterr().err


def test_any_number_of_other_buildings_can_be_simulated(tmp_path, capsys):
    assert main(["samples", str(tmp_path), "--building", "apartment", "--seeds", "3-4"]) == 0
    made = [folder.name for folder in case_folders(tmp_path)]
    assert made == [
        f"apartment_{seed}_{robots}" for seed in ("0003", "0004") for robots in ("r2_r1", "r3_r2")
    ]
    said = capsys.readouterr().out
    assert all(name in said for name in made)
    for folder in case_folders(tmp_path):
        case = read_case(folder)
        at = encounter(case.observations[0])
        off = case.truth.T_ref_mov.apply(at.x_mov) - at.x_ref
        assert abs(off).max() < 0.6


def test_a_building_is_simulated_with_as_many_sightings_as_asked_for(tmp_path, capsys):
    words = ["--building", "warehouse", "--seeds", "105", "--sightings", "3"]
    assert main(["samples", str(tmp_path), *words]) == 0
    for rough in (False, True):
        case = read_case(tmp_path / "warehouse_0105_r2_r1", rough)
        assert len(case.observations) == 3


def test_every_wrong_pairing_of_several_buildings_can_be_written(tmp_path, capsys):
    words = ["--building", "corridor,apartment", "--seeds", "3", "--wrong-pairs"]
    assert main(["samples", str(tmp_path), *words]) == 0
    made = [read_case(folder) for folder in case_folders(tmp_path)]
    assert len(made) == 8
    for case in made:
        assert case.truth.expected == "refuse"
        assert "corridor seed 3" in case.truth.source
        assert "apartment seed 3" in case.truth.source


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--building", "castle"], "there is no building 'castle', but office"),
        (["--building", "office", "--seeds", "9-2"], "--seeds is '9-2'"),
        (["--building", "office", "--seeds", "many"], "--seeds is 'many'"),
        (["--building", "office", "--overlap", "0.9"], "--overlap is 0.9"),
        (["--building", "office", "--sightings", "0"], "--sightings is 0; it must lie in [1, 64]"),
        (["--seeds", "3"], "need --building"),
        (["--sightings", "3"], "need --building"),
        (["--wrong-pairs"], "need --building"),
        (["--building", "office,castle"], "there is no building 'castle'"),
        (["--building", "office", "--wrong-pairs"], "needs two buildings"),
    ],
)
def test_what_cannot_be_simulated_is_told(tmp_path, capsys, words, said):
    assert said in refused(capsys, str(tmp_path), *words)
    assert not any(tmp_path.iterdir())

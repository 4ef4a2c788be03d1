"""Every method is compared once, and once more without knowledge where that makes a difference."""

from algorithms.methods.registry import METHODS
from app.evaluation.compared_methods import COMPARED


def test_every_method_is_told_what_is_known_under_its_own_name():
    informed = {name: each for name, each in COMPARED.items() if each.informed}
    assert list(informed) == list(METHODS)
    for name, each in informed.items():
        assert (each.method, each.title) == (name, METHODS[name].title)


def test_those_that_use_knowledge_and_need_none_stand_there_without_it_too():
    alone = {each.method for each in COMPARED.values() if not each.informed}
    assert alone == {
        name for name, method in METHODS.items() if method.uses_observation and not method.needs_sighting
    }
    assert len({each.title for each in COMPARED.values()}) == len(COMPARED)

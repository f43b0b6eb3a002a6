"""Problems as plain data: nothing of a scene is lost, names carry the units, what is infinite has a name."""

import re

import pytest

from validation.errors import InputError
from validation.problems.problem import problem
from validation.scenes.plain import scene_data, words
from validation.scenes.scene import load_scene

SI = r"_(m|kg|kg_m2|N|kg_per_m3|Pa|m_per_s2?|deg|rad|rad_per_s|N_per_m|Pa_per_m|Hz|s)$"
WORDS = {"poisson", "hypothesis", "law", "motion", "layers", "joints", "base", "contacts", "settled", "at", "shape"}
WORDS |= {"geometry", "restitution", "blocks", "contact", "fixed", "name", "pairs", "touches"}
WORDS |= {"block", "corner", "on", "edge"}  # of a stated contact


def test_a_record_is_no_plain_data():
    with pytest.raises(InputError) as caught:
        scene_data(load_scene("waves-site"))
    assert caught.value.field == "input.shape"


def test_every_number_of_the_data_names_its_unit_and_has_its_words():
    meanings = {name.rpartition(".")[2]: text for name, text in words()}
    assert all(re.search(SI, name) or name in WORDS for name in meanings)
    for name in ("locked", "column", "joint", "impact"):
        for table in scene_data(problem(name).scene).values():
            for key in table if isinstance(table, dict) else ():
                assert re.search(SI, key) or key in WORDS, key

"""The words of the verdict stand in every file for a target, with the reason beside them."""

import html
import json
import tomllib
from dataclasses import replace

import pytest
from target import gains_of

from mptune.export.c_source import c_sources
from mptune.export.description import fmi2_description, fmi3_description
from mptune.export.structured_text import structured_text
from mptune.export.table import as_json, as_toml
from mptune.params.headline import Headline
from mptune.robust.headline import Judgement

REASON = "sampled: 3 of 16 plants are unstable"


def judged(controller, study, word, stated=Headline.MET, reason=""):
    """Return a controller that came out as told: as written, and in its gains file."""
    margins = replace(controller.margins, judgement=Judgement(word, REASON))
    satisfied = "satisfied" if stated is Headline.MET else "violated"
    source = gains_of(study, verdict=stated, reason=reason, margins=satisfied)
    return replace(controller, margins=margins, source=source)


@pytest.mark.parametrize("word", list(Headline))
def test_every_format_says_the_word_and_the_reason(controller, study, word):
    one = judged(controller, study, word)
    line = f"verdict: {word} ({REASON})"
    for text in (*c_sources(one).values(), structured_text(one), as_toml(one)):
        assert line in text
        assert ("NOT satisfied" in text) == (word is not Headline.MET)
    assert f'#define MPTUNE_VERDICT "{word}"' in c_sources(one)["mptune_parameters.h"]
    for text in (fmi2_description(one, "token", []), fmi3_description(one, "token")):
        assert line in html.unescape(text)
    for values in (tomllib.loads(as_toml(one)), json.loads(as_json(one))):
        assert values["verdict"]["verdict"] == word
        assert values["verdict"]["reason"] == REASON
        assert values["verdict"]["forced"] == (word is not Headline.MET)


@pytest.mark.parametrize(
    ("written", "stated", "word", "said"),
    [
        (Headline.MET, Headline.ON_PAPER, Headline.ON_PAPER, "the machine"),
        (Headline.NOT_MET, Headline.ON_PAPER, Headline.NOT_MET, REASON),
        (Headline.ON_PAPER, Headline.NOT_MET, Headline.NOT_MET, "the machine"),
    ],
)
def test_the_gains_file_s_verdict_counts_as_well(controller, study, written, stated, word, said):
    one = judged(controller, study, written, stated, "the machine")
    assert (one.word, one.reason) == (word, said)
    assert not one.trusted


def test_a_gains_file_without_a_word_is_taken_by_its_margins(controller, study):
    early = gains_of(study, margins="violated")
    assert replace(controller, source=early).word is Headline.NOT_MET
    assert controller.source.verdict == ""
    assert (controller.word, controller.trusted) == (Headline.MET, True)

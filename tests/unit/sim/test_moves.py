"""Manoeuvres one after another, and recorded references."""

import numpy as np
import pytest

from mptune.errors import InputError
from mptune.params.load import load_study
from mptune.signals.trajectory import reference
from mptune.sim.moves import distinct_moves, moves_of


def test_the_papers_set_adds_up_and_rests_between(boom):
    moves = moves_of(boom.study.manoeuvre)
    assert moves.duration == pytest.approx(9.0)
    assert moves.travel == pytest.approx(0.21, rel=1e-6)
    assert moves.reach == pytest.approx(0.07, rel=1e-6)
    for time, position in ((2.0, 0.035), (4.4, 0.0), (6.5, 0.07), (8.9, 0.0)):
        found = reference(time, moves.pieces)
        assert found[0] == pytest.approx(position, abs=1e-12)
        assert found[1] == pytest.approx(0, abs=1e-12)


def with_recording(write_study, tmp_path, text, name="move.csv"):
    (tmp_path / name).write_text(text)
    move = f'[{{kind = "file", file = "{name}", rest = "1 s"}}]'
    return write_study({"manoeuvre": move, "verification.repeats": "1"})


def test_recorded_reference_is_followed_in_its_own_units(write_study, tmp_path):
    time = np.linspace(0, 2, 41)
    place = 20 * (1 - np.cos(np.pi * time / 2))
    rows = [f"{1e3 * t},{x}" for t, x in zip(time, place, strict=True)]
    path = with_recording(
        write_study, tmp_path, "time [ms],position [mm]\n" + "\n".join(rows) + "\n"
    )
    moves = moves_of(load_study(path).study.manoeuvre)
    assert moves.duration == pytest.approx(3.0)
    found = np.array([reference(t, moves.pieces)[0] for t in time])
    np.testing.assert_allclose(found, 1e-3 * (place - place[0]), atol=2e-6)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time,position\n0,0\n1,1\n", "no unit"),
        ("t [s],x [mm]\n0,0\n", "header"),
        ("time [s],position [MPa]\n0,0\n", "dimension"),
        ("time [s],position [mm]\n0,0\n1,1\n", "4 are needed"),
        ("time [s],position [mm]\n0,0\n1,1\n0.5,2\n2,3\n", "line 4"),
        ("time [s],position [mm]\n0,0\n1,nan\n2,2\n3,3\n", "line 3"),
        ("time [s],position [mm]\n0,0\n1\n2,2\n3,3\n", "line 3"),
        ("time [s],position [mm]\n0,0\n1,9999\n2,2\n3,0\n", "stroke"),
    ],
)
def test_a_bad_recording_is_refused_with_its_place(write_study, tmp_path, text, words):
    path = with_recording(write_study, tmp_path, text)
    with pytest.raises(InputError, match=words):
        load_study(path)


def test_a_missing_recording_is_named(write_study):
    move = '[{kind = "file", file = "gone.csv", rest = "1 s"}]'
    path = write_study({"manoeuvre": move})
    with pytest.raises(InputError, match=r"gone\.csv"):
        load_study(path)


def test_a_move_beyond_the_stroke_is_refused(load_boom):
    with pytest.raises(InputError, match="leaves the stroke"):
        load_boom('manoeuvre=[{kind="sine", distance="-200 mm", duration="2 s", rest="1 s"}]')


def manoeuvre_of(load_boom, *moves):
    text = '{{kind="{}", distance="{} mm", duration="{} s", rest="1 s"}}'
    return load_boom(
        f"manoeuvre=[{', '.join(text.format(*move) for move in moves)}]"
    ).study.manoeuvre


def test_moves_that_differ_by_their_distance_only_are_one_move_of_a_linear_loop(load_boom):
    manoeuvre = manoeuvre_of(load_boom, ("quintic", 30, 1), ("quintic", 50, 1), ("quintic", -20, 1))
    (only,) = distinct_moves(manoeuvre)
    assert only.travel == pytest.approx(1.0)


def test_moves_of_another_kind_or_duration_are_other_moves_in_a_fixed_order(load_boom):
    moves = (("quintic", 30, 1), ("quintic", 30, 2), ("trapezoid", -30, 1))
    there, back = (distinct_moves(manoeuvre_of(load_boom, *some)) for some in (moves, moves[::-1]))
    assert len(there) == 3
    for one, other in zip(there, back, strict=True):
        np.testing.assert_array_equal(one.pieces, other.pieces)


def test_a_recorded_move_keeps_its_distance(write_study, tmp_path):
    text = "time [s],position [mm]\n0,0\n1,3\n2,5\n3,9\n"
    manoeuvre = load_study(with_recording(write_study, tmp_path, text)).study.manoeuvre
    (only,) = distinct_moves(manoeuvre)
    np.testing.assert_array_equal(only.pieces, moves_of(manoeuvre).pieces)

"""Frequency responses from CSV files: each form they may have, each fault."""

from __future__ import annotations

import numpy as np
import pytest

from mptune.errors import InputError
from mptune.params.load import load_study
from mptune.params.measured import read_response_table

OMEGA = np.array([1.0, 10.0, 30.0, 100.0])
RESPONSE = np.array([1.0, 0.9 - 0.2j, 0.5 - 0.7j, -0.3 - 0.2j])
COHERENCE = np.array([0.99, 0.9, 0.5, 0.1])
DEGREES = np.degrees(np.angle(RESPONSE))


def write(folder, header, *columns, name="rig.csv", delimiter=","):
    rows = np.stack(columns, axis=1).tolist()
    lines = [header, *(delimiter.join(map(repr, row)) for row in rows)]
    path = folder / name
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


REAL = (RESPONSE.real, RESPONSE.imag)
FORMS = (
    ("frequency [rad/s],real,imaginary", OMEGA, *REAL),
    ("Imag [-],Frequency [Hz],Re [1]", RESPONSE.imag, OMEGA / (2 * np.pi), RESPONSE.real),
    ("freq [kHz],re,im", OMEGA / (2e3 * np.pi), *REAL),
    ("omega [rad/s],magnitude [dB],phase [deg]", OMEGA, 20 * np.log10(abs(RESPONSE)), DEGREES),
    ("f [Hz],gain [abs],phase [rad]", OMEGA / (2 * np.pi), abs(RESPONSE), np.angle(RESPONSE)),
    ("ω [rad/s],amplitude [-],phase [°]", OMEGA, abs(RESPONSE), DEGREES - 360),
)


@pytest.mark.parametrize("form", FORMS, ids=[form[0] for form in FORMS])
def test_every_form_is_the_same_response(tmp_path, form):
    table = read_response_table(write(tmp_path, *form))
    np.testing.assert_allclose(table.omega, OMEGA, rtol=1e-12)
    np.testing.assert_allclose(table.response, RESPONSE, rtol=1e-12)
    assert np.isnan(table.coherence).all()


@pytest.mark.parametrize("delimiter", [";", "\t"])
def test_other_delimiters_and_a_coherence_are_read(tmp_path, delimiter):
    header = delimiter.join(["frequency [rad/s]", "real", "imaginary", "coherence"])
    path = write(tmp_path, header, OMEGA, *REAL, COHERENCE, delimiter=delimiter)
    np.testing.assert_array_equal(read_response_table(path).coherence, COHERENCE)


def test_an_empty_coherence_is_not_known(tmp_path):
    path = write(tmp_path, "frequency [rad/s],re,im,coherence", OMEGA, *REAL, COHERENCE)
    path.write_text(path.read_text(encoding="utf-8").replace(",0.5\n", ",\n"), encoding="utf-8")
    found = read_response_table(path).coherence
    assert np.isnan(found[2])
    assert np.isfinite(found[[0, 1, 3]]).all()


FAULTS = (
    (("frequency,re,im", OMEGA, *REAL), "no unit"),
    (("frequency [1/s],re,im", OMEGA, *REAL), "radians or cycles"),
    (("frequency [kN],re,im", OMEGA, *REAL), "wrong dimension"),
    (("re,im", *REAL), "write a frequency"),
    (("frequency [Hz],magnitude [dB],imag", OMEGA, *REAL), "either pair"),
    (("frequency [Hz],real", OMEGA, RESPONSE.real), "either pair"),
    (("frequency [Hz],re,im,phase [deg]", OMEGA, *REAL, DEGREES), "either pair"),
    (("frequency [Hz],magnitude,phase [deg]", OMEGA, *REAL), "write dB or 1"),
    (("frequency [Hz],magnitude [kN],phase [deg]", OMEGA, *REAL), "write dB or 1"),
    (("frequency [Hz],magnitude [dB],phase", OMEGA, *REAL), "no unit"),
    (("frequency [Hz],re,im,coherense", OMEGA, *REAL, COHERENCE), "no column"),
    (("frequency [Hz],f [Hz],re,im", OMEGA, OMEGA, *REAL), "is read already"),
    (("frequency [Hz],re,re", OMEGA, *REAL), "names two columns"),
    (("frequency [Hz],re,im", OMEGA[::-1], *REAL), "does not come after"),
    (("frequency [Hz],re,im", OMEGA - 1, *REAL), "above 0"),
    (("frequency [Hz],re,im", OMEGA[:3], *(one[:3] for one in REAL)), "3 rows where 4"),
    (("frequency [Hz],re,im", OMEGA, RESPONSE.real * np.nan, RESPONSE.imag), "no response"),
    (("frequency [Hz],re,im", OMEGA * np.inf, *REAL), "beyond all bounds"),
    (("frequency [Hz],re,im,coherence", OMEGA, *REAL, 2 * COHERENCE), "within 0 and 1"),
)


@pytest.mark.parametrize(("form", "message"), FAULTS, ids=[form[0] for form, _ in FAULTS])
def test_faults_are_named(tmp_path, form, message):
    path = write(tmp_path, *form)
    with pytest.raises(InputError, match=message) as caught:
        read_response_table(path)
    assert str(path) in str(caught.value)


def test_a_file_that_was_cut_off_or_is_no_table_is_refused(tmp_path):
    path = write(tmp_path, "frequency [Hz],re,im", OMEGA, *REAL)
    text = path.read_text(encoding="utf-8")
    path.write_text(text[:-8], encoding="utf-8")
    with pytest.raises(InputError, match=r"line 5.*cut off"):
        read_response_table(path)
    path.write_text(text.replace("30.0", "thirty"), encoding="utf-8")
    with pytest.raises(InputError, match=r"line 4.*no row of numbers"):
        read_response_table(path)
    path.write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="empty"):
        read_response_table(path)
    with pytest.raises(InputError, match="does not exist"):
        read_response_table(tmp_path / "none.csv")


def study_with(write_study, *overrides, **changes):
    named = {f"uncertainty.{key}": text for key, text in changes.items()}
    return load_study(write_study(named), overrides)


def test_a_study_holds_what_it_measured_and_its_hash_by_content(write_study, tmp_path, boom):
    write(tmp_path, "frequency [rad/s],re,im", OMEGA, *REAL)
    study = study_with(write_study, measured='["rig.csv"]')
    (one,) = study.uncertainty.measured
    assert one.name == "rig"
    assert one.rows[1] == (10.0, 0.9, -0.2)
    assert study.hash() != boom.hash()
    write(tmp_path, "frequency [rad/s],re,im", OMEGA, *REAL, name="other.csv")
    assert study_with(write_study, measured='["other.csv"]').hash() == study.hash()
    write(tmp_path, "frequency [rad/s],re,im", OMEGA, 1.01 * RESPONSE.real, RESPONSE.imag)
    assert study_with(write_study, measured='["rig.csv"]').hash() != study.hash()
    instead = study_with(write_study, measured='["other.csv"]', measured_place='"instead"')
    assert instead.hash() != study.hash()


def test_a_set_and_an_override_may_name_measured_files(write_study, tmp_path, study_file):
    write(tmp_path, "frequency [rad/s],re,im", OMEGA, *REAL)
    path = write_study({"uncertainty.sets.section-5-1.measured": '["rig.csv"]'})
    assert load_study(path).uncertainty.measured == ()
    assert load_study(path, uncertainty="section-5-1").uncertainty.measured[0].name == "rig"
    over = load_study(write_study({}), ['uncertainty.measured=["rig.csv"]'])
    assert over.uncertainty.measured[0].name == "rig"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"measured": '["gone.csv"]'}, "does not exist"),
        ({"measured": '["rig.csv", "rig.csv"]'}, "two measured responses of one name"),
        ({"measured": '"rig.csv"'}, "uncertainty.measured"),
        ({"measured": "[1]"}, "uncertainty.measured"),
        ({"measured": '["zero.csv"]'}, "magnitude of zero"),
        ({"measured": '["rig.csv"]', "measured_place": '"above"'}, "choose 'beside' or 'instead'"),
        ({"measured_place": '"instead"'}, "nothing measured"),
    ],
)
def test_wrong_keys_are_refused(write_study, tmp_path, changes, message):
    write(tmp_path, "frequency [rad/s],re,im", OMEGA, *REAL)
    nothing = np.zeros(4)
    write(tmp_path, "frequency [rad/s],re,im", OMEGA, nothing, nothing, name="zero.csv")
    with pytest.raises(InputError, match=message):
        study_with(write_study, **changes)

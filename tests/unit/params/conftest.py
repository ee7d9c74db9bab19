"""Studies written beside one another: a base in a folder, and what lies over it."""

from __future__ import annotations

import pytest


@pytest.fixture
def write(tmp_path):
    def write(name, text):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.fixture
def base(write, study_file):
    """Write the boom study as a base in a folder of its own, with some text replaced."""

    def write_base(*replaced, name="base/study.toml"):
        text = study_file.read_text(encoding="utf-8")
        for old, new in replaced:
            assert old in text
            text = text.replace(old, new)
        return write(name, text)

    return write_base


@pytest.fixture
def child(write, base):
    """Write a study over the boom study."""

    def write_child(text="", *replaced):
        base(*replaced)
        return write("crane/study.toml", f'base = "../base/study.toml"\n{text}')

    return write_child

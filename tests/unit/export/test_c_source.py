"""The C sources: clean under three compilers, self-contained, and loud where forced."""

import re
import shutil
import subprocess

import numpy as np
import pytest
from target import EXACT, STRICT, any_compiler, gcc, write_sources, zig

from mptune.export.c_source import c_comment, c_sources
from mptune.export.formats import Precision
from mptune.force.search_space import search_space

PRECISIONS = list(Precision)
M4 = ("-target", "thumb-freestanding-eabihf", "-mcpu=cortex_m4")


@pytest.fixture(scope="module", params=PRECISIONS)
def folder(request, study, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    write_sources(study, folder, request.param)
    return folder


def objects(compiler, folder, target, *flags):
    """Compile every source on its own and return what the compiler said."""
    target.mkdir()
    sources = [str(path) for path in sorted(folder.glob("*.c"))]
    done = subprocess.run(
        [*compiler, *flags, *STRICT, *EXACT, "-c", *sources],
        cwd=target,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, done.stderr


@pytest.mark.parametrize(
    ("find", "flags"), [(gcc, ()), (zig, ()), (zig, M4)], ids=["gcc", "clang", "cortex-m4"]
)
def test_sources_compile_without_a_word(folder, tmp_path, find, flags):
    any_compiler()
    compiler = find()
    if compiler is None:
        pytest.skip("another C compiler is here, this one is not")
    assert objects(compiler, folder, tmp_path / "objects", *flags) == (0, "")


def test_of_the_library_only_the_root_is_used_and_no_variable_is_global(folder, tmp_path):
    """fabs is an instruction; memory is neither allocated nor shared."""
    compiler, nm = any_compiler(), shutil.which("nm")
    if nm is None:
        pytest.skip("nm is needed")
    assert objects(compiler, folder, tmp_path / "objects", "-fno-stack-protector")[0] == 0
    files = [str(path) for path in (tmp_path / "objects").glob("*.o")]
    done = subprocess.run([nm, *files], capture_output=True, text=True, check=True)
    symbols = [line.split()[-2:] for line in done.stdout.splitlines() if " " in line]
    defined = {name for kind, name in symbols if kind != "U"}
    library = {name for kind, name in symbols if kind == "U"} - defined
    assert library <= {"sqrt", "sqrtf", "memcpy", "memmove", "memset", "_GLOBAL_OFFSET_TABLE_"}
    assert {kind for kind, _ in symbols} <= set("UTtRrAa")  # code and constants, no data


def test_the_sources_keep_what_embedded_rules_ask_for(controller):
    for name, text in c_sources(controller).items():
        code = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
        assert not re.search(r"\b(goto|malloc|calloc|free|printf|do|union)\b", code), name
        assert "while" not in code, name  # every loop counts
        for function in re.findall(r"^\w[\w ]*\**\b(\w+)\([^;]*?\)\n\{", code, flags=re.MULTILINE):
            body = code.split(f"{function}(", 1)[1].split("\n}", 1)[0]
            assert not re.search(rf"\b{function}\(", body), f"{function} calls itself"


@pytest.mark.parametrize("which", ["controller", "single"])
def test_the_data_read_back_as_the_numbers(request, which):
    controller = request.getfixturevalue(which)
    text = c_sources(controller)["mptune_parameters.c"]
    found = dict(re.findall(r"\.(\w+) = ([^,]+),", text))
    hexadecimal = dict(re.findall(r"\.(\w+) = [^,]+, /\* (\S+) \*/", text))
    assert set(found) == {one.key for one in controller.numbers.all()}
    for one in controller.numbers.all():
        literal = found[one.key]
        value = float(np.float32(literal[:-1])) if which == "single" else float(literal)
        assert value == one.value == float.fromhex(hexadecimal[one.key])
        assert literal.endswith("F") == (which == "single")


def test_tables_are_those_of_the_search_space(controller):
    text = c_sources(controller)["mptune_parameters.c"]

    def table(name):
        block = re.search(rf"{name}\[.*?= \{{\n(.*?)\n\}};", text, flags=re.DOTALL).group(1)
        return np.array([[int(v) for v in re.findall(r"(\d+)U", row)] for row in block.split("\n")])

    space = search_space()
    assert (table("mptune_valves") == space.valves).all()
    assert (table("mptune_switches") == space.switches).all()
    ports = table("mptune_ports")
    assert (ports[:, 0] == space.first).all()
    assert (ports[:, 3] == space.second_count).all()


def test_every_file_says_where_it_comes_from(controller, study):
    for name, text in c_sources(controller).items():
        assert f"study_hash: {study.hash()}" in text, name
        assert "margins as written: satisfied" in text, name
        assert "WARNING" not in text, name
    assert "#define MPTUNE_MARGINS_SATISFIED 1 " in c_sources(controller)["mptune_parameters.h"]


def test_forced_files_say_so_loudly(forced):
    for name, text in c_sources(forced).items():
        assert "NOT satisfied" in text.split("*/")[0], name
    assert "#define MPTUNE_MARGINS_SATISFIED 0 " in c_sources(forced)["mptune_parameters.h"]


def test_no_name_ends_or_nests_a_comment():
    text = c_comment(["study: a*/b/*c\\"])
    assert text.count("*/") == text.count("/*") == 1
    assert "\\" not in text

"""The controller as function mock-up units of FMI 2.0 and 3.0, from the same C as the target's."""

from __future__ import annotations

import io
import tempfile
import uuid
import zipfile
from importlib import import_module, resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mptune.errors import MptuneError
from mptune.export.c_source import FLAGS, c_sources
from mptune.export.compiler import compile_library
from mptune.export.description import (
    MODEL,
    build_description,
    fmi2_description,
    fmi3_description,
)
from mptune.export.table import as_toml
from mptune.export.variables import variables
from mptune.files import write_whole

if TYPE_CHECKING:
    from mptune.export.controller import TargetController

_HEADERS = {
    2: ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
    3: ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
}


def write_units(controller: TargetController, folder: Path) -> tuple[Path, ...]:
    """Compile, check and write ``controller-fmi2.fmu`` and ``controller-fmi3.fmu``.

    Raises
    ------
    MptuneError
        If the extra or a compiler is missing, or a unit does not pass its validation.
    """
    units = {version: build_unit(controller, version) for version in (2, 3)}
    return tuple(
        write_whole(folder / f"controller-fmi{version}.fmu", content)
        for version, content in units.items()
    )


def build_unit(controller: TargetController, version: int) -> bytes:
    """Return one function mock-up unit, compiled for this platform, sources included.

    Raises
    ------
    MptuneError
        If the extra or a compiler is missing, or the unit does not pass its validation.
    """
    fmpy = _fmpy()
    token = _token(controller)
    sources = _sources(controller, version, token)
    compiled = sorted(name for name in sources if name.endswith(".c"))
    if version == 2:
        place, description = fmpy.platform, fmi2_description(controller, token, compiled)
    else:
        place, description = fmpy.platform_tuple, fmi3_description(controller, token)
        sources["buildDescription.xml"] = build_description(compiled, FLAGS)
    library = f"{MODEL}{fmpy.sharedLibraryExtension}"
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", description)
        archive.writestr("resources/controller.toml", as_toml(controller))
        archive.writestr(f"binaries/{place}/{library}", _compiled(sources, compiled, library))
        for name, text in sources.items():
            archive.writestr(f"sources/{name}", text)
    _validate(content)
    return content.getvalue()


def _fmpy() -> Any:
    try:
        return import_module("fmpy")
    except ImportError as error:
        raise MptuneError(
            "function mock-up units need the extra `fmu`: pip install 'mptune[fmu]'"
        ) from error


def _token(controller: TargetController) -> str:
    """Return an identity that belongs to these numbers and no others."""
    numbers = ",".join(f"{one.key}={one.value.hex()}" for one in controller.numbers.all())
    text = ",".join([controller.numbers.precision, *controller.provenance().values(), numbers])
    return "{" + str(uuid.uuid5(uuid.NAMESPACE_OID, text)) + "}"


def _sources(controller: TargetController, version: int, token: str) -> dict[str, str]:
    """Return the controller, its interface and the standard's headers (2-clause BSD licence)."""
    folder = resources.files("mptune.export").joinpath("fmi")
    headers = resources.files("fmpy").joinpath("c-code")
    starts = [one.start for one in variables(controller.study) if one.start is not None]
    starts_text = ", ".join(repr(start) for start in starts)
    return {
        **c_sources(controller),
        **{
            name: folder.joinpath(name).read_text("utf-8")
            for name in ("unit.h", "unit.c", f"fmi{version}.c")
        },
        **{name: headers.joinpath(name).read_text("utf-8") for name in _HEADERS[version]},
        "unit_token.h": f'#define UNIT_TOKEN "{token}"\n#define UNIT_START {{{starts_text}}}\n',
    }


def _compiled(sources: dict[str, str], names: list[str], library: str) -> bytes:
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for name, text in sources.items():
            (folder / name).write_text(text, encoding="utf-8")
        flags = (*FLAGS, "-fvisibility=hidden")
        built = compile_library([folder / name for name in names], folder / library, flags)
        return built.read_bytes()


def _validate(content: io.BytesIO) -> None:
    validation = import_module("fmpy.validation")
    content.seek(0)
    problems = validation.validate_fmu(content)
    if problems:
        raise MptuneError("the function mock-up unit is not valid: " + "; ".join(problems))

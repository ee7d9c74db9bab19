"""``modelDescription.xml`` of both versions of FMI, and the list of sources of FMI 3.0."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

from mptune.escaping import printable
from mptune.export.controller import WARNING
from mptune.export.variables import UNITS, variables
from mptune.params.gains import version

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.export.controller import TargetController
    from mptune.export.variables import Variable

MODEL = "mptune_controller"
_VARIABILITY = {"input": "continuous", "parameter": "fixed", "output": "discrete"}
_FMI2_TYPES = {"real": "Real", "integer": "Integer", "boolean": "Boolean"}
_FMI3_TYPES = {"real": "Float64", "integer": "Int32", "boolean": "Boolean"}


def fmi2_description(controller: TargetController, token: str, sources: Sequence[str]) -> str:
    """Return ``modelDescription.xml`` of FMI 2.0."""
    root = _root(controller, "2.0", guid=token)
    simulation = ET.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=MODEL,
        canHandleVariableCommunicationStepSize="true",
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate="true",
    )
    files = ET.SubElement(simulation, "SourceFiles")
    for name in sources:
        ET.SubElement(files, "File", name=name)
    _units(root)
    _categories(root)
    _experiment(root, controller)
    model = ET.SubElement(root, "ModelVariables")
    outputs = []
    for number, variable in enumerate(variables(controller.study)):
        scalar = ET.SubElement(model, "ScalarVariable", _attributes(variable, number))
        ET.SubElement(scalar, _FMI2_TYPES[variable.kind], _values(variable))
        if variable.causality == "output":
            outputs.append(number + 1)
    structure = ET.SubElement(root, "ModelStructure")
    for name in ("Outputs", "InitialUnknowns"):
        unknowns = ET.SubElement(structure, name)
        for index in outputs:
            ET.SubElement(unknowns, "Unknown", index=str(index))
    return _text(root)


def fmi3_description(controller: TargetController, token: str) -> str:
    """Return ``modelDescription.xml`` of FMI 3.0."""
    root = _root(controller, "3.0", instantiationToken=token)
    period = controller.study.study.controller.fast_sampling_period
    ET.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=MODEL,
        canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUState="true",
        fixedInternalStepSize=repr(period),
    )
    _units(root)
    _categories(root)
    _experiment(root, controller)
    model = ET.SubElement(root, "ModelVariables")
    listed = variables(controller.study)
    for number, variable in enumerate(listed):
        attributes = _attributes(variable, number) | _values(variable)
        ET.SubElement(model, _FMI3_TYPES[variable.kind], attributes)
    time = {"name": "time", "causality": "independent", "variability": "continuous"}
    ET.SubElement(model, "Float64", time | {"valueReference": str(len(listed))})
    structure = ET.SubElement(root, "ModelStructure")
    for name in ("Output", "InitialUnknown"):
        for number, variable in enumerate(listed):
            if variable.causality == "output":
                ET.SubElement(structure, name, valueReference=str(number))
    return _text(root)


def build_description(sources: Sequence[str], flags: Sequence[str]) -> str:
    """Return FMI 3.0's ``buildDescription.xml``."""
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    build = ET.SubElement(root, "BuildConfiguration", modelIdentifier=MODEL)
    options = {"language": "C99", "compilerOptions": " ".join(flags)}
    group = ET.SubElement(build, "SourceFileSet", options)
    for name in sources:
        ET.SubElement(group, "SourceFile", name=name)
    return _text(root)


def _root(controller: TargetController, fmi: str, **identity: str) -> ET.Element:
    provenance = controller.provenance()
    texts = [f"{key}: {value}" for key, value in provenance.items()]
    texts.append(f"verdict: {controller.word} ({controller.reason})")
    texts.append(f"margins as written: {controller.verdict}")
    if not controller.trusted:
        texts = [*WARNING, *texts]
    return ET.Element(
        "fmiModelDescription",
        {
            "fmiVersion": fmi,
            "modelName": MODEL,
            "description": printable("; ".join(texts)),
            "generationTool": f"mptune {version()}",
            "generationDateAndTime": printable(controller.date),
            "variableNamingConvention": "structured",
            **identity,
        },
    )


def _units(root: ET.Element) -> None:
    definitions = ET.SubElement(root, "UnitDefinitions")
    for name, exponents in UNITS.items():
        unit = ET.SubElement(definitions, "Unit", name=name)
        ET.SubElement(unit, "BaseUnit", {base: str(power) for base, power in exponents.items()})


def _categories(root: ET.Element) -> None:
    categories = ET.SubElement(root, "LogCategories")
    ET.SubElement(categories, "Category", name="logStatusError")


def _experiment(root: ET.Element, controller: TargetController) -> None:
    period = controller.study.study.controller.fast_sampling_period
    ET.SubElement(root, "DefaultExperiment", startTime="0", stepSize=repr(period))


def _attributes(variable: Variable, number: int) -> dict[str, str]:
    values = {
        "name": variable.name,
        "valueReference": str(number),
        "causality": variable.causality,
        "variability": _VARIABILITY[variable.causality],
        "description": variable.description,
    }
    if variable.causality == "output":
        values["initial"] = "calculated"
    return values


def _values(variable: Variable) -> dict[str, str]:
    values = {"unit": variable.unit} if variable.unit else {}
    return values if variable.start is None else values | {"start": repr(variable.start)}


def _text(root: ET.Element) -> str:
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, "unicode") + "\n"

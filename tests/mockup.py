"""A function mock-up unit of the controller, stepped by fmpy."""

from __future__ import annotations

import shutil

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

INPUTS = (
    "position_reference",
    "velocity_reference",
    "acceleration_reference",
    "position",
    "pressure_a",
    "pressure_b",
    "pressure_high",
    "pressure_low",
    *(f"converter[{i}]" for i in range(1, 5)),
)


class Unit:
    """One instance, with inputs and outputs by name."""

    def __init__(self, path, step):
        description = read_model_description(str(path), validate=True)
        self.references = {one.name: one.valueReference for one in description.modelVariables}
        names = [(one.name, one.causality) for one in description.modelVariables]
        self.inputs = [name for name, causality in names if causality == "input"]
        self.states = [name for name, _ in names if name.startswith("state_")]
        self.folder, self.time_step, self.time = extract(str(path)), step, 0.0
        self.version = int(description.fmiVersion[0])
        kind = {2: FMU2Slave, 3: FMU3Slave}[self.version]
        self.slave = kind(
            guid=description.guid if self.version == 2 else description.instantiationToken,
            unzipDirectory=self.folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="controller",
        )
        self.slave.instantiate()

    def _of(self, *names):
        return [self.references[name] for name in names]

    def set(self, values):
        references = self._of(*values)
        setter = self.slave.setReal if self.version == 2 else self.slave.setFloat64
        setter(references, list(values.values()))

    def real(self, *names):
        getter = self.slave.getReal if self.version == 2 else self.slave.getFloat64
        return getter(self._of(*names))

    def integer(self, *names):
        getter = self.slave.getInteger if self.version == 2 else self.slave.getInt32
        return getter(self._of(*names))

    def boolean(self, *names):
        return self.slave.getBoolean(self._of(*names))

    def start(self, first, load):
        if self.version == 2:
            self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.set({"load_force": load, **dict(zip(self.inputs, first, strict=True))})
        self.slave.exitInitializationMode()

    def step(self, inputs):
        self.set(dict(zip(self.inputs, (float(value) for value in inputs), strict=True)))
        self.slave.doStep(currentCommunicationPoint=self.time, communicationStepSize=self.time_step)
        self.time += self.time_step
        (force,), (stopped,) = self.real("force_reference"), self.boolean("stopped")
        return force, float(stopped), *self.integer(*self.states)

    def close(self):
        self.slave.terminate()
        self.slave.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)

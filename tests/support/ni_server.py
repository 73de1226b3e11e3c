"""A small NI gRPC Device Server with one module, which plays volts from a file in a loop.

    python ni_server.py VOLTS.npy [SPEED]

prints its port, and ends with its standard input. It speaks the public protocol `nidaqmx.proto` by
the code that the package nidaqmx itself has of it, as far as an IEPE measurement needs; rates and
codes are those of an NI 9234 and of NI-DAQmx. A sample is taken when its time has come; SPEED is
seconds of the module in one of the wall.
"""

# ruff: noqa: N802 - names of the protocol

import importlib
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import grpc
import numpy as np

# The package keeps what it made of the public nidaqmx.proto under this name.
messages = importlib.import_module("nidaqmx._stubs.nidaqmx_pb2")
services = importlib.import_module("nidaqmx._stubs.nidaqmx_pb2_grpc")

INPUTS = ("ai0", "ai1", "ai2", "ai3")
MODULE = "cDAQ1Mod1"
STANDARD_GRAVITY_M_S2 = 9.80665
NO_DEVICE, NO_INPUT, OVERWRITTEN, RESERVED, NO_TEDS = (
    -200220,
    -200170,
    -200279,
    -50103,
    -200741,
)
INITIALIZE, ATTACH = 1, 2  # of SessionInitializationBehavior


class Task:
    """What one session has asked for."""

    def __init__(self):
        self.per_volt, self.columns = [], []
        self.rate_hz, self.buffer, self.started_s, self.taken = 1000.0, 0, None, 0


# Attributes of NI-DAQmx: whether there are such channels, and which.
FAULTY = {
    0x2A09: "open_inputs",
    0x2A0A: "open_inputs",
    0x3088: "short_inputs",
    0x3089: "short_inputs",
}


class Module(services.NiDAQmxServicer):
    """The module; `volts` is (n, 4), `open_inputs` names circuits without a sensor,
    `short_inputs` those whose supply is at fault.

    As NI's own, it keeps the task of a program that has gone, and a started task has the module.
    """

    def __init__(self, volts, speed=1.0):
        self.volts, self.speed = volts, speed
        self.open_inputs, self.short_inputs = [], []
        self.teds = {}  # place, as cDAQ1Mod1/ai0: bytes of the sensor's memory
        self.tasks = {}

    def _fail(self, context, code):
        context.set_trailing_metadata((("ni-error", str(code)),))
        context.abort(grpc.StatusCode.UNKNOWN, f"NI says something about {code}")

    def GetSystemInfoAttributeUInt32(self, request, context):
        return messages.GetSystemInfoAttributeUInt32Response(value=25)

    def CreateTask(self, request, context):
        name, wanted = request.session_name, request.initialization_behavior
        if wanted == ATTACH and name not in self.tasks:
            context.abort(grpc.StatusCode.FAILED_PRECONDITION, "no such session")
        if wanted == INITIALIZE and name in self.tasks:
            context.abort(grpc.StatusCode.ALREADY_EXISTS, "there is such a session")
        is_new = name not in self.tasks
        self.tasks.setdefault(name, Task())
        response = messages.CreateTaskResponse(new_session_initialized=is_new)
        response.task.name = name
        return response

    def GetTaskAttributeString(self, request, context):
        return messages.GetTaskAttributeStringResponse(value=request.task.name)

    def ClearTask(self, request, context):
        self.tasks.pop(request.task.name)
        return messages.ClearTaskResponse()

    def _add(self, request, context, per_volt):
        device, _, name = request.physical_channel.partition("/")
        if device != MODULE:
            self._fail(context, NO_DEVICE)
        if name not in INPUTS:
            self._fail(context, NO_INPUT)
        task = self.tasks[request.task.name]
        task.columns.append(INPUTS.index(name))
        task.per_volt.append(per_volt)

    def CreateAIForceIEPEChan(self, request, context):
        self._add(request, context, 1e3 / request.sensitivity)
        return messages.CreateAIForceIEPEChanResponse()

    def CreateAIAccelChan(self, request, context):
        self._add(request, context, 1e3 * STANDARD_GRAVITY_M_S2 / request.sensitivity)
        return messages.CreateAIAccelChanResponse()

    def CfgSampClkTiming(self, request, context):
        # 51200 Hz over 1 to 31: the next higher rate is made.
        task = self.tasks[request.task.name]
        task.rate_hz = 51_200 / max(min(int(51_200 / request.rate * (1 + 1e-12)), 31), 1)
        task.buffer = request.samps_per_chan
        return messages.CfgSampClkTimingResponse()

    def GetTimingAttributeDouble(self, request, context):
        rate_hz = self.tasks[request.task.name].rate_hz
        return messages.GetTimingAttributeDoubleResponse(value=rate_hz)

    def StartTask(self, request, context):
        if any(task.started_s is not None for task in self.tasks.values()):
            self._fail(context, RESERVED)
        task = self.tasks[request.task.name]
        task.started_s, task.taken = time.monotonic(), 0
        return messages.StartTaskResponse()

    def StopTask(self, request, context):
        self.tasks[request.task.name].started_s = None
        return messages.StopTaskResponse()

    def _waiting(self, request, context):
        task = self.tasks[request.task.name]
        if task.started_s is None:
            return 0
        made = int((time.monotonic() - task.started_s) * self.speed * task.rate_hz)
        if made - task.taken > task.buffer:
            self._fail(context, OVERWRITTEN)
        return made - task.taken

    def GetReadAttributeUInt32(self, request, context):
        wanted = request.attribute_raw or request.attribute
        value = len(self.tasks[request.task.name].columns)
        if wanted == messages.READ_ATTRIBUTE_AVAIL_SAMP_PER_CHAN:
            value = self._waiting(request, context)
        elif wanted != messages.READ_ATTRIBUTE_NUM_CHANS:
            context.abort(grpc.StatusCode.UNIMPLEMENTED, f"attribute {wanted}")
        return messages.GetReadAttributeUInt32Response(value=value)

    def ConfigureTEDS(self, request, context):
        if request.physical_channel not in self.teds:
            self._fail(context, NO_TEDS)
        return messages.ConfigureTEDSResponse()

    def GetPhysicalChanAttributeBytes(self, request, context):
        data = self.teds[request.physical_channel]
        return messages.GetPhysicalChanAttributeBytesResponse(value=data)

    def GetReadAttributeBool(self, request, context):
        names = getattr(self, FAULTY[request.attribute_raw])
        return messages.GetReadAttributeBoolResponse(value=bool(names))

    def GetReadAttributeString(self, request, context):
        names = getattr(self, FAULTY[request.attribute_raw])
        return messages.GetReadAttributeStringResponse(value=", ".join(names))

    def ReadAnalogF64(self, request, context):
        task = self.tasks[request.task.name]
        n = min(request.num_samps_per_chan, self._waiting(request, context))
        rows = np.arange(task.taken, task.taken + n) % len(self.volts)
        task.taken += n
        values = self.volts[np.ix_(rows, task.columns)] * task.per_volt
        return messages.ReadAnalogF64Response(read_array=values.T.ravel(), samps_per_chan_read=n)


def serve(module):
    """Start a server on any free port; return both."""
    server = grpc.server(ThreadPoolExecutor(2))
    services.add_NiDAQmxServicer_to_server(module, server)
    port = server.add_insecure_port("127.0.0.1:0")
    server.start()
    return server, port


if __name__ == "__main__":
    running, at = serve(Module(np.load(sys.argv[1]), float((sys.argv[2:] or ["1"])[0])))
    sys.stdout.write(f"{at}\n")
    sys.stdout.flush()
    sys.stdin.read()  # to its end: whoever started this has gone
    running.stop(None)

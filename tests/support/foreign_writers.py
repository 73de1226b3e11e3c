"""Files as other programs write them, made of given numbers."""

import struct

import h5py
import numpy as np


def table(columns, delimiter="\t", decimal=".", form="%.9e"):
    """Rows of numbers as text."""
    rows = [delimiter.join(form % x for x in row) for row in np.column_stack(columns)]
    text = "\n".join(rows) + "\n"
    return text.replace(".", ",") if decimal == "," else text


def signalcalc(freq, frf, unit="(m/s²)(N)"):
    """One FRF as the SignalCalc analyser exports it: Latin-1, names and units in two lines."""
    head = [
        "Units: Ratio",
        "Ref Chan:Resp Chan\tI0-Z:0-Z",
        "Channel Name\t : ",
        "Channel Comment\t : ",
        "",
        "Frequency\t Real\t Imaginary",
        "",
        "Units:",
        f"Hz\t{unit}\t ",
    ]
    rows = [f"{f:.13e}\t{h.real:16.7g}\t{h.imag:16.7g}" for f, h in zip(freq, frf, strict=True)]
    return "\r\n".join([*head, *rows, ""]).encode("latin-1")


def pulse(freq, frfs, unit="(m/s²)/N", *, coherence=None):
    """FRFs one after the other as PULSE exports them: facts line by line, a counter first.

    Each has the coherence behind it, where one is given.
    """
    blocks = []
    for i, frf in enumerate(frfs):
        head = [
            "Header Size:\t12",
            "Decimal Symbol:\t.",
            f"Title:\tFrequency Response H1(Response {i + 1},Force)",
            "Function:\tFrequency Response H1",
            "X-Axis type:\tLinear",
            "X-Axis unit:\tHz",
            f"X-Axis size:\t{len(freq)}",
            f"Y-Axis unit:\t{unit}",
            "Z-Axis size:\t1",
        ]
        rows = [
            f"{k + 1}\t{f:.6f}\t{h.real:.9e}\t{h.imag:.9e}"
            for k, (f, h) in enumerate(zip(freq, frf, strict=True))
        ]
        blocks.append("\r\n".join([*head, *rows]))
        if coherence is not None:
            facts = ["Header Size:\t3", "Function:\tCoherence", "X-Axis unit:\tHz"]
            both = enumerate(zip(freq, coherence, strict=True))
            rows = [f"{k + 1}\t{f:.6f}\t{c:.9e}" for k, (f, c) in both]
            blocks.append("\r\n".join([*facts, *rows]))
    return ("\r\n\r\n".join(blocks) + "\r\n").encode("latin-1")


def lms_text(freq, frf, *, response="Point:3:-Z", reference="Point:10:-Z", averages=3):
    """One FRF as Testlab exports it to text: a fact a line, in five columns that have no names."""
    facts = {
        "Span": "800 Hz",
        "X axis unit": "Hz",
        "Y axis unit": "g/N",
        "Reference DOF id": reference,
        "Reference point id node": reference.split(":")[1],
        "DOF id": response,
        "Number of averages": averages,
        "Window type": "Exponential",
        "Frequency resolution": "1 Hz",
    }
    head = [f"{key}\t{value}\t\t\t" for key, value in facts.items()]
    rows = [
        f"{f:25.9e}\t{h.real:25.9e}\t{h.imag:25.9e}\t\t" for f, h in zip(freq, frf, strict=True)
    ]
    return "\r\n".join([*head, *rows, ""]).encode("latin-1")


def kyowa(rate_hz, signals, units):
    """Time records in the manner of Kyowa's recorders: a fact a line, names and units by rows."""
    n = len(signals)
    head = [
        '"ID番号","EDX-100A"',
        '"Title","ハンマー"',
        f'"Sampling(Hz)","{rate_hz}"',
        ",".join(['"CH No"', *(f'"CH-{i + 1}"' for i in range(n))]),
        ",".join(['"Range"', *(f'"{10000 * (i + 1)}"' for i in range(n))]),
        ",".join(['"Unit"', *(f'"{unit}"' for unit in units)]),
    ]
    t = np.arange(len(signals[0])) / rate_hz
    rows = [",".join(f"{x:.9g}" for x in row) for row in np.column_stack([t, *signals])]
    return "\r\n".join([*head, *rows, ""]).encode("cp932")


def lvm(step, sections, *, columns="No", decimal=".", units=("N", "m/s^2"), dimension="Time"):
    """LabVIEW measurement of sections of channels {name: samples}."""
    head = [
        "LabVIEW Measurement\t",
        "Writer_Version\t2",
        "Reader_Version\t2",
        "Separator\tTab",
        f"Decimal_Separator\t{decimal}",
        "Multi_Headings\tYes",
        f"X_Columns\t{columns}",
        "Time_Pref\tAbsolute",
        "Date\t2024/03/01",
        "***End_of_Header***\t",
        "\t",
    ]
    for channels in sections:
        names, values = list(channels), list(channels.values())
        gap = "\t\t" if columns == "Multi" else "\t"
        counts = gap.join(str(len(one)) for one in values)
        head += [
            f"Channels\t{len(names)}",
            f"Samples\t{counts}",
            "Y_Unit_Label\t" + gap.join(units[: len(names)]),
            "X_Dimension\t" + gap.join([dimension] * len(names)),
            "X0\t" + gap.join(["0.0000000000000000E+0"] * len(names)),
            "Delta_X\t" + gap.join([f"{step:.6E}"] * len(names)),
            "***End_of_Header***\t",
        ]
        x = [f"{i * step:.9f}" for i in range(len(values[0]))]
        cells = [[f"{v:.9f}" for v in one] for one in values]
        if columns == "Multi":
            title = "\t".join(f"X_Value\t{name}" for name in names)
            rows = [
                "\t".join(f"{a}\t{v}" for v in row)
                for a, row in zip(x, zip(*cells, strict=True), strict=True)
            ]
        else:
            title = "X_Value\t" + "\t".join(names)
            first = x if columns == "One" else [""] * len(x)
            rows = [
                "\t".join([a, *row]) for a, row in zip(first, zip(*cells, strict=True), strict=True)
            ]
        head += [f"{title}\tComment", *rows, ""]
    text = "\r\n".join(head)
    if decimal == ",":
        told = text.index("Multi_Headings")
        text = text[:told] + text[told:].replace(".", ",")
    return text.encode("latin-1")


def wav(rate_hz, channels, *, kind="pcm16"):
    """Sound file of channels from -1 to 1."""
    table = np.column_stack(channels)
    code, bits = {"pcm16": (1, 16), "pcm24": (1, 24), "pcm32": (1, 32), "float32": (3, 32)}[kind]
    if code == 3:
        data = table.astype("<f4").tobytes()
    else:
        whole = np.rint(table * 2.0 ** (bits - 1)).astype("<i4")
        data = whole.astype("<i2").tobytes()
        if bits == 32:
            data = whole.tobytes()
        elif bits == 24:
            data = whole.reshape(-1, 1).view(np.uint8)[:, :3].tobytes()
    frame = table.shape[1] * bits // 8
    fmt = struct.pack("<HHIIHH", code, table.shape[1], rate_hz, rate_hz * frame, frame, bits)
    chunks = b"fmt " + struct.pack("<I", len(fmt)) + fmt + b"LIST" + struct.pack("<I", 4) + b"INFO"
    chunks += b"data" + struct.pack("<I", len(data)) + data
    return b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks


def mat73(path, variables):
    """MATLAB 7.3: HDF5 behind 512 bytes, columns first, complex as pairs, texts as numbers."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in variables.items():
            if isinstance(value, str):
                data = np.array([[ord(c)] for c in value], dtype=np.uint16)
                file.create_dataset(name, data=data).attrs["MATLAB_class"] = np.bytes_("char")
                continue
            array = np.atleast_2d(value)
            array = array.T if np.ndim(value) == 1 else array  # a column, as MATLAB has it
            if np.iscomplexobj(array):
                pairs = np.empty(array.shape, dtype=[("real", "f8"), ("imag", "f8")])
                pairs["real"], pairs["imag"] = array.real, array.imag
                array = pairs
            data = file.create_dataset(name, data=array.T, compression="gzip")
            data.attrs["MATLAB_class"] = np.bytes_("double")
    head = b"MATLAB 7.3 MAT-file, Platform: PCWIN64, Created by: test".ljust(124) + b"\x00\x02IM"
    with path.open("r+b") as file:
        file.write(head)


def rattlesnake(path, freq_step, frf, coherence, *, averages=5, unit=("g", "lbf")):
    """Netcdf of a modal test: frf (lines, responses, references), coherence (lines, responses)."""
    n_lines, n_resp, n_ref = frf.shape
    frame = 2 * (n_lines - 1)
    text = h5py.string_dtype()
    n = n_resp + n_ref
    with h5py.File(path, "w") as file:
        file.attrs["sample_rate"] = np.float64(freq_step * frame)
        file.create_dataset("time_data", data=np.zeros((n, 8)))
        channels = file.create_group("channels")
        told = {
            "node_number": [str(101 + i) for i in range(n_resp)] + ["101"] * n_ref,
            "node_direction": ["Z+"] * n_resp + ["Z-"] * n_ref,
            "unit": [unit[0]] * n_resp + [unit[1]] * n_ref,
            "channel_type": ["Acceleration"] * n_resp + ["Force"] * n_ref,
        }
        for name, words in told.items():
            channels.create_dataset(name, data=np.array(words, dtype=object), dtype=text)
        group = file.create_group("Modal")
        group.attrs["samples_per_frame"] = np.int64(frame)
        group.attrs["num_averages"] = np.int64(averages)
        group.create_dataset("frf_data_real", data=frf.real)
        group.create_dataset("frf_data_imag", data=frf.imag)
        group.create_dataset("coherence", data=coherence)
        group.create_dataset("response_channel_indices", data=np.arange(n_resp))
        group.create_dataset("reference_channel_indices", data=n_resp + np.arange(n_ref))


TESTLAB_GEOMETRY = """\
    -1                                                                          
   151                                                                          
Robot_Test
NONE
Test.Lab Rev 15A
11-Oct-17 09:34:21
11-Oct-17 09:34:21
Test.Lab Rev 15A
17-Oct-17 13:50:13 
    -1                                                                          
    -1                                                                          
   164                                                                          
         9USER_DEFINED
  1.00000000000000000D+00  1.00000000000000000D+00  1.00000000000000000D+00
 -2.73149999999999960D+02
    -1                                                                          
    -1
    15
         1         0         0        11  1.00000e-01  0.00000e+00  0.00000e+00
         2         0         0        11  2.00000e-01  0.00000e+00  0.00000e+00
         3         0         0        11  3.00000e-01  0.00000e+00  5.00000e-01
    -1
    -1
    82
         1         3         8
Upper arm
         1         2         3         0         0         0         0         0
    -1
"""  # noqa: W291 - the program fills its lines up
VKI_HEADER = """\
    -1
   151
 
NONE
NONE
                             0
                    
VKI 453 24-Feb-23 22:10:15
 24-Feb-23  22:10:15  453
    -1
"""  # noqa: W293
PERMAS_HEADER = """\
    -1
   151
arm.unv                                                                         
Project:    arm                                                                 
Component:  DFLT_COMP       Situation:  STEP_1                                  
                    
                    
Permas Version 18.00.405     on Linux-x86_64-3.1                                
12-Jul-21   09:16:13
    -1
"""  # noqa: W291, W293
NODES_2411 = """\
    -1
  2420
         1
Mesh
         1         0         0
Global Cartesian Coordinate System
    1.0000000000000000E+0    0.0000000000000000E+0    0.0000000000000000E+0
    0.0000000000000000E+0    1.0000000000000000E+0    0.0000000000000000E+0
    0.0000000000000000E+0    0.0000000000000000E+0    1.0000000000000000E+0
    0.0000000000000000E+0    0.0000000000000000E+0    0.0000000000000000E+0
    -1
    -1
  2411
         1         1         1        11
   1.0000000000000000D-01   0.0000000000000000D+00   0.0000000000000000D+00
         2         1         1        11
   2.0000000000000000D-01   0.0000000000000000D+00   0.0000000000000000D+00
         3         1         1        11
   3.0000000000000000D-01   0.0000000000000000D+00   5.0000000000000000D-01
    -1
    -1
  2412
         1        21         2         1         7         2
         0         1         1
         1         2
         2        41         2         1         7         3
         1         2         3
    -1
    -1
  1858
           1           3           1           0           0           0
NONE  NONE
    -1
"""

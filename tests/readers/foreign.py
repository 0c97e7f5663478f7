"""Recordings that other programs write, with the samples that are meant. A tool that is not there is named and left out."""

import dataclasses
import hashlib
import importlib
import io
import json
import pathlib
import shutil
import subprocess
import tarfile

import numpy as np

RATE = 48000.0
ROWS = 480
T = np.arange(ROWS) / RATE
# samples that every type below holds exactly: multiples of 1/128 below 1
V = np.round(np.sin(2 * np.pi * 1000 * T) * 100) / 128
PAIR = np.column_stack([V, -V[::-1]])


@dataclasses.dataclass
class Case:
    """A file, and what is in it: [sample] or [sample][column]."""

    file: pathlib.Path
    values: np.ndarray
    rate: float = RATE  # 0: the file does not tell
    first: int = 0
    exact: bool = True  # else a rounded form of the samples


missing = {}


def module(name, package):
    try:
        return importlib.import_module(name)
    except ImportError:
        missing[name] = package
        return None


def tool(name):
    if shutil.which(name) is None:
        missing[name] = name
        return False
    return True


def text(folder, name, content, **about):
    file = folder / name
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    return Case(file, about.pop("values", V), **about)


def lines(rows, separator=",", end="\n"):
    return end.join(separator.join(row) for row in rows) + end


def written_csv(folder):
    """CSV as spreadsheets, oscilloscopes and NumPy write it."""
    rows = [[repr(float(t)), repr(float(v))] for t, v in zip(T, V)]
    plain = lines([["t_s", "v"], *rows])
    comma = [[cell.replace(".", ",") for cell in row] for row in rows]
    coarse = [[f"{t:.6f}", f"{v:+.7f}"] for t, v in zip(T, V)]
    late = [[f"{t - 0.005:.9f}", f"{v:.7f}"] for t, v in zip(T, V)]
    ms = [[f"{t * 1e3:.8f}", f"{v:.7f}"] for t, v in zip(T, V)]
    yield text(folder, "bom.csv", "\ufeff" + plain)
    yield text(folder, "crlf.csv", plain.replace("\n", "\r\n"))
    yield text(folder, "cr.csv", plain.replace("\n", "\r"))
    yield text(folder, "german.csv", lines([["Zeit", "Spannung"], *comma], ";", "\r\n"))
    yield text(folder, "german_quoted.csv", lines([["t_s", "v"], *[[f'"{c}"' for c in row] for row in comma]]))
    yield text(folder, "tabs.csv", lines([["time", "v"], *rows], "\t"))
    yield text(folder, "excel.csv", "sep=;\r\n" + lines([["t_s", "v"], *rows], ";", "\r\n"))
    yield text(folder, "blank.csv", plain + "\n \n,,\n")
    yield text(folder, "blanks_in_cells.csv", lines([[" t_s ", " v"], *[[f" {a} ", f"\t{b}"] for a, b in rows]]))
    yield text(folder, "trailing.csv", lines([["t_s", "v", ""], *[[*row, ""] for row in rows]]))
    yield text(folder, "comments.csv", "# a\n% b\n// c\n" + plain + "# the end\n")
    yield text(folder, "coarse.csv", lines([["t_s", "v"], *coarse]))
    yield text(folder, "keysight.csv", lines([["x-axis", "1"], ["second", "Volt"], *late]))
    yield text(folder, "tektronix.csv", "Model,MSO54\nSample Interval,2.08E-05\nRecord Length,480\n\nLabels,,\nTIME,CH1\n"
               + lines(late))
    yield text(folder, "siglent.csv", "Record Length,Analog:480\nVertical Units,V\n,\nSource,CH1\nTime(s),Value\n" + lines(late))
    yield text(folder, "picoscope.csv", "Time,Channel A\r\n(ms),(V)\r\n\r\n" + lines(ms, ",", "\r\n"))
    yield text(folder, "digilent.csv", "#Digilent WaveForms\n#Device Name: AD2\n\nTime (s),Channel 1 (V)\n" + lines(late))
    yield text(folder, "rohde.csv", lines([["in s", "C1 in V"], *late]))
    yield text(folder, "microseconds.csv", lines([["Time (\u00b5s)", "v"], *[[f"{t * 1e6:.5f}", v] for t, v in zip(T, [r[1] for r in rows])]]))
    file = folder / "savetxt.csv"
    np.savetxt(file, np.column_stack([T, PAIR]), delimiter=",", header="t_s,a,b")
    yield Case(file, PAIR)


def pandas_csv(folder):
    pandas = module("pandas", "python3-pandas")
    if pandas is None:
        return
    frame = pandas.DataFrame({"t_s": T, "v": V, "w": -V})
    values = np.column_stack([V, -V])
    for name, words in {
        "plain": {"index": False},
        "row_numbers": {},
        "german": {"index": False, "sep": ";", "decimal": ","},
        "quoted": {"index": False, "quoting": 1},
        "tabs": {"index": False, "sep": "\t"},
        "excel": {"index": False, "encoding": "utf-8-sig"},
        "scientific": {"index": False, "float_format": "%.9e"},
    }.items():
        file = folder / f"pandas_{name}.csv"
        frame.to_csv(file, **words)
        yield Case(file, values)


def numpy_arrays(folder):
    def saved(name, array, values, rate=0.0):
        file = folder / f"{name}.npy"
        np.save(file, array)
        return Case(file, values, rate)

    for order in "<>":
        for kind in ("f2", "f4", "f8"):
            yield saved(f"{kind}_{'be' if order == '>' else 'le'}", V.astype(order + kind), V)
        for width in (1, 2, 4):
            scale = 2.0 ** (8 * width - 1)
            yield saved(f"i{width}{ord(order)}", (V * scale).astype(f"{order}i{width}"), V)
            yield saved(f"u{width}{ord(order)}", (V * scale + scale).astype(f"{order}u{width}"), V)
        whole = np.arange(ROWS)
        yield saved(f"i8{ord(order)}", whole.astype(order + "i8"), whole.astype(float))
        yield saved(f"c8{ord(order)}", (V + 1j * V[::-1]).astype(order + "c8"), np.column_stack([V, V[::-1]]))
    yield saved("c16", PAIR + 1j * PAIR, np.column_stack([V, V, PAIR[:, 1], PAIR[:, 1]]))
    yield saved("bool", V > 0, (V > 0).astype(float))
    yield saved("rows", PAIR, PAIR)
    yield saved("fortran", np.asfortranarray(PAIR), PAIR)
    fields = np.zeros(ROWS, [("t_s", "f8"), ("a", "i2"), ("b", ">f4"), ("c", "c8")])
    fields["t_s"], fields["a"], fields["b"], fields["c"] = T, V * 2**15, V, V + 1j * V
    yield saved("fields", fields, np.column_stack([V, V, V, V]), RATE)
    aligned = np.zeros(ROWS, np.dtype([("a", "u1"), ("time", "f8"), ("b", "f4", (2,))], align=True))
    aligned["a"], aligned["time"], aligned["b"] = V * 128 + 128, T, PAIR
    yield saved("aligned", aligned, np.column_stack([V, PAIR]), RATE)
    named = np.zeros(ROWS, [("Spannung ü", "f4")])
    named["Spannung ü"] = V
    yield saved("version3", named, V)
    long = np.zeros(ROWS, [(f"column_{i:05}", "f4") for i in range(3000)])
    yield saved("version2", long, np.zeros((ROWS, 3000)))


def sox_wav(folder):
    if not tool("sox"):
        return
    raw = folder / "raw.f32"
    V.astype("<f4").tofile(raw)
    source = ["sox", "-D", "-t", "raw", "-e", "floating-point", "-b", "32", "-r", "48000", "-c", "1", raw]
    for name, words in {"s16": ["-b", "16"], "s24": ["-b", "24"], "s32": ["-b", "32"], "u8": ["-b", "8"],
                        "f32": ["-e", "floating-point"], "f64": ["-e", "floating-point", "-b", "64"],
                        "rifx": ["-B", "-b", "16"]}.items():
        file = folder / f"sox_{name}.wav"
        subprocess.run([*source, *words, "-t", "wav", file], check=True, stderr=subprocess.DEVNULL)
        yield Case(file, V)
        piped = folder / f"sox_pipe_{name}.wav"
        from_pipe = [*source[:-1], "-", *words, "-t", "wav", "-"]
        made = subprocess.run(from_pipe, check=True, input=V.astype("<f4").tobytes(), capture_output=True)
        piped.write_bytes(made.stdout)
        yield Case(piped, V)


def ffmpeg_wav(folder):
    if not tool("ffmpeg"):
        return
    raw = folder / "raw.f32"
    V.astype("<f4").tofile(raw)
    source = ["ffmpeg", "-v", "error", "-y", "-f", "f32le", "-ar", "48000", "-ac", "1", "-i", raw]
    for codec in ("pcm_u8", "pcm_s16le", "pcm_s24le", "pcm_s32le", "pcm_f32le", "pcm_f64le"):
        for pipe in (False, True):
            file = folder / f"ffmpeg_{codec}{'_pipe' * pipe}.wav"
            words = [*source, "-c:a", codec, "-f", "wav", "-" if pipe else file]
            made = subprocess.run(words, check=True, capture_output=True)
            if pipe:
                file.write_bytes(made.stdout)
            yield Case(file, V)
    file = folder / "ffmpeg_rf64.wav"
    subprocess.run([*source, "-rf64", "always", "-c:a", "pcm_f32le", file], check=True)
    yield Case(file, V)


def other_wav(folder):
    wavfile = module("scipy.io.wavfile", "python3-scipy")
    if wavfile is not None:
        for name, array in {"i2": (PAIR * 2**15).astype("i2"), "f4": PAIR.astype("f4"), "f8": PAIR,
                            "i4": (PAIR * 2.0**31).astype("i4"), "u1": (PAIR * 128 + 128).astype("u1")}.items():
            file = folder / f"scipy_{name}.wav"
            wavfile.write(file, int(RATE), array)
            yield Case(file, PAIR)
        file = folder / "cut_off.wav"  # a recorder that never came to write the lengths
        data = bytearray((folder / "scipy_i2.wav").read_bytes())
        data[4:8] = data[40:44] = bytes(4)
        file.write_bytes(data)
        yield Case(file, PAIR)
    soundfile = module("soundfile", "python3-soundfile")
    if soundfile is not None:
        for kind, subtype in [("WAV", "PCM_16"), ("WAVEX", "PCM_24"), ("RF64", "FLOAT"), ("WAV", "DOUBLE")]:
            file = folder / f"soundfile_{kind}_{subtype}.wav"
            soundfile.write(file, PAIR, int(RATE), subtype=subtype, format=kind)
            yield Case(file, PAIR)
    if tool("octave-cli"):
        np.savetxt(folder / "v.txt", PAIR)
        script = f"v = load('{folder}/v.txt'); audiowrite('{folder}/octave.wav', v, 48000, 'BitsPerSample', 24);"
        subprocess.run(["octave-cli", "--quiet", "--no-init-file", "--eval", script], check=True, stderr=subprocess.DEVNULL)
        yield Case(folder / "octave.wav", PAIR)


def gnuradio_wav(folder):
    gnuradio = module("gnuradio.blocks", "gnuradio")
    if gnuradio is None:
        return
    from gnuradio import blocks, gr
    for subformat, name in [(blocks.FORMAT_FLOAT, "float"), (blocks.FORMAT_PCM_16, "pcm16")]:
        file = folder / f"gnuradio_{name}.wav"
        top = gr.top_block()
        top.connect(blocks.vector_source_f(V.tolist()), blocks.wavfile_sink(str(file), 1, int(RATE), blocks.FORMAT_WAV, subformat))
        top.run()
        yield Case(file, V, exact=name == "float")


def sigmf_meta(datatype, captures=({"core:sample_start": 0},), **more):
    shared = {"core:datatype": datatype, "core:version": "1.2.0", "core:sample_rate": RATE}
    shared.update({f"core:{key}": value for key, value in more.items()})
    return {"global": {k: v for k, v in shared.items() if v is not None}, "captures": list(captures), "annotations": []}


def sigmf_pair(folder, name, meta, data):
    (folder / f"{name}.sigmf-data").write_bytes(data)
    (folder / f"{name}.sigmf-meta").write_text(json.dumps(meta))
    return folder / f"{name}.sigmf-meta"


SIGMF_TYPES = {
    "f32": lambda v, e: v.astype(e + "f4"),
    "f64": lambda v, e: v.astype(e + "f8"),
    "i8": lambda v, e: (v * 2**7).astype("i1"),
    "u8": lambda v, e: (v * 2**7 + 2**7).astype("u1"),
    "i16": lambda v, e: (v * 2**15).astype(e + "i2"),
    "u16": lambda v, e: (v * 2**15 + 2**15).astype(e + "u2"),
    "i32": lambda v, e: (v * 2.0**31).astype(e + "i4"),
    "u32": lambda v, e: (v * 2.0**31 + 2.0**31).astype(e + "u4"),
}


def sigmf(folder):
    """By the specification; sigmf-python is not in Debian."""
    floats = V.astype("<f4").tobytes()
    for kind, convert in SIGMF_TYPES.items():
        for ending, order in [("", "<")] if kind.endswith("8") else [("_le", "<"), ("_be", ">")]:
            yield Case(sigmf_pair(folder, f"r{kind}{ending}", sigmf_meta(f"r{kind}{ending}"), convert(V, order).tobytes()), V)
            yield Case(sigmf_pair(folder, f"c{kind}{ending}", sigmf_meta(f"c{kind}{ending}"), convert(PAIR, order).tobytes()), PAIR)
    yield Case(sigmf_pair(folder, "channels", sigmf_meta("rf32_le", num_channels=2), PAIR.astype("<f4").tobytes()), PAIR)
    yield Case(sigmf_pair(folder, "late", sigmf_meta("rf32_le", [{"core:sample_start": 100}]), floats), V[100:], first=100)
    yield Case(sigmf_pair(folder, "offset", sigmf_meta("rf32_le", [{"core:sample_start": 7000}], offset=7000), floats), V, first=7000)
    yield Case(sigmf_pair(folder, "no_rate", sigmf_meta("rf32_le", sample_rate=None), floats), V, rate=0)
    yield Case(sigmf_pair(folder, "hash", sigmf_meta("rf32_le", sha512=hashlib.sha512(floats).hexdigest()), floats), V)
    captures = [{"core:sample_start": 0, "core:header_bytes": 44}, {"core:sample_start": 200, "core:header_bytes": 20}]
    data = bytes(44) + floats[:800] + bytes(20) + floats[800:] + b"the end"
    meta = sigmf_meta("rf32_le", captures, dataset="other.raw", trailing_bytes=7)
    file = sigmf_pair(folder, "foreign_data", meta, b"")
    (folder / "foreign_data.sigmf-data").unlink()
    (folder / "other.raw").write_bytes(data)
    yield Case(file, V)
    for form, number in [("ustar", tarfile.USTAR_FORMAT), ("gnu", tarfile.GNU_FORMAT), ("pax", tarfile.PAX_FORMAT)]:
        for name in ("x", "a_long_name_" * 12):
            archive = folder / f"{form}_{name[:6]}.sigmf"
            if form == "ustar" and len(name) > 80:
                continue
            with tarfile.open(archive, "w", format=number) as tar:
                for ending, content in [("meta", json.dumps(sigmf_meta("rf32_le")).encode()), ("data", floats)]:
                    info = tarfile.TarInfo(f"{name}/{name}.sigmf-{ending}")
                    info.size = len(content)
                    tar.addfile(info, io.BytesIO(content))
            yield Case(archive, V)


def hdf5(folder):
    """A recording of this project that h5py has changed."""
    h5py = module("h5py", "python3-h5py")
    import hertzline
    run = hertzline.scene("paper-vitreous-carbon", drive={"cycles": 3}, output={"duration_s": 1e-4}).run()
    wanted = run["v_out"]
    for name, change in {
        "integer": lambda f: f.attrs.__setitem__("sample_rate_hz", 10000000),
        "float32": lambda f: f.attrs.__setitem__("sample_rate_hz", np.float32(1e7)),
        "big_endian": lambda f: f.attrs.create("sample_rate_hz", 1e7, dtype=">f8"),
        "one_of_one": lambda f: f.attrs.__setitem__("sample_rate_hz", np.array([1e7])),
        "int32": lambda f: f.attrs.__setitem__("sample_rate_hz", np.int32(10000000)),
        "fixed_text": lambda f: f.attrs.__setitem__("columns", np.bytes_(f.attrs["columns"].encode())),
        "fixed_utf8": lambda f: f.attrs.create("columns", f.attrs["columns"].encode(),
                                               dtype=h5py.string_dtype("utf-8", 60000 // 4)),
        "text": lambda f: f.attrs.__setitem__("columns", f.attrs["columns"]),
        "texts": lambda f: f.attrs.__setitem__("columns", [f.attrs["columns"]]),
        "more": lambda f: [f.attrs.__setitem__(f"note{i}", "x" * i) for i in range(300)],
        "again": lambda f: (v := f["v_out"][:], f.__delitem__("v_out"), f.__setitem__("v_out", v)),
        "as_big_endian": lambda f: (v := f["v_out"][:], f.__delitem__("v_out"), f.create_dataset("v_out", data=v, dtype=">f8")),
    }.items() if h5py is not None else ():
        for libver in ("earliest", "latest"):
            if libver == "latest" and name in ("again", "as_big_endian", "fixed_text", "fixed_utf8"):
                continue  # other structures, which are refused with a message
            file = folder / f"h5py_{name}_{libver}.h5"
            run.save(file)
            with h5py.File(file, "a", libver=libver) as f:
                change(f)
            yield Case(file, wanted, rate=1e7)


GROUPS = [written_csv, pandas_csv, numpy_arrays, sox_wav, ffmpeg_wav, other_wav, gnuradio_wav, sigmf, hdf5]


def write_all(folder):
    """Returns all cases, each group in a folder of its own."""
    cases = []
    for group in GROUPS:
        own = pathlib.Path(folder) / group.__name__
        own.mkdir(parents=True, exist_ok=True)
        cases += group(own)
    return cases

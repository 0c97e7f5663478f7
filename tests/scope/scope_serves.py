#!/usr/bin/python3
"""Checks the promises of hertzline scope to its pages, without a browser: scope_serves.py PROMISE PROGRAM"""
import contextlib
import http.client
import json
import pathlib
import resource
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.parse
import urllib.request

import numpy as np
import zmq

from page_socket import (CHAIN, EACH_SAMPLE, FORCES, HEAD, HELD, SPECTRUM, UNTRIGGERED, WAVEFORM, PageSocket, Picture, Refused,
                         row_of)

RATE_HZ, PERIOD = 10_000_000, 10_000
LONG_ENOUGH_S = 100


def _columns_of(file):
    """Returns the columns of a NumPy recording without the time, as a stream has them: [sample][column]."""
    rows = np.load(file)
    return np.column_stack([rows[name] for name in rows.dtype.names if name != "t_s"]).astype("<f4")


class Process:
    """The program in the background, ended with the block at the latest."""

    def __init__(self, program, *words):
        self.process = subprocess.Popen([program, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def said(self, word):
        lines = []
        for line in self.process.stderr:
            lines.append(line)
            if f"{word} " in line:
                threading.Thread(target=self.process.stderr.read, daemon=True).start()
                return line.split()[-1]
        raise AssertionError("".join(lines))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()

    def interrupt(self):
        self.process.send_signal(signal.SIGINT)
        self.process.wait(LONG_ENOUGH_S)

    def summary(self):
        """Interrupts a scope with --json."""
        self.interrupt()
        return json.loads(self.process.stdout.read())


class Stand:
    def __init__(self, program, folder):
        self.program, self.folder = program, pathlib.Path(folder)
        self.endpoint = f"ipc://{folder}/stream"

    def stream(self, *words, scene="paper-stream", pace=0.05):
        # The stream of a loaded machine falls behind, and drops nothing.
        return Process(self.program, "stream", scene, "--bind", self.endpoint, "--pace", pace, "--on-overrun", "wait", *words)

    def scope(self, *words, record_to=None):
        scope = Process(self.program, "scope", "--connect", self.endpoint, "--http", "127.0.0.1:0",
                        "--record-to", record_to or self.folder, *words)
        scope.url = scope.said("scope")
        return scope

    def samples(self, count, column="v_out", scene="paper-stream", *words):
        """Returns the samples of `run`, as the stream has them."""
        file = self.folder / "run.npy"
        subprocess.run([self.program, "run", scene, "--set", f"output.duration_s={(count - 1) / RATE_HZ}", "--columns", column,
                        "-o", file, *words], check=True, stdout=subprocess.DEVNULL, timeout=LONG_ENOUGH_S)
        return _columns_of(file)[:count, 0]

    def check(self, picture, samples=None):
        """Each column's smallest and largest sample are those of the run, to the last bit.
        Simulates for seconds: for pages that are closed, since the scope drops a page that does not read."""
        end = picture.first + picture.samples
        samples = self.samples(end) if samples is None else samples
        window = samples[picture.first:end]
        assert len(window) == picture.samples, (len(window), picture)
        if picture.flags & EACH_SAMPLE:
            assert np.array_equal(window, picture.numbers), "samples differ"
            return
        edges = np.arange(picture.columns + 1) * picture.samples // picture.columns
        low = np.array([window[a:b].min() for a, b in zip(edges, edges[1:])])
        high = np.array([window[a:b].max() for a, b in zip(edges, edges[1:])])
        assert np.array_equal(low, picture.numbers[:picture.columns]), "smallest differ"
        assert np.array_equal(high, picture.numbers[picture.columns:]), "largest differ"


def pictures_hold_every_sample(stand):
    with stand.stream(), stand.scope() as scope, PageSocket(scope.url) as page:
        page.say({"view": {"span_s": 1e-3, "columns": 777}})
        picture = page.picture(condition=lambda p: p.columns == 777)
        assert picture.trigger == picture.first == picture.burst * PERIOD and picture.flags == 0, picture
        page.say({"view": {"from_s": 1.234e-4, "span_s": 2.5e-3, "columns": 1000}})  # over several bursts
        several = page.picture(condition=lambda p: p.samples == 25_000)
        assert several.first == several.trigger + 1234
        page.say({"view": {"from_s": 1e-4, "span_s": 3e-5, "columns": 500}})  # a column would hold less than a sample
        close = page.picture(condition=lambda p: p.flags & EACH_SAMPLE)
        assert close.columns == close.samples == 301
    for each in (picture, several, close):
        stand.check(each)


def other_channels_lie_in_the_same_window(stand):
    others = ["v_horn", "v_last"]
    with stand.stream(), stand.scope() as scope, PageSocket(scope.url) as page:
        page.say({"view": {"span_s": 1e-3, "columns": 777, "beside": others}})
        picture = page.picture(condition=lambda p: p.rows == 3 and not np.isnan(p.numbers).any())
        assert picture.columns == 777 and picture.trigger == picture.first == picture.burst * PERIOD
        page.say({"view": {"mode": "hold", "span_s": 1e-3, "columns": 777, "beside": others, "choice": 7}})
        held = page.picture(condition=lambda p: p.flags & HELD)
        assert page.text(lambda m: True)["choice"] == 7
        page.say({"view": {"mode": "hold", "span_s": 2e-5, "from_s": 1e-4, "beside": others}})
        close = page.picture(condition=lambda p: p.flags & EACH_SAMPLE)
        assert close.trigger == held.trigger and close.samples == 201
        page.say({"view": {"mode": "hold", "span_s": 2e-5, "from_s": 1e-4, "beside": others[1:]}})
        assert np.array_equal(row_of(page.picture(condition=lambda p: p.rows == 2), 1).numbers, row_of(close, 2).numbers), "what is held stays"
        for wrong in (["v_chain"], ["v_last[0]"], ["v_last[1"], ["v_last[1]x"], [3], "v_horn", 17 * ["v_horn"]):
            page.say({"view": {"beside": wrong}})
            replies = page.text(lambda m: any("error" in reply for reply in m.get("replies", [])))["replies"]
            assert "view.beside: allowed" in replies[0]["error"], (wrong, replies)
    for each in (picture, close):
        for row, name in enumerate(["v_out", *others]):
            stand.check(row_of(each, row), stand.samples(each.first + each.samples, name))


def each_channel_is_that_of_its_element(stand):
    """Of an array, of which each element is driven harder than the one before it."""
    scene = stand.folder / "array.toml"
    scene.write_text("""[drive]\nrepetition_hz = 1000\n[array]\nx_m = [-12e-3, 0, 12e-3]\ny_m = [0, 0, 0]\ncoupling = "none"
amplitudes_m = [1e-6, 2e-6, 3e-6]\n[end]\nmodel = "modal"\nmodes = 1\n[medium]\nload = "added_mass"\n[numerics]\nstep_s = 0.5e-6\npoles = 20\n[output]\npoints_m = [[0, 0, 20e-3], [5e-3, 0, 20e-3]]\nsample_rate_hz = 1e6\n""")
    shown = ["p_points[2]", "v_last[3]", "v_centre[1]"]
    with stand.stream("--control", f"ipc://{stand.folder}/knobs", scene=scene, pace=0.02), \
            stand.scope("--control", f"ipc://{stand.folder}/knobs") as scope, PageSocket(scope.url) as page:
        view = {"channel": shown[0], "beside": shown[1:], "span_s": 1e-3, "columns": 100, "spectrum": True}
        page.say({"view": view})
        picture = page.picture(condition=lambda p: p.rows == 3 and not np.isnan(p.numbers).any())
        of = page.text(lambda m: "measures" in m)
        page.say({"record": {"stream": "v_last", "ending": "csv"}})
        page.text(lambda m: "recording" in m and m["recording"]["samples"] > 1000)
        page.say({"record": None})
        recorded = page.text(lambda m: "recording" in m and not m["recording"]["on"])["recording"]["file"]
        page.say({"view": view | {"beside": ["v_last[4]"]}})
        assert np.isnan(row_of(page.picture(condition=lambda p: p.rows == 2), 1).numbers).all(), "there is no fourth element"
        page.say({"set": {"array.amplitudes_m": "[3 um, 2 um, 1 um]"}})
        answer = page.text(lambda m: "replies" in m)["replies"][0]["answer"]
        assert "applies_at_sample" in answer, answer
        page.say({"view": view})
        changed = page.picture(condition=lambda p: p.rows == 3 and p.trigger >= answer["applies_at_sample"]
                               and not np.isnan(p.numbers).any())
        now = page.knows(lambda m: m["scene"]["epoch"] == 1)["scene"]
        assert (now["motion"], now["epoch_sample"]) == ("begins anew", answer["applies_at_sample"])
    assert pathlib.Path(recorded).read_text().splitlines()[0].split(",")[1:] == [f"v_last_{k}_m_per_s" for k in (1, 2, 3)]
    (stand.folder / "changes.json").write_text(json.dumps([{"sample": answer["applies_at_sample"], "set": {"array.amplitudes_m": [3e-6, 2e-6, 1e-6]}}]))
    subprocess.run([stand.program, "run", scene, "--set", f"output.duration_s={(changed.first + changed.samples) / 1e6}", "--columns",
                    "p_points,v_last,v_centre", "-o", stand.folder / "run.npy", "--changes", stand.folder / "changes.json"],
                   check=True, stdout=subprocess.DEVNULL, timeout=LONG_ENOUGH_S)
    rows = np.load(stand.folder / "run.npy")
    for row, column in enumerate(["p_2_pa", "v_last_3_m_per_s", "v_centre_1_m_per_s"]):
        for each in (picture, changed):
            stand.check(row_of(each, row), rows[column].astype("<f4"))
    first, count = of["measures_of"]["first_sample"], of["measures_of"]["samples"]
    assert of["measures"]["peak"] == np.abs(rows["p_2_pa"].astype("<f4")[first:first + count]).max()


def the_page_reads_the_layout_that_is_written(stand):
    """The page has the layout from protocol.js; page_socket.py, which reads pictures in these tests, has it from its own table."""
    with stand.scope() as scope, urllib.request.urlopen(scope.url + "protocol.js", timeout=LONG_ENOUGH_S) as answer:
        assert answer.headers["Content-Type"].startswith("text/javascript")
        script = answer.read().decode()
    protocol = json.loads(script[script.index("{"):script.rindex("}") + 1])
    letters = {"Uint8": "B", "Uint16": "H", "Uint32": "I", "BigInt64": "q", "BigUint64": "Q", "Float64": "d"}
    assert [name for name, _, _ in protocol["head"]] == ["kind", "version", *Picture._fields[1:-1]]
    head = struct.Struct("<" + "".join(letters[kind] for _, kind, _ in protocol["head"]))
    assert head.format == HEAD.format and head.size == protocol["head_bytes"]
    places = [struct.calcsize(head.format[:i + 1]) for i in range(len(protocol["head"]))]
    assert [place for _, _, place in protocol["head"]] == places
    assert protocol["kinds"] == {"waveform": WAVEFORM, "spectrum": SPECTRUM, "chain": CHAIN}
    assert protocol["flags"] == {"each_sample": EACH_SAMPLE, "untriggered": UNTRIGGERED, "held": HELD, "forces": FORCES}
    assert (protocol["version"], protocol["max_columns"], protocol["most_beside"], protocol["held_samples"]) == (2, 4096, 16, 1 << 21)


def triggers_are_where_they_say(stand):
    with stand.stream(), stand.scope() as scope, PageSocket(scope.url) as page:
        view = {"trigger": "level", "level": 0.2, "hold_off_s": 5e-4, "span_s": 4e-4, "from_s": -1e-5}
        page.say({"view": view})
        page.picture(condition=lambda p: p.samples == 4000 and not p.flags & UNTRIGGERED)
        for _ in range(5):  # the first may lie within a burst; from then on the first crossing of each
            rising = page.picture()
        page.say({"view": view | {"slope": "falling", "level": -0.1}})
        falling = page.picture(condition=lambda p: p.trigger > rising.trigger + 10 * PERIOD)
        page.say({"view": view | {"level": 1e6}})  # never
        page.picture(condition=lambda p: p.flags & UNTRIGGERED)
    samples = stand.samples(falling.first + falling.samples)
    assert samples[rising.trigger] >= np.float32(0.2) > samples[rising.trigger - 1]
    burst = rising.trigger // PERIOD * PERIOD
    assert not (samples[burst:rising.trigger] >= np.float32(0.2)).any(), "not the burst's first crossing"
    assert samples[falling.trigger] <= np.float32(-0.1) < samples[falling.trigger - 1]
    for picture in (rising, falling):
        stand.check(picture, samples)


def what_is_held_can_be_looked_at_closely(stand):
    with stand.stream(), stand.scope() as scope, PageSocket(scope.url) as page:
        page.say({"view": {"mode": "single", "shot": 1, "span_s": 1e-3}})
        first = page.picture(condition=lambda p: p.flags & HELD)
        time.sleep(0.5)
        page.say({"view": {"mode": "single", "shot": 1, "span_s": 2e-5, "from_s": 1e-4}})
        close = page.picture()
        assert close.flags & HELD and close.trigger == first.trigger and close.samples == 201
        page.say({"view": {"mode": "single", "shot": 2, "span_s": 1e-3}})
        assert page.picture(condition=lambda p: p.flags & HELD and p.samples == 10_000).trigger > first.trigger
    for picture in (first, close):
        stand.check(picture)


def spectra_have_the_measures_of_run(stand):
    with stand.stream(), stand.scope() as scope, PageSocket(scope.url) as page:
        page.say({"view": {"spectrum": True, "spectrum_to_hz": 8e5, "columns": 800}})
        spectrum = page.picture(SPECTRUM)
        text = page.text(lambda m: "measures" in m)
        of = text["measures_of"]
    record = stand.samples(of["first_sample"] + of["samples"])[of["first_sample"]:]
    assert of["samples"] == PERIOD and of["first_sample"] == of["burst"] * PERIOD == spectrum.trigger
    assert text["measures"]["peak"] == np.abs(record).max()
    said = subprocess.run([stand.program, "run", "paper-stream", "--set", f"output.duration_s={(PERIOD - 1) / RATE_HZ}", "--json"],
                          check=True, capture_output=True, timeout=LONG_ENOUGH_S).stdout
    run = json.loads(said)
    for key in ("harmonics_db", "thd_r", "strongest_hz", "band_20db_low_hz", "band_20db_high_hz"):
        assert np.allclose(text["measures"][key], run[key], rtol=0.01, atol=0.02), (key, text["measures"][key], run[key])
    finely = 16  # the scope's lines lie at other places between those of the record
    lines = np.abs(np.fft.rfft(record, finely * PERIOD))[:finely * spectrum.columns].reshape(spectrum.columns, finely).max(axis=1)
    levels = 20 * np.log10(lines / lines.max())
    loud = levels > -25
    assert loud.sum() > 50 and np.median(np.abs(spectrum.numbers - levels)[loud]) < 1, "not the levels of the burst's samples"
    assert abs(np.nanmax(spectrum.numbers)) < 1e-6 and abs(spectrum.rate_hz * spectrum.columns - 8e5) < 1


def the_chain_is_that_of_run(stand):
    with stand.stream(pace=0.01), stand.scope() as scope, PageSocket(scope.url) as page:
        for name, rows, flags in (("v_chain", 6, 0), ("f_chain", 7, FORCES)):
            page.say({"view": {"chain": name}})
            picture = page.picture(CHAIN)
            while picture.flags != flags:  # the last picture of the previous request
                picture = page.picture(CHAIN)
            assert (picture.rows, picture.columns, picture.trigger) == (rows, 512, picture.burst * PERIOD)
            end = picture.first + picture.samples
            subprocess.run([stand.program, "run", "paper-stream", "--columns", name, "-o", stand.folder / "chain.npy",
                            "--set", f"output.duration_s={(end - 1) / RATE_HZ}"], check=True, stdout=subprocess.DEVNULL)
            window = _columns_of(stand.folder / "chain.npy")[picture.first:end]
            edges = -(-np.arange(513) * picture.samples // 512)  # sample s lies in column s * 512 // samples
            cells = picture.numbers.reshape(rows, 512)
            for column in range(512):
                part = window[edges[column]:edges[column + 1]]
                assert np.array_equal(np.abs(part).max(axis=0), np.abs(cells[:, column])), (name, column)


def strangers_are_refused(stand):
    def status(path, method="GET", **headers):
        request = urllib.request.Request(path, method=method, headers=headers)
        try:
            with urllib.request.urlopen(request, timeout=LONG_ENOUGH_S) as answer:
                return answer.status, answer.headers, answer.read()
        except urllib.error.HTTPError as error:
            return error.code, error.headers, error.read()

    def refused(**how):
        try:
            PageSocket(scope.url, **how)
        except Refused as refusal:
            return str(refusal).split()[1]
        raise AssertionError(f"not refused: {how}")

    with stand.scope() as scope:
        root = scope.url[:scope.url.rstrip("/").rindex("/") + 1]
        code, headers, page = status(scope.url)
        assert code == 200 and b"<title>hertzline scope" in page
        policy = headers["Content-Security-Policy"]
        assert "default-src 'none'" in policy and "script-src 'self'" in policy and "unsafe" not in policy, policy
        assert status(scope.url + "main.js")[1]["Content-Type"].startswith("text/javascript")
        assert status(scope.url, "HEAD")[0] == 200
        for path in (root, root + "0" * 32 + "/", root + "main.js"):
            assert status(path)[0] == 403, path
        for name in ("nothing.js", "../scope.cpp", "..%2f..%2fetc/passwd", "/etc/passwd", "index.html%00"):
            assert status(scope.url + name)[0] == 404, name
        assert status(scope.url, "POST")[0] == 405
        assert status(scope.url, Host="evil.example")[0] == 421
        assert status(scope.url, Origin="http://evil.example")[0] == 403
        assert refused(origin="http://evil.example") == refused(origin=None) == refused(origin="null") == "403"
        assert refused(host="evil.example", origin="http://evil.example") == "421"
        assert refused(path="other") == "404"
        port = urllib.parse.urlsplit(scope.url).port
        with PageSocket(scope.url, host=f"localhost:{port}", origin=f"http://localhost:{port}"):
            pass
        with PageSocket(scope.url) as page:
            page.text(lambda m: "state" in m)
            page.say({"view": {"columns": 1e9}})
            page.text(lambda m: any("columns" in reply.get("error", "") for reply in m.get("replies", [])))
            page.say({"set": {"drive.cycles": 3}, "view": {}})
            page.text(lambda m: any("found 2 members" in reply.get("error", "") for reply in m.get("replies", [])))
            page.send_frame(1, b"[" * 10_000)
            page.text(lambda m: any("error" in reply for reply in m.get("replies", [])))
            page.send_frame(1, b" " * 70_000)  # longer than any message of a page
            try:
                page.until(lambda m: False)
            except (EOFError, ConnectionError):
                pass
    for http in ("0.0.0.0:0", "192.0.2.1:8573", "example.org:8573", "127.0.0.1:99999", "[::1:1"):
        done = subprocess.run([stand.program, "scope", "--http", http], capture_output=True, text=True, timeout=LONG_ENOUGH_S)
        assert done.returncode == 2 and "--http" in done.stderr, (http, done)


def other_machines_are_told_of(stand):
    with Process(stand.program, "scope", "--connect", stand.endpoint, "--http", "0.0.0.0:0", "--http-to-others") as scope:
        while "scope http://0.0.0.0:" not in scope.process.stderr.readline():
            pass
        scope.interrupt()
        said = scope.process.stderr.read()
        assert "this one's address in place of 0.0.0.0" in said, said
    refused = subprocess.run([stand.program, "stream", "paper-stream", "--bind", stand.endpoint, "--scope-http", "0.0.0.0:8573"],
                             capture_output=True, text=True, timeout=LONG_ENOUGH_S)
    assert refused.returncode == 2 and "hertzline scope --http 0.0.0.0:8573 --http-to-others" in refused.stderr, refused


def no_page_takes_more_than_its_share(stand):
    def closes(page):
        try:
            page.until(lambda m: False)
        except (EOFError, ConnectionError):
            return True
        return False

    def refusal_of_the_next_page(open_already):
        with contextlib.ExitStack() as pages:
            for _ in range(open_already):
                pages.enter_context(PageSocket(scope.url))
            try:
                pages.enter_context(PageSocket(scope.url))
            except Refused as refusal:
                return str(refusal).split()[1]
        return None

    with stand.scope() as scope:
        assert refusal_of_the_next_page(15) is None
        # a busy machine may have dropped one of them, which does not answer within 5 s
        assert any(refusal_of_the_next_page(16) == "503" for _ in range(20)), "a 17th page is served"
        assert any(refusal_of_the_next_page(0) is None or time.sleep(0.1) for _ in range(600)), "closed pages are kept"
        with PageSocket(scope.url) as page:
            page.send_frame(1, b" " * 65536)
            page.text(lambda m: any("error" in reply for reply in m.get("replies", [])))
            page.send_frame(1, b" " * 65537)
            assert closes(page), "a message of more than 64 KiB is taken"
        with PageSocket(scope.url) as page:
            with contextlib.suppress(ConnectionError):
                for _ in range(4000):  # at once: in a second or two
                    page.send_frame(1, b"{}")
            assert closes(page), "4000 messages at once are taken"


def hosts_that_are_allowed_are_served(stand):
    """As through `ssh -L 9000:...`, or behind a name."""
    with stand.scope("--scope-allow", "localhost:9000", "--scope-allow", "Scope.Example.org", "--scope-allow", "[::1]:9000",
                     "--scope-allow", "https://tls.example.org", "--scope-allow", "https://tls.example.org:8443") as scope:
        own = urllib.parse.urlsplit(scope.url)
        for host in "localhost:9000", "LOCALHOST:9000", "scope.example.org", "scope.example.org:80", "[::1]:9000", own.netloc:
            with urllib.request.urlopen(urllib.request.Request(scope.url, headers={"Host": host}), timeout=LONG_ENOUGH_S) as answer:
                assert f" ws://{host} wss://{host};" in answer.headers["Content-Security-Policy"], answer.headers
            with PageSocket(scope.url, host=host, origin=f"http://{host}"):
                pass
        for host in "tls.example.org", "tls.example.org:443", "tls.example.org:8443":  # a proxy decrypts
            with urllib.request.urlopen(urllib.request.Request(scope.url, headers={"Host": host}), timeout=LONG_ENOUGH_S) as answer:
                assert f" wss://{host};" in answer.headers["Content-Security-Policy"], answer.headers
            with PageSocket(scope.url, host=host, origin=f"https://{host}"):
                pass
        for host in "localhost:9001", "scope.example.org:9000", "evil.example.org", "127.0.0.1:9000", "localhost:9000.evil.org", "tls.example.org:80", "":
            try:
                urllib.request.urlopen(urllib.request.Request(scope.url, headers={"Host": host}), timeout=LONG_ENOUGH_S)
                raise AssertionError(f"served under {host}")
            except urllib.error.HTTPError as refusal:
                assert refusal.code == 421 and b"--scope-allow HOST:PORT" in refusal.read(), host
        twice = http.client.HTTPConnection(own.hostname, own.port, timeout=LONG_ENOUGH_S)
        twice.putrequest("GET", own.path, skip_host=True)
        for host in own.netloc, "evil.example.org":
            twice.putheader("Host", host)
        twice.endheaders()
        assert twice.getresponse().status == 421
        for host, origin in (("localhost:9000", "http://evil.example.org"), ("localhost:9000", "https://localhost:9000"),
                             ("tls.example.org", "http://tls.example.org")):
            try:
                PageSocket(scope.url, host=host, origin=origin)
                raise AssertionError(f"the foreign origin {origin} is served")
            except Refused:
                pass
    for wrong in "localhost:0", "localhost:x", "localhost:", "", "a b:1", "http://localhost:9000", "https://", "https://x:0", "[::1:9000", "localhost:70000":
        refused = subprocess.run([stand.program, "scope", "--scope-allow", wrong], stderr=subprocess.PIPE, text=True, timeout=LONG_ENOUGH_S)
        assert refused.returncode == 2 and "--scope-allow" in refused.stderr and "allowed: HOST:PORT" in refused.stderr, (wrong, refused)


def strangers_that_trickle_keep_nobody_out(stand):
    """64 connections without the address's secret that never finish their request, and come again when they are closed."""
    with stand.scope() as scope:
        own = urllib.parse.urlsplit(scope.url)
        strangers = []

        def come():
            stranger = socket.create_connection((own.hostname, own.port), timeout=LONG_ENOUGH_S)
            stranger.sendall(b"GET / HTTP/1.1\r\nX:")
            strangers.append(stranger)
        for _ in range(64):
            come()
        with PageSocket(scope.url) as page:
            for _ in range(100):
                come()
                with urllib.request.urlopen(scope.url, timeout=LONG_ENOUGH_S) as answer:
                    assert answer.status == 200
            page.say({"view": {"span_s": 1e-3}})
            page.receive()  # an open page is not a stranger
        for stranger in strangers[:64]:
            try:
                assert stranger.recv(1) == b""
            except ConnectionResetError:
                pass
            stranger.close()


def who_does_not_read_is_dropped(stand):
    with stand.stream(pace=0.2) as stream, stand.scope("--json") as scope:
        with PageSocket(scope.url) as good, PageSocket(scope.url) as bad:
            for page in (good, bad):
                page.say({"view": {"columns": 4096, "pictures_per_s": 60}})
            good.text(lambda m: m.get("dropped_pages") == 0 and m.get("pages") == 2)
            last = good.text(lambda m: m.get("dropped_pages") == 1)
            assert last["pages"] == 1 or good.text(lambda m: m.get("pages") == 1)
            account = last["accounts"]["v_out"]
            assert account["frames"] > 100 and account["missing_samples"] == account["messages_malformed"] == 0, account
            picture = good.picture()
            bad.socket.settimeout(LONG_ENOUGH_S)
            try:
                while bad.socket.recv(1 << 16):
                    good.receive()
            except ConnectionError:
                pass
        summary = scope.summary()
        assert summary["pages_opened"] == 2 and summary["pages_dropped"] == 1, summary
        stream.interrupt()
    stand.check(picture)


def a_stream_is_lost_and_found_again(stand):
    with stand.scope() as scope, PageSocket(scope.url) as page:
        text = page.text(lambda m: m.get("state") == "waiting")
        assert "hertzline stream" in text["state_text"]
        with stand.stream() as stream:
            run = page.text(lambda m: "scene" in m and "run" in m["scene"])["scene"]["run"]
            pictures = [page.picture()]
            stream.process.kill()
            text = page.text(lambda m: m.get("state") == "silent")
            assert "shown again" in text["state_text"]
        with stand.stream() as stream:
            assert page.text(lambda m: "scene" in m)["scene"]["run"] != run
            page.text(lambda m: m.get("state") == "running")
            pictures.append(page.picture())
            stream.interrupt()
            assert page.text(lambda m: m.get("state") == "ended")["state_text"]
    for picture in pictures:
        stand.check(picture)


def the_scene_and_what_is_heard_are_saved(stand):
    with stand.stream("--set", "drive.amplitude_m=2.5e-6"), stand.scope() as scope, PageSocket(scope.url) as page:
        scene_hash = page.text(lambda m: "scene_hash" in m.get("scene", {}))["scene"]["scene_hash"]
        page.say({"scene": "toml"})
        toml = page.text(lambda m: any("scene_toml" in r for r in m.get("replies", [])))["replies"][0]["scene_toml"]
        (stand.folder / "saved.toml").write_text(toml)
        run = subprocess.run([stand.program, "run", stand.folder / "saved.toml", "--json"], check=True, capture_output=True)
        assert json.loads(run.stdout)["scene_hash"] == scene_hash
    with stand.stream(), PageSocket((scope := stand.scope("--json")).url) as page, scope:
        page.say({"record": {"stream": "v_last", "ending": "sigmf-meta"}})
        page.text(lambda m: "recording" in m and m["recording"]["samples"] > 50_000)
        page.say({"record": None})
        state = page.text(lambda m: "recording" in m and not m["recording"]["on"])["recording"]
        assert state["text"] == "saved" and state["missing_samples"] == 0, state
        data = np.fromfile(state["file"].replace(".sigmf-meta", ".sigmf-data"), "<f4")
        meta = json.loads(pathlib.Path(state["file"]).read_text())
        first = meta["captures"][0].get("core:global_index", 0)
        page.say({"record": {"stream": "v_last", "ending": "../../x"}})
        page.text(lambda m: any("record" in r.get("error", "") for r in m.get("replies", [])))
        page.say({"record": {"stream": "v_out", "ending": "npy"}})
        page.text(lambda m: "recording" in m and m["recording"]["samples"] > 1000)
        summary = scope.summary()  # of a scope that is ended meanwhile
        assert scope.process.returncode == 0
    assert np.array_equal(data, stand.samples(first + len(data), "v_last")[first:])
    assert [r["status"] for r in summary["recordings"]] == ["complete"] * 2, summary
    assert len(np.load(summary["recordings"][1]["file"])) == summary["recordings"][1]["samples"] > 1000, summary


def a_recording_is_saved_when_its_stream_ends(stand):
    with stand.stream() as stream, stand.scope() as scope, PageSocket(scope.url) as page:
        page.say({"record": {"stream": "v_last", "ending": "npy"}})
        page.text(lambda m: "recording" in m and m["recording"]["samples"] > 1000)
        stream.interrupt()
        state = page.text(lambda m: "recording" in m and not m["recording"]["on"])["recording"]
        assert state["text"] == "saved" and len(np.load(state["file"])) == state["samples"] > 1000, state


def a_recording_that_cannot_be_written_is_over(stand):
    with stand.stream(), PageSocket((scope := stand.scope("--json")).url) as page, scope:
        largest = 200_000  # bytes of a file
        resource.prlimit(scope.process.pid, resource.RLIMIT_FSIZE, (largest, largest))
        page.say({"record": {"stream": "v_last", "ending": "csv"}})
        page.text(lambda m: "recording" in m and m["recording"]["on"])
        state = page.text(lambda m: "recording" in m and not m["recording"]["on"])["recording"]
        summary = scope.summary()
        assert scope.process.returncode == 1
    assert "File too large" in state["text"] and 0 < state["samples"] < largest, state
    assert "File too large" in summary["recordings"][0]["status"], summary
    with stand.stream(), PageSocket((scope := stand.scope(record_to="/proc")).url) as page, scope:
        page.say({"record": {"stream": "v_last", "ending": "csv"}})
        reply = page.text(lambda m: "replies" in m)["replies"][0]
    assert "cannot write /proc/scope-v_last" in reply["error"], reply


def knobs_ask_the_stream(stand):
    """Checks the messages on the wire, with a control server of the test in the stream's place."""
    asked = []
    values = {"drive.amplitude_m": {"value": 3e-6, "unit": "m", "minimum": 0, "maximum": 1, "kind": "number"}}

    def answer(question):
        if "get" in question:
            return {"epoch": 0, "scene_hash": "x", "values": values}
        asked.append(question)
        if question.get("set", {}).get("drive.amplitude_m", 0) > 1:
            return {"faults": [{"key": "drive.amplitude_m", "found": "2", "allowed": "0 to 1", "message": "too large"}]}
        if "set" in question:
            values["drive.amplitude_m"]["value"] = question["set"]["drive.amplitude_m"]
        return {"applies_at_sample": 40_000, "epoch": 1, "scene_hash": "y"}

    router = zmq.Context.instance().socket(zmq.ROUTER)
    router.bind(f"ipc://{stand.folder}/control")
    over = threading.Event()

    def serve():
        while not over.is_set():
            if router.poll(50):
                who, *_, text = router.recv_multipart()
                router.send_multipart([who, json.dumps(answer(json.loads(text))).encode()])

    server = threading.Thread(target=serve)
    server.start()
    try:
        with stand.stream(), stand.scope("--control", f"ipc://{stand.folder}/control") as scope, PageSocket(scope.url) as page:
            assert page.text(lambda m: m.get("knobs", {}).get("there"))["knobs"]["values"]["drive.amplitude_m"]["value"] == 3e-6
            page.say({"set": {"drive.amplitude_m": 2e-6}})
            reply = page.text(lambda m: "replies" in m)["replies"][0]
            assert reply["answer"]["applies_at_sample"] == 40_000
            page.knows(lambda m: m["knobs"]["values"]["drive.amplitude_m"]["value"] == 2e-6)
            page.say({"set": {"drive.amplitude_m": 2}})
            assert page.text(lambda m: "replies" in m)["replies"][0]["answer"]["faults"][0]["message"] == "too large"
            page.say({"undo": True})
            assert page.text(lambda m: "replies" in m)["replies"][0]["to"] == {"undo": True}
            assert asked == [{"set": {"drive.amplitude_m": 2e-6}}, {"set": {"drive.amplitude_m": 2}}, {"undo": True}]
    finally:
        over.set()
        server.join()
        router.close(0)
    with stand.scope() as scope, PageSocket(scope.url) as page:
        assert "--control" in page.text(lambda m: "knobs" in m)["knobs"]["text"]
        page.say({"undo": True})
        assert page.text(lambda m: "replies" in m)["replies"][0]["answer"]["faults"]


def a_turned_knob_is_seen_from_its_sample_on(stand):
    with stand.stream("--control", f"ipc://{stand.folder}/knobs", pace=0.2), \
            stand.scope("--control", f"ipc://{stand.folder}/knobs") as scope, PageSocket(scope.url) as page:
        knob = page.knows(lambda m: m["knobs"]["there"])["knobs"]["values"]["drive.amplitude_m"]
        assert (knob["value"], knob["unit"], knob["kind"]) == (3e-6, "m", "number")
        page.say({"set": {"drive.amplitude_m": -1}})
        assert page.text(lambda m: "replies" in m)["replies"][0]["answer"]["faults"][0]["key"] == "drive.amplitude_m"
        page.say({"set": {"drive.amplitude_m": 1.5e-6}})
        answer = page.text(lambda m: "replies" in m)["replies"][0]["answer"]
        picture = page.picture(condition=lambda p: p.trigger >= answer["applies_at_sample"])
        assert picture.epoch == answer["epoch"] == 1
        page.knows(lambda m: m["knobs"]["values"]["drive.amplitude_m"]["value"] == 1.5e-6)
        page.knows(lambda m: m["scene"]["scene"]["drive"]["amplitude_m"] == 1.5e-6)
        page.say({"undo": True})
        undone = page.text(lambda m: "replies" in m)["replies"][0]["answer"]
        assert page.picture(condition=lambda p: p.trigger >= undone["applies_at_sample"]).epoch == 2
        page.say({"record": {"stream": "v_last", "ending": "sigmf-meta"}})  # the scope begins to listen to it
        page.text(lambda m: "recording" in m and m["recording"]["samples"] > 4_000_000)  # meta comes every second
        page.say({"record": None})
        recorded = page.text(lambda m: "recording" in m and not m["recording"]["on"])["recording"]["file"]
        changes = json.loads(pathlib.Path(recorded).read_text())["global"]["hertzline:changes"]
        assert [change["epoch"] for change in changes] == [1, 2], "each change once"
    change = {"sample": answer["applies_at_sample"], "set": {"drive.amplitude_m": 1.5e-6}}
    (stand.folder / "changes.json").write_text(json.dumps([change]))
    end = picture.first + picture.samples
    stand.check(picture, stand.samples(end, "v_out", "paper-stream", "--changes", stand.folder / "changes.json"))


def a_stream_brings_its_scope_along(stand):
    stream = stand.stream("--scope-http", "127.0.0.1:0", "--control", f"ipc://{stand.folder}/knobs")
    with stream, PageSocket(url := stream.said("scope")) as page:
        page.picture()
        page.knows(lambda m: m["knobs"]["there"])
        stream.interrupt()
        assert stream.process.stdout.read().count("endpoint") == 1, "the summary, and nothing else"
    try:
        PageSocket(url)
    except ConnectionError:
        return
    raise AssertionError("the scope goes on")


if __name__ == "__main__":
    promise, program = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        globals()[promise](Stand(program, folder))

#!/usr/bin/python3
"""Drives a chain from GNU Radio and receives its output: gnuradio_drive.py [DRIVE [ENDPOINT [SAMPLES [FILE]]]]

The same flowgraph as gnuradio_drive.grc. Beside it runs
    hertzline stream paper-stream --drive connect:tcp://127.0.0.1:5575 --wait-for-subscriber
as GNU Radio's sinks bind their endpoint.
"""
import sys, time
import numpy as np
from gnuradio import analog, blocks, gr, zeromq

RATE_HZ, TONE_HZ, AMPLITUDE_M = 10e6, 73e3, 1e-6

drive, endpoint, samples, file = sys.argv[1:] + ["tcp://127.0.0.1:5575", "tcp://127.0.0.1:5573", "20000", ""][len(sys.argv) - 1:]
flowgraph = gr.top_block()
tone = analog.sig_source_f(RATE_HZ, analog.GR_SIN_WAVE, TONE_HZ, AMPLITUDE_M, 0)
chain_in = zeromq.push_sink(gr.sizeof_float, 1, drive)
chain_out = zeromq.sub_source(gr.sizeof_float, 1, endpoint, key="v_out/raw")
sink = blocks.vector_sink_f()
flowgraph.connect(tone, chain_in)
flowgraph.connect(chain_out, sink)
flowgraph.start()
while sink.nitems_read(0) < int(samples):
    time.sleep(0.01)
flowgraph.stop()
flowgraph.wait()
v = np.array(sink.data()[:int(samples)], "<f4")
print(f"{len(v)} samples of v_out, peak {np.abs(v).max():.4g} m/s")
if file:
    v.tofile(file)

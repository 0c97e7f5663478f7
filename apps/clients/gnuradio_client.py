#!/usr/bin/python3
"""Collects samples of a running hertzline stream in GNU Radio: gnuradio_client.py [ENDPOINT [STREAM [SAMPLES [FILE]]]]"""
import sys, time
import numpy as np
from gnuradio import blocks, gr, zeromq

endpoint, stream, samples, file = sys.argv[1:] + ["tcp://127.0.0.1:5573", "v_out", "10000", ""][len(sys.argv) - 1:]
flowgraph = gr.top_block()
source = zeromq.sub_source(gr.sizeof_float, 1, endpoint, key=f"{stream}/raw")
sink = blocks.vector_sink_f()
flowgraph.connect(source, sink)
flowgraph.start()
while sink.nitems_read(0) < int(samples):  # a Head block would end only with the sample after its last one
    time.sleep(0.01)
flowgraph.stop()
flowgraph.wait()
v = np.array(sink.data()[:int(samples)], "<f4")
print(f"{len(v)} samples of {stream}, peak {np.abs(v).max():.4g}")
if file:
    v.tofile(file)

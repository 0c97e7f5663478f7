## Drives a chain with a tone, and hears it: octave_drive.m [DRIVE [ENDPOINT [SAMPLES [FILE]]]]
## Beside it runs: hertzline stream paper-stream --drive tcp://127.0.0.1:5575 --wait-for-subscriber
pkg load zeromq
words = {"tcp://127.0.0.1:5575", "tcp://127.0.0.1:5573", "20000", ""};
words(1:numel(argv())) = argv();
[drive, endpoint, samples, file] = words{:};
samples = str2double(samples);

chain_in = zmq_socket(ZMQ_PUSH);
zmq_connect(chain_in, drive);
chain_out = zmq_socket(ZMQ_SUB);
zmq_connect(chain_out, endpoint);
zmq_setsockopt(chain_out, ZMQ_SUBSCRIBE, "v_out/raw");

rate = 10e6;
cut = 1000;
ahead = 20000;  # samples, more than the latency
sent = 0;
v = single([]);
while numel(v) < samples
  while sent < numel(v) + ahead
    t = (sent + (0:cut-1)) / rate;
    zmq_send(chain_in, typecast(single(1e-6 * sin(2*pi*73e3*t)), "uint8"));
    sent += cut;
  endwhile
  topic = zmq_recv(chain_out, 64);
  v = [v, reshape(typecast(zmq_recv(chain_out, 2^20), "single"), 1, [])];
endwhile
v = v(1:samples);
printf("%d samples of v_out, peak %.4g m/s\n", numel(v), max(abs(v)));
if ! isempty(file)
  out = fopen(file, "w");
  fwrite(out, v, "single", 0, "ieee-le");
  fclose(out);
endif
zmq_close(chain_in);
zmq_close(chain_out);
